// SPDX-License-Identifier: BSD-3-Clause
// Which tasks of a study are open, and how far it is.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "journal.h"
#include "task.h"

namespace soft_robot_lab {

struct StudyProgress {
  std::size_t tasks = 0, done = 0;  // different ones; those of earlier runs are done
  std::size_t before = 0;           // done in earlier runs
  std::size_t failed = 0, not_good = 0;
  double elapsed_s = 0.0;
};

// After each outcome and each second; false: stop.
using ReportProgress = std::function<bool(const StudyProgress&)>;
using Warn = std::function<void(const std::string&)>;

// A worker's answer with a result, or without one where the task failed; nothing where it must run again.
std::optional<TaskOutcome> outcome_of(const nlohmann::ordered_json& answer);

class TaskLedger {
 public:
  TaskLedger(const std::vector<StudyTask>& tasks, Journal& journal, ReportProgress report);

  const StudyProgress& progress() const { return progress_; }
  bool all_done() const { return progress_.done == progress_.tasks; }
  bool report();  // false: stop

  void record(const TaskOutcome& outcome);
  // A task whose worker or program was killed. At the fifth time it has failed, and false comes back.
  bool may_run_again(const StudyTask& task, const std::string& why);

  std::deque<const StudyTask*> open;  // without outcome, each hash once; whoever hands one out takes it from here

 private:
  void count(const TaskOutcome& outcome);

  Journal& journal_;
  ReportProgress report_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  StudyProgress progress_;
  std::map<std::string, int> attempts_;
};

}  // namespace soft_robot_lab
