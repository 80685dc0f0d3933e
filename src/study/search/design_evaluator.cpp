// SPDX-License-Identifier: BSD-3-Clause
#include "design_evaluator.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "study/sweeps/hosts.h"
#include "study/sweeps/sampling.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSteps = 1000.0;       // of a range
constexpr double kNotCastable = 1.0e6;  // worse than any that is, by one for each test that fails
constexpr double kNotAssessed = 2.0e6;

std::size_t failed_tests(const Json& verdict) {
  std::size_t count = 0;
  const Json tests = verdict.value("tests", Json::object());
  for (const auto& [name, test] : tests.items()) count += !test.value("passed", true);
  return count;
}

void refuse(Design& design, std::size_t objectives, double fitness, const std::string& why) {
  design.good = false;
  design.fitness.assign(objectives, fitness);
  design.why_not = why;
}

}  // namespace

DesignEvaluator::DesignEvaluator(const SearchSettings& search, Journal& journal, int workers,
                                 std::function<bool(std::size_t)> report, Warn warn)
    : search_(search),
      journal_(journal),
      workers_(workers),
      report_(std::move(report)),
      warn_(std::move(warn)),
      casting_(step("check_casting", {})),
      assessment_(step("assess", search.assessment)) {}

DesignEvaluator::DesignStep DesignEvaluator::step(const std::string& program,
                                                  const std::vector<std::string>& arguments) const {
  return {study_of(search_, program, arguments), program_version(program), scene_hash(search_.robot, arguments)};
}

DesignEvaluator::Key DesignEvaluator::rounded(const DesignPoint& point) {
  Key key;
  for (const double fraction : point)
    key.push_back(static_cast<int>(std::lround(kSteps * std::clamp(fraction, 0.0, 1.0))));
  return key;
}

std::vector<double> DesignEvaluator::values_of(const Key& key) const {
  std::vector<double> values;
  for (std::size_t i = 0; i < key.size(); ++i) values.push_back(value_at(search_.parameters[i], key[i] / kSteps));
  return values;
}

bool DesignEvaluator::evaluate(const std::vector<DesignPoint>& points) {
  std::vector<Key> keys;
  std::vector<Design> fresh;
  for (const DesignPoint& point : points) {
    const Key key = rounded(point);
    if (places_.count(key) > 0 || std::count(keys.begin(), keys.end(), key) > 0) continue;
    keys.push_back(key);
    fresh.push_back({values_of(key), true, "", {}, {}});
  }
  std::vector<Design*> open;
  for (Design& design : fresh) open.push_back(&design);
  if (search_.castable) {
    const auto outcomes = run(casting_, open, designs_.size());
    if (!outcomes) return false;
    judge_castings(*outcomes, open);
    open.erase(std::remove_if(open.begin(), open.end(), [](const Design* design) { return !design->good; }),
               open.end());
  }
  const auto outcomes = run(assessment_, open, designs_.size() + fresh.size() - open.size());
  if (!outcomes) return false;
  judge_assessments(*outcomes, open);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    places_[keys[i]] = designs_.size();
    designs_.push_back(std::move(fresh[i]));
  }
  return true;
}

std::optional<std::vector<TaskOutcome>> DesignEvaluator::run(const DesignStep& step,
                                                             const std::vector<Design*>& designs, std::size_t done) {
  std::vector<StudyTask> tasks;
  for (const Design* design : designs) {
    tasks.push_back({"", design->values, 0});
    tasks.back().hash = request_hash(task_request(step.study, tasks.back()), step.scene, step.version);
  }
  journal_.set_tasks(step.study, tasks);
  const bool last = step.study.program == "assess";
  run_tasks(step.study, tasks, journal_,
            {local_workers(step.study.program, workers_), step.version,
             [&](const StudyProgress& now) { return report_(done + (last ? now.done : 0)); }, warn_});
  std::vector<TaskOutcome> outcomes;
  for (const StudyTask& task : tasks) {
    std::optional<TaskOutcome> outcome = journal_.find(task.hash);
    if (!outcome) return std::nullopt;
    outcomes.push_back(std::move(*outcome));
  }
  return outcomes;
}

void DesignEvaluator::judge_castings(const std::vector<TaskOutcome>& outcomes,
                                     const std::vector<Design*>& designs) const {
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const TaskOutcome& outcome = outcomes[i];
    if (outcome.state == TaskOutcome::State::good) continue;
    const bool judged = outcome.state == TaskOutcome::State::not_good;
    const double fitness =
        judged ? kNotCastable + static_cast<double>(failed_tests(Json::parse(outcome.result))) : kNotAssessed;
    refuse(*designs[i], search_.objectives.size(), fitness, "not castable: " + outcome.reason);
  }
}

void DesignEvaluator::judge_assessments(const std::vector<TaskOutcome>& outcomes,
                                        const std::vector<Design*>& designs) const {
  for (std::size_t i = 0; i < designs.size(); ++i) {
    Design& design = *designs[i];
    if (outcomes[i].state != TaskOutcome::State::good) {
      refuse(design, search_.objectives.size(), kNotAssessed, outcomes[i].reason);
      continue;
    }
    design.result = Json::parse(outcomes[i].result);
    for (const Objective& objective : search_.objectives) {
      const auto value = design.result.find(objective.name);
      if (value == design.result.end() || !value->is_number())
        throw std::invalid_argument("objectives: this robot's assessment has no " + objective.name);
      design.fitness.push_back(objective.larger_is_better ? -value->get<double>() : value->get<double>());
    }
  }
}

}  // namespace soft_robot_lab
