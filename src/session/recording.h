// SPDX-License-Identifier: BSD-3-Clause
// A session as a fit needs it, recorded or still going on: who was asked for what, and where markers were.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

struct ObservedMarker {
  std::string name;
  Eigen::Vector3d position_m;     // robot_base; finite
  Eigen::Matrix3d covariance_m2;  // zero where simulated
  bool seen = false;              // by cameras; else estimated from its past, or simulated
};

// At one instant.
struct ObservedMarkers {
  double time_s = 0.0;
  std::vector<ObservedMarker> markers;
};

// What a motor says of itself.
struct MotorReading {
  std::string name;    // of its actuator
  double value = 0.0;  // in the unit of that actuator's command
  double position_steps = 0.0;
  bool known = false;  // where it is
  bool moving = false;
  std::string fault;  // empty: none
};

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
  std::vector<ObservedMarkers> measured;
  std::vector<RecordedEvent> events;
  std::string scene;  // that the simulator ran last; empty where it is not recorded
  double start_s = 0.0, end_s = 0.0;

  // In order of time; what is older than the one before is left out.
  void add_commands(const std::vector<std::string>& names, const std::vector<double>& values, double time_s);
  void add_motors(const std::vector<MotorReading>& motors, double time_s);
  void add_measured(ObservedMarkers markers);

 private:
  void note_events(const std::vector<MotorReading>& motors, double time_s);
  std::vector<MotorReading> motors_;  // the last
};

// Of a recording, what may be compared with a model.
struct UsablePart {
  Recording recording;  // the commands before the part too: friction knows the way
  std::string note;     // which part it is, and what ended it; empty: all
};

// From and to [s since the recording's first markers]; without `to_s` it ends before the first event since `from_s`.
// Throws std::invalid_argument where nothing is left.
UsablePart usable_part(const Recording& recording, std::optional<double> from_s = {}, std::optional<double> to_s = {});

}  // namespace soft_robot_lab
