// SPDX-License-Identifier: BSD-3-Clause
#include "policy_execution.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <ros/console.h>
#include <ros/init.h>

#include "ros/messages/conversions.h"
#include "ros/base/log_text.h"
#include "ros/messages/marker_frames.h"
#include "ros/messages/message_limits.h"

namespace soft_robot_lab {
namespace {

bool are_whole(const MarkerObservations& markers) {
  try {
    require_whole(markers);
    return true;
  } catch (const std::invalid_argument& error) {
    ROS_WARN_THROTTLE(5.0, "%s", log_text(error.what()).c_str());
    return false;
  }
}

ExecutionHost host_of_node(PolicyExecution::Send send) {
  return {std::move(send), [] { return ros::SteadyTime::now().toSec(); },
          [] { return ros::isInitialized() && !ros::ok(); }};
}

}  // namespace

MotorWatchReport motor_report(const MotorState& state) {
  const bool moving = std::any_of(state.moving.begin(), state.moving.end(), [](auto moves) { return moves != 0; });
  return {state.linked != 0, state.emergency_stop != 0, moving, state.names, state.fault};
}

PolicyExecution::PolicyExecution(const ClosedLoopOptions& loop_options, Send send)
    : execution_(loop_options, host_of_node(std::move(send))) {}

ExecutePolicy::Response PolicyExecution::execute(const ExecutionOrder& order) {
  const ExecutionReport report = execution_.execute(order);
  ExecutePolicy::Response response;
  response.success = report.success;
  response.message = report.message;
  response.duration_s = report.duration_s;
  if (report.simulated_s) response.markers = last(simulated_);
  if (report.measured_s) response.measured = last(measured_);
  response.corrections = report.corrections;
  response.final_distance_m = report.final_distance_m;
  response.names = report.names;
  response.values = report.values;
  return response;
}

bool PolicyExecution::cancel() {
  cancelled_ = true;
  const bool executing = execution_.cancel();
  return executing || preparing_;
}

std::shared_ptr<void> PolicyExecution::prepare() {
  cancelled_ = false;
  preparing_ = true;
  return {nullptr, [this](void*) { preparing_ = false; }};
}

// Kept first: an execution that these markers end answers with them.
void PolicyExecution::add_simulated(const MarkerObservations& markers) {
  if (!are_whole(markers)) return;
  keep(markers, simulated_);
  execution_.add_simulated(markers.header.stamp.toSec(), raw_positions_m(markers));
}

void PolicyExecution::add_measured(const MarkerObservations& markers) {
  if (!are_whole(markers)) return;
  keep(markers, measured_);
  execution_.add_measured(seen_frame(markers));
}

void PolicyExecution::add_drives(const ActuatorState& state) {
  const bool whole = state.names.size() == state.commands.size() && is_in_limits<ActuatorState>(state);
  if (whole) execution_.add_drives(state.names, state.commands);
}

void PolicyExecution::keep(const MarkerObservations& markers, MarkerObservations& heard) {
  const std::lock_guard lock(mutex_);
  heard = markers;
}

MarkerObservations PolicyExecution::last(const MarkerObservations& heard) const {
  const std::lock_guard lock(mutex_);
  return heard;
}

}  // namespace soft_robot_lab
