// SPDX-License-Identifier: BSD-3-Clause
// Brings markers of a robot that is not quite its model to a pose: the model predicts, measurements correct. Whenever
// the robot rests, the offset between measured and predicted markers is taken up, and the model is asked for commands
// that bring the predicted markers to the targets less the offsets. Where the offsets have settled, the measured
// markers are as near to their targets as the model's Jacobian can show.
//
// A reduced model may predict in the full one's place. Its error is part of the offsets, so nothing is checked by the
// full model but its start. The full one goes on, with new offsets, where the reduced one has no answer, or is held
// back by the commands that it was trained for.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "find_policy.h"

namespace soft_robot_lab {

struct ClosedLoopOptions {
  double gain = 0.7;             // (0, 1], the part of a change of an offset that is taken up at once
  double largest_change = 0.1;   // (0, 1] of an actuator's range, at one correction
  double settled_m = 1.0e-4;     // > 0; done when measured markers and targets come no nearer than by this, twice
  double lost_after_s = 1.0;     // > 0; without any marker so long, tracking is lost
  double error_growth_m = 0.01;  // > 0; farther away than the nearest so far by this, it stops
  int max_corrections = 20;      // [1, 10000]
  void validate() const;         // throws std::invalid_argument: field, value, allowed range
};

// Absent markers are those not seen now.
using MeasuredMarkers = std::map<std::string, Eigen::Vector3d>;  // robot_base

enum class LoopEnd {
  none,              // go on
  settled,           // as near as it gets
  correction_limit,  // still coming nearer
  tracking_lost,
  fault,
  error_grows,
  no_equilibrium  // of the model
};

struct LoopStep {
  LoopEnd end = LoopEnd::none;
  std::string reason;        // for a reader, where it ended
  Eigen::VectorXd commands;  // to be sent; at an end those that the robot has, to be held
  // Measured, weighted as an optimisation's; absent while a goal's marker is not seen.
  std::optional<double> distance_m;
  bool safe() const { return end == LoopEnd::none || end == LoopEnd::settled || end == LoopEnd::correction_limit; }
};

class ClosedLoop {
 public:
  // Starts from the model's present commands, which the robot has too. Throws std::invalid_argument as find_policy
  // does. `reduced`, of that model, serves where it rests in the same shape at those commands; null: none. It must
  // outlive the loop.
  ClosedLoop(Simulation& model, PolicyTask task, const ClosedLoopOptions& options,
             const ReducedChoice* reduced = nullptr);
  ~ClosedLoop();
  ClosedLoop(ClosedLoop&&) noexcept;

  bool on_reduced() const { return reduced_ != nullptr; }  // which predicts

  const std::vector<std::string>& actuators() const { return actuators_; }

  // Call it when the robot rests at the last commands, or has no markers to judge by; `fault`: what is wrong with the
  // drives, empty for nothing. After an end it must not be called again.
  LoopStep correct(double time_s, const MeasuredMarkers& measured, const std::string& fault);

 private:
  class Reduced;
  LoopStep stop(LoopEnd end, const std::string& reason, std::optional<double> distance_m) const;
  void update_offsets(const MeasuredMarkers& measured);
  Eigen::Vector3d offset_of(const std::string& marker) const;
  std::optional<double> measured_distance_m(const MeasuredMarkers& measured) const;
  Eigen::Matrix3Xd predicted_m();  // all markers, 3 x markers, at the present commands
  // By the reduced model, then by the full one where that has none. Absent where there is none.
  std::optional<Eigen::VectorXd> answer(const MeasuredMarkers& measured, std::string& why_not);
  std::optional<Eigen::VectorXd> answer_by_one(const MeasuredMarkers& measured, std::string& why_not);
  std::optional<Eigen::VectorXd> next_commands(std::string& why_not);
  void leave_reduced();

  Simulation& model_;
  PolicyTask task_;  // of one pose
  ClosedLoopOptions options_;
  std::vector<std::string> actuators_;
  Eigen::VectorXd commands_;
  std::map<std::string, Eigen::Vector3d> offsets_m_;  // measured less predicted, of markers seen so far
  std::optional<double> last_seen_s_;
  std::optional<double> nearest_m_;
  int idle_corrections_ = 0;  // in a row that came no nearer
  int corrections_ = 0;
  std::unique_ptr<Reduced> reduced_;  // null: the full model predicts
};

}  // namespace soft_robot_lab
