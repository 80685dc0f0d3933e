// SPDX-License-Identifier: BSD-3-Clause
#include "panel_link.h"

#include <optional>
#include <sstream>
#include <utility>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/master.h>
#include <ros/this_node.h>
#include <soft_robot_lab/Calibrate.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/LoadScene.h>
#include <soft_robot_lab/OptimisePolicy.h>
#include <soft_robot_lab/UseSolver.h>
#include <soft_robot_lab/ZeroMotors.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <visualization_msgs/Marker.h>
#include <xmlrpcpp/XmlRpc.h>

#include "found_text.h"
#include "ros/base/machine_time.h"
#include "ros/base/topics.h"
#include "ros/display/plasma.h"

namespace soft_robot_lab {
namespace {

// Of the whole graph, by one question to the master.
std::set<std::string> services_offered() {
  XmlRpc::XmlRpcValue request, response, state;
  std::set<std::string> services;
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", request, response, state, false)) return services;
  for (int i = 0; i < state[2].size(); ++i) services.insert(static_cast<std::string>(state[2][i][0]));
  return services;
}

geometry_msgs::Point point_message(const Eigen::Vector3d& position_m) {
  geometry_msgs::Point message;
  message.x = position_m.x();
  message.y = position_m.y();
  message.z = position_m.z();
  return message;
}

ros::NodeHandle node_with_queue(const std::string& session, ros::CallbackQueue& queue) {
  ros::NodeHandle node(session);
  node.setCallbackQueue(&queue);
  return node;
}

}  // namespace

PanelLink::PanelLink(const std::string& session)
    : node_(node_with_queue(session, queue_)),
      state_(node_),
      commands_(node_.advertise<ActuatorCommand>(topics::actuator_command, 10)),
      target_shown_(node_.advertise<Target>(topics::target_shown, 10)),
      tips_(node_.advertise<visualization_msgs::Marker>(topics::panel_tips, 1, true)),
      diagnostics_(node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 10)) {}

void PanelLink::listen() {
  queue_.callAvailable();
  state_.end_turn();
  if (send_edits()) report_where_nothing_moves();
  constexpr double look_period_s = 2.0;
  if (machine_time_s() - looked_at_s_ > look_period_s) look_for_services();
}

bool PanelLink::send_edits() {
  ActuatorCommand command = state_.values().take_command();
  if (command.names.empty()) return false;
  command.header.stamp = ros::Time::now();
  commands_.publish(command);
  return true;
}

void PanelLink::look_for_services() {
  looked_at_s_ = machine_time_s();
  calls_.start(look_lane, "", [this] {
    std::set<std::string> offered = services_offered();
    const std::lock_guard lock(services_mutex_);
    services_ = std::move(offered);
    return "";
  });
}

bool PanelLink::offers(const std::string& service) const {
  const std::lock_guard lock(services_mutex_);
  return services_.count(node_.resolveName(service)) > 0;
}

std::string PanelLink::why_not(const std::string& service) const {
  if (busy()) return "something else is under way; Stop ends it";
  if (offers(service)) return "";
  if (service == topics::optimise_policy || service == topics::execute_policy)
    return "no controller runs here, as where view.sh shows a robot alone; "
           "`roslaunch soft_robot_lab session.launch scene:=FILE` has one";
  return "nothing here offers " + node_.resolveName(service);
}

std::vector<Lamp> PanelLink::lamps() const { return state_.lamps().lamps(machine_time_s()); }
std::optional<Lamps::Training> PanelLink::training() const { return state_.lamps().training(machine_time_s()); }

// A slider sends its command all the same, and would move nothing.
void PanelLink::report_where_nothing_moves() {
  const std::optional<MotorState>& rig = state_.motors();
  std::string fault = state_.lamps().link_fault(machine_time_s());
  if (rig && rig->emergency_stop) fault = "the motors hold until Clear";
  if (rig && !fault.empty()) notes_.push_back({"Move", false, "the simulation alone moves: " + fault});
}

// A policy that was just stopped may have sent one more command meanwhile. What Stop ends has not failed.
std::vector<CallOutcome> PanelLink::take_outcomes() {
  const bool goes_on = busy();  // before its outcome is taken
  std::vector<CallOutcome> outcomes = calls_.take_outcomes();
  for (CallOutcome& outcome : outcomes) {
    if (outcome.title == "Stop") hold();
    if (!outcome.success && stopped_ && outcome.title != "Stop" && outcome.title != "Calibrate")
      outcome = {outcome.title, true, "ended by Stop"};
  }
  if (!goes_on) stopped_ = false;
  for (const std::vector<CallOutcome>& notes : {state_.take_notes(), std::exchange(notes_, {})})
    outcomes.insert(outcomes.end(), notes.begin(), notes.end());
  return outcomes;
}

// Of those drives nothing has to be said that stand where they are.
void PanelLink::hold() {
  state_.values().edit_all_to_reached(machine_time_s());
  send_edits();
}

void PanelLink::optimise(const std::string& method, const std::string& marker, const Eigen::Vector3d& target_m) {
  OptimisePolicy::Request request;
  request.method = method;
  request.marker = marker;
  request.target = point_message(target_m);
  calls_.start(slow_lane, "Optimise", [this, request] {
    return found_text(calls_.ask<OptimisePolicy>(node_, topics::optimise_policy, request));
  });
}

void PanelLink::show_target(const std::string& marker, const Eigen::Vector3d& target_m) {
  Target shown;
  shown.header.stamp = ros::Time::now();
  shown.header.frame_id = state_.markers().header.frame_id;
  shown.marker = marker;
  shown.position = point_message(target_m);
  target_shown_.publish(shown);
}

void PanelLink::show_tips(const ReachableTips& tips, const TipQuantity& coloured_by) {
  visualization_msgs::Marker cloud;
  cloud.header.frame_id = state_.markers().header.frame_id;
  cloud.ns = "reachable_tips";
  cloud.action = tips.tips.empty() ? visualization_msgs::Marker::DELETE : visualization_msgs::Marker::ADD;
  cloud.type = visualization_msgs::Marker::SPHERE_LIST;
  cloud.pose.orientation.w = 1.0;
  cloud.scale.x = cloud.scale.y = cloud.scale.z = 0.0012;
  const double largest = coloured_by.largest();
  for (std::size_t i = 0; i < tips.tips.size(); ++i) {
    const auto [red, green, blue] = plasma(coloured_by.values[i] / largest);
    std_msgs::ColorRGBA rgba;
    rgba.r = red;
    rgba.g = green;
    rgba.b = blue;
    rgba.a = 1.0f;
    cloud.points.push_back(point_message(tips.tips[i].position_m));
    cloud.colors.push_back(rgba);
  }
  tips_.publish(cloud);
}

void PanelLink::diagnose(const TurnGap& longest) {
  diagnostic_msgs::DiagnosticArray message;
  message.header.stamp = ros::Time::now();
  message.status.resize(1);
  diagnostic_msgs::DiagnosticStatus& status = message.status[0];
  status.name = ros::this_node::getName().substr(1) + ": window";
  status.message = "answers";
  status.values.resize(2);
  status.values[0].key = "longest gap [s]";
  status.values[0].value = std::to_string(longest.wall_s);
  status.values[1].key = "work in a gap [s]";
  status.values[1].value = std::to_string(longest.work_s);
  diagnostics_.publish(message);
}

void PanelLink::execute() { play(Policy()); }

void PanelLink::play(const Policy& policy) {
  ExecutePolicy::Request request;
  request.policy = policy;
  request.wait_until_rest = true;
  calls_.start(slow_lane, policy.names.empty() ? "Execute" : "Play", [this, request] {
    const auto answer = calls_.ask<ExecutePolicy>(node_, topics::execute_policy, request);
    std::ostringstream text;
    text.precision(3);
    text << "at rest after " << answer.duration_s << " s";
    return text.str();
  });
}

// A controller that has nothing to stop is no fault.
void PanelLink::stop() {
  hold();
  stopped_ = busy();
  const bool cancels = offers(topics::cancel_policy), stops = offers(topics::motor_stop);
  const bool ends_solve = !stops && offers(topics::simulator_stop);
  calls_.start(quick_lane, "Stop", [this, cancels, stops, ends_solve] {
    if (stops) calls_.ask<std_srvs::Trigger>(node_, topics::motor_stop, {});
    if (ends_solve) calls_.ask<std_srvs::Trigger>(node_, topics::simulator_stop, {});
    try {
      if (cancels) calls_.ask<std_srvs::Trigger>(node_, topics::cancel_policy, {});
    } catch (const std::runtime_error&) {
    }
    return stops ? "the motors hold until Clear" : "";
  });
}

void PanelLink::reset() {
  if (state_.motors()) {
    state_.values().edit_all_to_rest(machine_time_s());
  } else {
    ask_trigger(quick_lane, "Reset", topics::simulator_reset);
  }
}

void PanelLink::load(const std::string& scene) {
  LoadScene::Request request;
  request.path = scene;
  calls_.start(slow_lane, "Load",
               [this, request] { return calls_.ask<LoadScene>(node_, topics::simulator_load, request).message; });
}

void PanelLink::use_solver(const std::string& solver) {
  UseSolver::Request request;
  request.solver = solver;
  calls_.start(slow_lane, "Solver",
               [this, request] { return calls_.ask<UseSolver>(node_, topics::simulator_use_solver, request).message; });
}

void PanelLink::clear() { ask_trigger(quick_lane, "Clear", topics::motor_clear); }

void PanelLink::ask_trigger(const std::string& lane, const std::string& title, const std::string& service) {
  calls_.start(lane, title, [this, service] { return calls_.ask<std_srvs::Trigger>(node_, service, {}).message; });
}

void PanelLink::record(bool on) {
  std_srvs::SetBool::Request request;
  request.data = on;
  calls_.start(quick_lane, "Record", [this, request] {
    return calls_.ask<std_srvs::SetBool>(node_, topics::session_record, request).message;
  });
}

void PanelLink::zero() {
  calls_.start(quick_lane, "Zero", [this] { return calls_.ask<ZeroMotors>(node_, topics::motor_zero, {}).message; });
}

void PanelLink::calibrate(bool with_balls) {
  Calibrate::Request request;
  request.with_balls = with_balls;
  calls_.start(slow_lane, "Calibrate",
               [this, request] { return calls_.ask<Calibrate>(node_, topics::calibrate, request).message; });
}

}  // namespace soft_robot_lab
