// SPDX-License-Identifier: BSD-3-Clause
#include "rollout_rates.h"

#include <algorithm>
#include <chrono>
#include <sstream>

#include "plot_series.h"
#include "robot/rollouts/rollout_commands.h"
#include "robot/scene/reduction.h"
#include "settings/cpu_time.h"
#include "soft_robot_lab/robot/rollouts/batch.h"

namespace soft_robot_lab {
namespace {

RolloutRate run_batch(const Scene& scene, const RolloutRung& rung, const RolloutPlan& plan, int threads) {
  RolloutRate rate{rung.name, threads, static_cast<int>(plan.rollouts.size())};
  const double cpu_start_s = cpu_time_s();
  const auto start = std::chrono::steady_clock::now();
  const std::vector<RunReport> reports = RolloutBatch(scene).run(plan, threads);
  rate.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  rate.cpu_s = cpu_time_s() - cpu_start_s;
  for (const RunReport& report : reports) {
    rate.left_reduced += report.left_reduced ? 1 : 0;
    rate.unsolved += report.solve.converged ? 0 : 1;
  }
  if (!scene.reduction) return rate;
  rate.modes = static_cast<int>(scene.reduction->choice.model->energy.modes());
  rate.training_s = scene.reduction->choice.cpu_s;
  rate.largest_rms_m = scene.reduction->choice.largest_rms_m();
  return rate;
}

RolloutPlan plan_of(const RolloutProblem& problem, const RolloutRung& rung, const Model& model) {
  RandomCommands random;
  random.box.min.assign(model.actuators().size(), problem.min_command);
  random.box.max.assign(model.actuators().size(), problem.max_command);
  random.rollouts = rung.count;
  random.duration_s = problem.duration_s;
  random.hold_s = problem.hold_s;
  return {problem.duration_s, 0.0, random_commands(random, model)};
}

}  // namespace

RolloutProblem read_rollouts(const ExperimentContext& context, const YamlNode& node) {
  RolloutProblem problem;
  problem.title = node.text("title");
  problem.scene = context.config_folder + "/" + node.text("scene");
  problem.duration_s = node.number("duration_s", AllowedRange::positive());
  problem.hold_s = node.number("hold_s", AllowedRange::positive());
  problem.min_command = node.number("min_command", AllowedRange::not_negative());
  problem.max_command = node.number("max_command", {problem.min_command});
  for (const YamlNode& item : node.sequence("threads"))
    problem.threads.push_back(static_cast<int>(item.as_number({1.0, 1000.0})));
  for (const YamlNode& item : node.sequence("ladder")) {
    RolloutRung rung{item.text("name"), {}, item.integer("count", 1, 100000), item.boolean_or("quick", true)};
    if (const auto overrides = item.optional_child("overrides")) rung.overrides = Overrides(*overrides);
    problem.rungs.push_back(rung);
  }
  return problem;
}

RolloutProblem quick_part(RolloutProblem problem) {
  const auto slow = [](const RolloutRung& rung) { return !rung.quick; };
  problem.rungs.erase(std::remove_if(problem.rungs.begin(), problem.rungs.end(), slow), problem.rungs.end());
  for (RolloutRung& rung : problem.rungs) rung.count = 2;
  problem.duration_s = 0.1;
  return problem;
}

std::vector<RolloutRate> run_rollouts(const ExperimentContext& context, const RolloutProblem& problem) {
  std::vector<RolloutRate> rates;
  for (const RolloutRung& rung : problem.rungs) {
    context.report(1.0, problem.title + ": " + rung.name);
    SceneOptions options = context.scene_options(rung.overrides);
    options.reduced = ReducedUse::trained;
    const Scene scene = load_scene(problem.scene, options);
    const RolloutPlan plan = plan_of(problem, rung, *scene.simulation->model());
    for (const int threads : problem.threads) rates.push_back(run_batch(scene, rung, plan, threads));
  }
  return rates;
}

Plot plot_rollouts(const RolloutProblem& problem, const std::vector<RolloutRate>& rates) {
  std::ostringstream label;
  label << "rollouts of " << problem.duration_s << " s per CPU-second";
  Plot plot{"rollouts_per_core", problem.title, {}, {}};
  plot.x = {"method"};
  plot.y = {label.str(), true};
  plot.width_px = 1100;
  for (const RolloutRate& rate : rates) {
    const auto known = std::find_if(plot.x.ticks.begin(), plot.x.ticks.end(),
                                    [&](const auto& tick) { return tick.second == rate.rung; });
    const double place = known == plot.x.ticks.end() ? static_cast<double>(plot.x.ticks.size()) : known->first;
    if (known == plot.x.ticks.end()) plot.x.ticks.emplace_back(place, rate.rung);
    const std::string name = std::to_string(rate.threads) + (rate.threads == 1 ? " thread" : " threads");
    Series& series = series_of(plot, name);
    series.style = SeriesStyle::points;
    series.x.push_back(place);
    series.y.push_back(rate.per_core_s());
  }
  plot.x.min = -0.5;
  plot.x.max = static_cast<double>(plot.x.ticks.size()) - 0.5;
  return plot;
}

nlohmann::ordered_json rollouts_json(const RolloutProblem& problem, const std::vector<RolloutRate>& rates) {
  auto json = nlohmann::ordered_json::array();
  for (const RolloutRate& rate : rates) {
    json.push_back({{"method", rate.rung},
                    {"threads", rate.threads},
                    {"rollouts", rate.rollouts},
                    {"duration_s", problem.duration_s},
                    {"cpu_s", rate.cpu_s},
                    {"wall_s", rate.wall_s},
                    {"rollouts_per_cpu_s", rate.per_core_s()},
                    {"times_real_time_a_core", rate.per_core_s() * problem.duration_s},
                    {"unsolved", rate.unsolved}});
    if (rate.modes == 0) continue;
    json.back()["modes"] = rate.modes;
    json.back()["training_cpu_s"] = rate.training_s;
    json.back()["held_out_rms_mm"] = 1e3 * rate.largest_rms_m;
    json.back()["left_reduced"] = rate.left_reduced;
  }
  return json;
}

}  // namespace soft_robot_lab
