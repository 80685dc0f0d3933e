// SPDX-License-Identifier: BSD-3-Clause
// A recorded session, or one that goes on, as fits and reports need it: who was asked for what, and where markers were.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <soft_robot_lab/MotorState.h>
#include <soft_robot_lab/RealityGap.h>

#include "soft_robot_lab/control/identification/fit_model.h"
#include "messages.h"
#include "session/rest_criterion.h"

namespace soft_robot_lab {

// Since `time_s`, until the next.
struct CommandsSince {
  double time_s;
  std::map<std::string, double> values;  // of all actuators that were ever commanded until then
};

// What spoils all that follows: motors that lost steps or were set to another zero, while the robot was in use.
struct RecordedEvent {
  double time_s = 0.0;
  std::string text;
};

struct Recording {
  std::vector<CommandsSince> commands;  // where they changed
  std::vector<CommandsSince> reached;   // by motors that stood and knew where, in units of commands; where it changed
  std::vector<MarkerObservations> measured, simulated;
  std::vector<RealityGap> gaps;  // of these two
  std::vector<RecordedEvent> events;
  std::string scene;  // that the simulator ran last; empty where it is not recorded
  double start_s = 0.0, end_s = 0.0;

  // In order of time; a message older than the one before is left out.
  void add(const ActuatorCommand& command, double time_s);
  void add(const MotorState& motors, double time_s);
  void add_measured(const MarkerObservations& markers);

 private:
  void note_events(const MotorState& motors, double time_s);
  MotorState motors_;  // the last
};

// Of a recording, what may be compared with a model.
struct UsablePart {
  Recording recording;  // the commands before the part too: friction knows the way
  std::string note;     // which part it is, and what ended it; empty: all
};

// From and to [s since the recording's first markers]; without `to_s` it ends before the first event since `from_s`.
// Throws std::invalid_argument where nothing is left.
UsablePart usable_part(const Recording& recording, std::optional<double> from_s = {}, std::optional<double> to_s = {});

// Throws std::runtime_error for a file that is no bag, holds no tracked markers, or is cut off.
Recording read_recording(const std::string& bag);

// The robot at rest under commands that do not change.
struct RestPeriod {
  double start_s = 0.0, end_s = 0.0;  // averaged between
  MeasuredPose pose;                  // markers seen, with the covariance of their mean
};

// In order of time. As in a session, but `observations` are of each marker, and windows longer where fewer frames came.
// A marker that cameras saw in fewer observations of a period is not in it.
std::vector<RestPeriod> rest_periods(const Recording& recording, const RestCriterion& criterion = {});

// For a fit: the rest periods, and between them, without markers, commands that were held without rest, so that
// friction knows the way.
std::vector<MeasuredPose> measured_poses(const Recording& recording, const RestCriterion& criterion = {});

// For a fit of damping: wherever the robot rested, was moved, and then left to itself for two windows at least, what
// cameras saw of the next seconds.
std::vector<MeasuredSwing> measured_swings(const Recording& recording, const RestCriterion& criterion = {});

}  // namespace soft_robot_lab
