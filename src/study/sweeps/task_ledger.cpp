// SPDX-License-Identifier: BSD-3-Clause
#include "task_ledger.h"

#include <set>
#include <utility>

namespace soft_robot_lab {
namespace {

constexpr int kMostAttempts = 5;  // of a task

}  // namespace

std::optional<TaskOutcome> outcome_of(const nlohmann::ordered_json& answer) {
  if (!answer.contains("state")) return std::nullopt;
  return TaskOutcome{answer.at("hash"), state_named(answer.at("state")), answer.at("reason"),
                     answer.contains("result") ? answer.at("result").dump() : "", answer.at("wall_s")};
}

TaskLedger::TaskLedger(const std::vector<StudyTask>& tasks, Journal& journal, ReportProgress report)
    : journal_(journal), report_(std::move(report)) {
  std::set<std::string> known;
  for (const StudyTask& task : tasks) {
    if (!known.insert(task.hash).second) continue;
    ++progress_.tasks;
    const auto outcome = journal_.find(task.hash);
    outcome ? count(*outcome) : open.push_back(&task);
  }
  progress_.before = progress_.done;
}

void TaskLedger::count(const TaskOutcome& outcome) {
  ++progress_.done;
  if (outcome.state == TaskOutcome::State::failed) ++progress_.failed;
  if (outcome.state == TaskOutcome::State::not_good) ++progress_.not_good;
}

bool TaskLedger::report() {
  progress_.elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  return !report_ || report_(progress_);
}

void TaskLedger::record(const TaskOutcome& outcome) {
  journal_.add(outcome);
  count(outcome);
}

bool TaskLedger::may_run_again(const StudyTask& task, const std::string& why) {
  if (++attempts_[task.hash] < kMostAttempts) return true;
  record({task.hash, TaskOutcome::State::failed, "given up after " + std::to_string(kMostAttempts) + " times: " + why,
          "", 0.0});
  return false;
}

}  // namespace soft_robot_lab
