// SPDX-License-Identifier: BSD-3-Clause
// A robot of record in a session of its own files: one command moves the simulation and, with `emulated`, the robot on
// the rig to the same side, and the tracker sees it.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>
#include <soft_robot_lab/ActuatorCommand.h>
#include <soft_robot_lab/ActuatorState.h>
#include <soft_robot_lab/MarkerObservations.h>
#include <soft_robot_lab/MotorState.h>
#include <soft_robot_lab/PressureState.h>

#include "session_ears.h"
#include "ros/messages/conversions.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

struct Move {
  std::string actuator;
  double command;
  std::string marker;
  Eigen::Vector3d towards;  // where the command moves that marker
  double at_least_m;
  std::size_t seen = 0;  // markers that the cameras see of the robot at rest, at least; 0: not tested
};

// Bubblebot's chamber a lies towards +y; Bubblefinger bends away from its wedges.
const std::map<std::string, Move> kMoves = {
    {"spinebot", {"right", 0.9, "tip", {1, 0, 0}, 0.01, 6}},
    {"hammerbot", {"right", 0.9, "tip", {1, 0, 0}, 0.008, 6}},
    {"bubblebot", {"a", 60.0, "tip", {0, -1, 0}, 0.0007, 6}},  // thick walls
    {"bubblefinger", {"main", 10.0, "tip", {0, -1, 0}, 0.002, 6}},
    {"finger", {"front", 0.85, "tip", {1, 0, 0}, 0.005, 1}},  // as new_robot.sh writes it
    {"finger_a1", {"tendon", 0.85, "tip", {1, 0, 0}, 0.01, 3}},
    {"finger_a2", {"right", 0.9, "tip", {1, 0, 0}, 0.01, 1}},
    {"gripper", {"left", 0.92, "tip_left", {1, 0, 0}, 0.005, 4}},
    {"hanging_bar", {"cable", 0.95, "tip", {1, 0, 0}, 0.005}},
    {"hollow_cuboid", {"main", 1.3, "skin_x", {1, 0, 0}, 0.0005}},
    {"fibre_arm", {"a", 20000.0, "tip", {-1, 0, 0}, 0.01, 2}},
};

class RobotSession : public testing::Test {
 protected:
  RobotSession() {
    const ros::NodeHandle parameters("~");
    robot_ = parameters.param<std::string>("robot", "");
    emulated_ = parameters.param<bool>("emulated", false);
    solver_ = parameters.param<std::string>("solver", "");
    subscribers_.push_back(node_.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 100,
        boost::function<void(const diagnostic_msgs::DiagnosticArray::ConstPtr&)>([this](const auto& m) {
          for (const auto& status : m->status)
            for (const auto& value : status.values)
              if (status.name == "simulator: simulation") diagnosis_[value.key] = value.value;
        })));
    subscribers_.push_back(node_.subscribe<rosgraph_msgs::Log>(
        "/rosout_agg", 100, boost::function<void(const rosgraph_msgs::Log::ConstPtr&)>([this](const auto& m) {
          if (m->level >= rosgraph_msgs::Log::WARN) warnings_[m->name] = m->msg;
        })));
    commands_ = node_.advertise<ActuatorCommand>(topics::actuator_command, 10, true);
    hear_last(topics::simulator_markers, simulated_);
    hear_last(topics::simulator_actuators, actuators_);
    hear_last(topics::tracker_markers, tracked_);
    hear_last(topics::plant_markers, real_);
    hear_last(topics::motor_state, motors_);
    hear_last(topics::pressure_state, pressures_);
  }

  // Of its start and of a command: nobody could mend it. Two, as a machine may be too slow for a robot.
  void TearDown() override {
    std::string all;
    for (const auto& [node, warning] : warnings_) all += node + ": " + warning + "\n";
    EXPECT_LE(warnings_.size(), 2u) << all;
    RecordProperty("warnings", all);
  }

  template <typename Message>
  void hear_last(const char* topic, Message& last) {
    subscribers_.push_back(node_.subscribe<Message>(
        topic, 1, boost::function<void(const typename Message::ConstPtr&)>([&last](const auto& m) { last = *m; })));
  }

  const Move& move() const { return kMoves.at(robot_); }

  void expect_ready() {
    ASSERT_TRUE(spin_until(
        [this] {
          return commands_.getNumSubscribers() >= (emulated_ ? 2u : 1u) && !actuators_.names.empty() &&
                 !simulated_.names.empty() &&
                 (!emulated_ ||
                  (motors_.linked && !motors_.known.empty() && motors_.known.front() && !real_.names.empty()));
        },
        60.0));
  }

  std::size_t seen() const {
    std::size_t count = 0;
    for (const auto source : tracked_.sources) count += source == MarkerObservations::SEEN;
    return count;
  }

  double gone_m(const MarkerObservations& markers, const Eigen::Vector3d& from_m) const {
    return (position_of(markers, move().marker) - from_m).dot(move().towards);
  }

  // By the tracker, of the marker on the robot; infinite while it is lost, as on a busy machine.
  double missed_m() const {
    const auto& names = tracked_.names;
    if (std::find(names.begin(), names.end(), move().marker) == names.end()) return INFINITY;
    return (position_of(tracked_, move().marker) - position_of(real_, move().marker)).norm();
  }

  void command() {
    ActuatorCommand command;
    command.header.stamp = ros::Time::now();
    command.names = {move().actuator};
    command.values = {move().command};
    commands_.publish(command);
  }

  bool commanded() const {
    for (std::size_t i = 0; i < actuators_.names.size(); ++i)
      if (actuators_.names[i] == move().actuator) return actuators_.commands[i] == move().command;
    return false;
  }

  // A reduced model is trained first.
  bool moves_by_its_solver() const {
    const auto solver = diagnosis_.find("solver");
    return solver_.empty() || (solver != diagnosis_.end() && solver->second == solver_);
  }

  // Of the motor that pulls, full steps, or of the channel that fills, Pa.
  double drive_target() const {
    for (std::size_t i = 0; i < pressures_.names.size(); ++i)
      if (pressures_.names[i] == move().actuator) return pressures_.set_point_pa[i];
    for (std::size_t i = 0; i < motors_.names.size(); ++i)
      if (motors_.names[i] == move().actuator) return motors_.target_steps[i];
    return 0.0;
  }

  double volume_m3() const {
    for (const ChamberState& chamber : actuators_.chambers)
      if (chamber.name == move().actuator) return chamber.volume_m3;
    return 0.0;
  }

  std::string robot_, solver_;
  std::map<std::string, std::string> warnings_;  // each node's last
  bool emulated_ = false;
  std::map<std::string, std::string> diagnosis_;  // the simulator's last
  MarkerObservations simulated_, tracked_, real_;
  ActuatorState actuators_;
  MotorState motors_;
  PressureState pressures_;
  ros::NodeHandle node_;
  ros::Publisher commands_;

 private:
  std::vector<ros::Subscriber> subscribers_;
};

TEST_F(RobotSession, MovesAsOneCommandSays) {
  expect_ready();
  ASSERT_TRUE(spin_until([this] { return moves_by_its_solver(); }, 120.0)) << diagnosis_["reduced model"];
  if (move().seen > 0) {
    EXPECT_TRUE(spin_until([this] { return seen() >= move().seen; }, 40.0)) << seen();
  }
  const Eigen::Vector3d simulated_m = position_of(simulated_, move().marker);
  const Eigen::Vector3d real_m = emulated_ ? position_of(real_, move().marker) : simulated_m;
  const double volume_before_m3 = volume_m3(), target_before = drive_target();
  // Of those that listen some may be connected only later: it is said again until the simulator and the rig know it.
  const auto all_know = [&] { return commanded() && (!emulated_ || drive_target() != target_before); };
  for (int attempt = 0; attempt < 5 && !all_know(); ++attempt) {
    command();
    spin_until(all_know, 5.0);
  }
  ASSERT_TRUE(commanded());
  ASSERT_TRUE(all_know()) << target_before;
  EXPECT_TRUE(spin_until([&] { return gone_m(simulated_, simulated_m) > move().at_least_m; }, 40.0))
      << gone_m(simulated_, simulated_m);
  if (volume_before_m3 > 0.0) {
    EXPECT_TRUE(spin_until([&] { return volume_m3() > 1.01 * volume_before_m3; }, 40.0))
        << volume_m3() / volume_before_m3;
  }
  diagnosis_.clear();
  EXPECT_TRUE(spin_until([this] { return moves_by_its_solver(); }, 20.0)) << diagnosis_["solver"];
  if (solver_ == "reduced") {
    EXPECT_LE(std::stod(diagnosis_["audited error [m]"]), std::stod(diagnosis_["trusted error [m]"]));
  }
  if (!emulated_) return;
  EXPECT_TRUE(spin_until([&] { return gone_m(real_, real_m) > move().at_least_m; }, 60.0)) << gone_m(real_, real_m);
  EXPECT_TRUE(spin_until([this] { return missed_m() < 0.005; }, 60.0)) << missed_m();
}

}  // namespace
}  // namespace soft_robot_lab
