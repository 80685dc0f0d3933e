// SPDX-License-Identifier: BSD-3-Clause
#include "session_state.h"

#include <algorithm>
#include <utility>

#include <std_msgs/Bool.h>
#include <std_msgs/String.h>

#include "found_text.h"
#include "ros/base/machine_time.h"
#include "ros/base/stamps.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

std::string without_slashes(std::string name) {
  while (!name.empty() && name.front() == '/') name.erase(0, 1);
  while (!name.empty() && name.back() == '/') name.pop_back();
  return name;
}

template <typename Message, typename Action>
ros::Subscriber listen_to(ros::NodeHandle& node, const std::string& topic, int queue, Action action) {
  return node.subscribe<Message>(topic, queue,
                                 boost::function<void(const typename Message::ConstPtr&)>(
                                     [action](const typename Message::ConstPtr& message) { action(*message); }));
}

}  // namespace

SessionState::SessionState(const ros::NodeHandle& node) : lamps_(without_slashes(node.getNamespace())), node_(node) {
  subscribers_ = {
      listen_to<ActuatorRanges>(node_, topics::simulator_ranges, 1, [this](const auto& m) { on_ranges(m); }),
      listen_to<ActuatorState>(node_, topics::simulator_actuators, 1, [this](const auto& m) { on_actuators(m); }),
      listen_to<MarkerObservations>(node_, topics::simulator_markers, 1, [this](const auto& m) { on_markers(m); }),
      listen_to<std_msgs::String>(node_, topics::simulator_scene, 1, [this](const auto& m) { on_scene(m.data); }),
      listen_to<std_msgs::String>(node_, topics::simulator_solver, 1,
                                  [this](const auto& m) { running_.solver = m.data; }),
      listen_to<Target>(node_, topics::controller_target, 1, [this](const auto& m) { on_target(m); }),
      listen_to<OptimisePolicyResult>(node_, topics::target_answer, 10, [this](const auto& m) { on_target_answer(m); }),
      listen_to<RealityGap>(node_, topics::reality_gap, 1, [this](const auto& m) { on_gap(m); }),
      listen_to<std_msgs::Bool>(node_, topics::session_recording, 1,
                                [this](const auto& m) { running_.recorded = m.data != 0; }),
      listen_to<MotorState>(node_, topics::motor_state, 1, [this](const auto& m) { motors_ = m; }),
      listen_to<diagnostic_msgs::DiagnosticArray>(node_, "/diagnostics", 50,
                                                  [this](const auto& m) { lamps_.add(m, machine_time_s()); }),
  };
}

void SessionState::end_turn() {
  if (robot_box_) surface_.shutdown();
}

std::vector<CallOutcome> SessionState::take_notes() { return std::exchange(notes_, {}); }

void SessionState::on_actuators(const ActuatorState& actuators) {
  values_.add_state(actuators, machine_time_s());
  history_.add(actuators);
}

void SessionState::on_gap(const RealityGap& gap) {
  lamps_.add(gap, machine_time_s());
  history_.add(gap);
}

// The first robot's target may have been heard before it.
void SessionState::forget() {
  if (robots_++ > 0) target_.reset();
  markers_ = {};
  history_ = {};
  ++targets_;
}

void SessionState::on_ranges(const ActuatorRanges& ranges) {
  forget();
  running_.since = ranges.header.stamp;
  try {
    values_.set_ranges(ranges);
  } catch (const std::invalid_argument& error) {
    notes_.push_back({"Actuators", false, error.what()});
  }
}

// Those that came late of the robot before move neither plot nor target. A clock that was set back counts anew.
void SessionState::on_markers(const MarkerObservations& markers) {
  const double after_s = seconds_between(running_.since, markers.header.stamp);
  if (after_s <= 0.0 && after_s > -1.0) return;
  markers_ = markers;
  history_.add(markers, plotted_);
}

void SessionState::on_scene(const std::string& scene) {
  if (!running_.scene.empty() && scene != running_.scene) forget();
  running_.scene = scene;
  robot_box_.reset();
  surface_ = listen_to<visualization_msgs::Marker>(node_, topics::simulator_surface, 1,
                                                   [this](const auto& m) { on_surface(m); });
}

void SessionState::on_target(const Target& target) {
  target_ = target;
  if (target.marker.empty()) target_.reset();
  ++targets_;
}

void SessionState::on_target_answer(const OptimisePolicyResult& answer) {
  const bool found = answer.success != 0;
  notes_.push_back({"Target", found, found ? found_text(answer) + "; Execute goes there" : answer.message});
}

void SessionState::on_surface(const visualization_msgs::Marker& surface) {
  if (robot_box_) return;
  Eigen::AlignedBox3d box_m;
  for (const geometry_msgs::Point& point : surface.points) box_m.extend(Eigen::Vector3d(point.x, point.y, point.z));
  if (!box_m.isEmpty() && box_m.sizes().allFinite()) robot_box_ = RobotBox{box_m, surface.header.frame_id};
}

std::optional<geometry_msgs::Point> SessionState::target(const std::string& marker) const {
  if (target_ && target_->marker == marker) return target_->position;
  const auto found = std::find(markers_.names.begin(), markers_.names.end(), marker);
  const auto index = static_cast<std::size_t>(found - markers_.names.begin());
  if (index >= markers_.positions.size()) return std::nullopt;
  return markers_.positions[index];
}

}  // namespace soft_robot_lab
