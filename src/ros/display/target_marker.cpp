// SPDX-License-Identifier: BSD-3-Clause
#include "target_marker.h"

#include <cmath>
#include <stdexcept>

#include <tf2/exceptions.h>

#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "ros/messages/image_messages.h"
#include "ros/base/log_text.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

using visualization_msgs::InteractiveMarker;
using visualization_msgs::InteractiveMarkerControl;

// In the plane that faces the eye.
InteractiveMarkerControl ball(double size_m) {
  visualization_msgs::Marker sphere;
  sphere.type = visualization_msgs::Marker::SPHERE;
  sphere.scale.x = sphere.scale.y = sphere.scale.z = 0.35 * size_m;
  sphere.color.r = 0.95f;
  sphere.color.g = 0.55f;
  sphere.color.b = 0.05f;
  sphere.color.a = 0.55f;
  InteractiveMarkerControl control;
  control.name = "ball";
  control.orientation.w = 1.0;
  control.orientation_mode = InteractiveMarkerControl::VIEW_FACING;
  control.interaction_mode = InteractiveMarkerControl::MOVE_PLANE;
  control.independent_marker_orientation = 1;
  control.always_visible = 1;
  control.markers.push_back(sphere);
  return control;
}

InteractiveMarkerControl arrow(const std::string& axis) {
  InteractiveMarkerControl control;
  control.name = axis;
  control.orientation.w = std::sqrt(0.5);
  (axis == "x" ? control.orientation.x : axis == "y" ? control.orientation.z : control.orientation.y) = std::sqrt(0.5);
  control.interaction_mode = InteractiveMarkerControl::MOVE_AXIS;
  return control;
}

double now_s() { return ros::SteadyTime::now().toSec(); }

}  // namespace

TargetMarker::TargetMarker(ros::NodeHandle& node, Moved moved)
    : moved_(std::move(moved)), server_(topics::target_marker) {
  goals_ = node.subscribe(topics::controller_goal, 1, &TargetMarker::on_goal, this);
}

void TargetMarker::show(const std::string& marker, const Eigen::Vector3d& target_m, double size_m) {
  const std::lock_guard lock(mutex_);
  if (held_.held(now_s()) && marker == marker_) return;
  InteractiveMarker target;
  target.header.frame_id = robot_frame();
  target.name = "target";
  target.description = "";  // the overlay writes beside it
  target.pose.position = to_message(target_m);
  target.pose.orientation.w = 1.0;
  target.scale = static_cast<float>(size_m);
  target.controls = {ball(size_m), arrow("x"), arrow("y"), arrow("z")};
  if (marker == marker_ && size_m == size_m_) {
    server_.setPose(target.name, target.pose);
  } else {
    server_.insert(target, [this](const auto& feedback) { on_feedback(*feedback); });
  }
  server_.applyChanges();
  marker_ = marker;
  size_m_ = size_m;
}

void TargetMarker::on_feedback(const Feedback& feedback) {
  const bool down = feedback.event_type == Feedback::MOUSE_DOWN, up = feedback.event_type == Feedback::MOUSE_UP;
  std::string marker;
  {
    const std::lock_guard lock(mutex_);
    if (feedback.event_type == Feedback::KEEP_ALIVE) held_.keep(now_s());
    if (!down && !up && feedback.event_type != Feedback::POSE_UPDATE) return;
    if (up) {
      held_.let_go();
    } else {
      held_.take(now_s());
    }
    marker = marker_;
  }
  if (down) return;
  try {
    moved_(marker, from_message(feedback.pose.position, topics::target_marker), up);
  } catch (const std::invalid_argument& error) {
    ROS_WARN("%s", log_text(error.what()).c_str());
  }
}

Eigen::Vector3d TargetMarker::in_robot_base(const geometry_msgs::PoseStamped& pose) const {
  const Eigen::Vector3d position_m = from_message(pose.pose.position, "pose.position");
  if (pose.header.frame_id == robot_frame()) return position_m;
  try {
    return isometry(frames_.lookupTransform(robot_frame(), pose.header.frame_id, ros::Time(0)).transform) * position_m;
  } catch (const tf2::TransformException&) {
    throw std::invalid_argument("header.frame_id: no transform leads from '" + pose.header.frame_id + "' to '" +
                                robot_frame() + "'");
  }
}

// Only where it is, not how it is turned.
void TargetMarker::on_goal(const geometry_msgs::PoseStamped& goal) {
  try {
    const Eigen::Vector3d target_m = in_robot_base(goal);
    std::string marker;
    {
      const std::lock_guard lock(mutex_);
      marker = marker_;
    }
    if (!marker.empty()) moved_(marker, target_m, true);
  } catch (const std::exception& error) {
    ROS_WARN("%s refused: %s", topics::controller_goal, log_text(error.what()).c_str());
  }
}

}  // namespace soft_robot_lab
