// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/robot/rollouts/batch.h"

#include <algorithm>
#include <future>
#include <mutex>
#include <stdexcept>
#include <string>

#include "settings/require.h"
#include "robot/scene/scene_motion.h"
#include "settings/limits.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

void require_rollout(const RolloutCommands& commands, const Model& model) {
  double before_s = 0.0;
  for (const TimedCommands& timed : commands) {
    require(timed.time_s >= before_s, "time_s", timed.time_s, ("[" + format_number(before_s) + ", inf)").c_str());
    before_s = timed.time_s;
    require_commands(model, timed.commands);
  }
}

// The rollouts of a plan, each taken by the thread that is free first.
class Rollouts {
 public:
  Rollouts(const RolloutPlan& plan, const RolloutBatch::Progress& progress, const std::function<bool()>& ends)
      : plan_(plan), progress_(progress), ends_(ends) {
    reports_.resize(plan.rollouts.size());
  }

  void work(const std::shared_ptr<const Model>& model, const std::shared_ptr<const SceneReduction>& reduction) {
    try {
      Simulation simulation(model);
      simulation.set_interrupt(ends_);
      SceneMotion motion(simulation, reduction);
      for (std::size_t i = next(); i < reports_.size(); i = next()) {
        RunReport report = run(motion, plan_.rollouts[i]);
        if (!report.solve.interrupted) reports_[i] = std::move(report);
        if (ends_ && ends_()) return stop();
        finish();
      }
    } catch (...) {
      stop();
      throw;
    }
  }

  std::vector<RunReport> reports() { return std::move(reports_); }

 private:
  RunReport run(SceneMotion& motion, const RolloutCommands& commands) const {
    RunSettings settings;
    settings.mode = RunMode::dynamic;
    settings.duration_s = plan_.duration_s;
    settings.record_every_s = plan_.record_every_s;
    settings.commands = commands;
    motion.reset();
    return run_in_time(motion, settings);
  }

  std::size_t next() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return stopped_ ? reports_.size() : started_++;
  }
  void finish() {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++ended_;
    if (progress_ && !progress_(ended_)) stopped_ = true;
  }
  void stop() {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopped_ = true;
  }

  const RolloutPlan& plan_;
  const RolloutBatch::Progress& progress_;
  const std::function<bool()>& ends_;
  std::vector<RunReport> reports_;
  std::mutex mutex_;
  std::size_t started_ = 0, ended_ = 0;
  bool stopped_ = false;
};

}  // namespace

RolloutBatch::RolloutBatch(const Scene& scene) : model_(scene.simulation->model()), reduction_(scene.reduction) {}

void RolloutBatch::require_valid(const RolloutPlan& plan, int threads) const {
  require(threads >= 1 && threads <= limits::kThreads, "threads", threads, "[1, 1000]");
  const double longest_s = limits::kSteps * model_->options().time_step_s;
  require(plan.duration_s > 0.0 && plan.duration_s <= longest_s, "duration_s", plan.duration_s,
          ("(0, " + format_number(longest_s) + "]").c_str());
  require(plan.record_every_s >= 0.0, "record_every_s", plan.record_every_s, "[0, inf]");
  for (const RolloutCommands& commands : plan.rollouts) require_rollout(commands, *model_);
}

std::vector<RunReport> RolloutBatch::run(const RolloutPlan& plan, int threads, const Progress& progress,
                                         const std::function<bool()>& ends) const {
  require_valid(plan, threads);
  Rollouts rollouts(plan, progress, ends);
  const int needed = static_cast<int>(std::min(static_cast<std::size_t>(threads), plan.rollouts.size()));
  std::vector<std::future<void>> workers;
  for (int i = 1; i < needed; ++i)
    workers.push_back(std::async(std::launch::async, [&] { rollouts.work(model_, reduction_); }));
  if (needed > 0) workers.push_back(std::async(std::launch::deferred, [&] { rollouts.work(model_, reduction_); }));
  if (needed > 0) workers.back().wait();
  for (std::future<void>& worker : workers) worker.wait();
  for (std::future<void>& worker : workers) worker.get();
  return rollouts.reports();
}

}  // namespace soft_robot_lab
