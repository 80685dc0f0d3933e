// SPDX-License-Identifier: BSD-3-Clause
// What `/diagnostics` says of a simulation: its steps and commands since the diagnosis before.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "robot/scene/background_training.h"
#include "ros/base/node_diagnosis.h"
#include "ros/simulator/running_scene.h"

namespace soft_robot_lab {

// Session time over wall time, in the last second or so.
class RealTimeFactor {
 public:
  void update(double session_s);
  double value() const { return value_; }

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point wall_start_ = Clock::now();
  double session_start_s_ = 0.0;
  double value_ = 0.0;
};

class StepMonitor {
 public:
  void add_step(const SolveReport& report);
  void add_time(double session_s) { real_time_factor_.update(session_s); }  // after each step
  void add_refusal(const std::string& why);

  void diagnose(RunningScene& scene, const BackgroundTraining& training, NodeDiagnosis::Status& status);

 private:
  SolveReport last_report_;
  int unconverged_steps_ = 0;           // since the last diagnosis
  std::vector<SolveWarning> warnings_;  // likewise
  int refused_commands_ = 0;
  std::string last_refusal_;
  RealTimeFactor real_time_factor_;
};

}  // namespace soft_robot_lab
