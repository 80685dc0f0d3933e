// SPDX-License-Identifier: BSD-3-Clause
#include "controller_publisher.h"

#include <soft_robot_lab/ActuatorCommand.h>

#include "ros/display/surface_marker.h"

namespace soft_robot_lab {

ControllerPublisher::ControllerPublisher(ros::NodeHandle& node)
    : commands_(node.advertise<ActuatorCommand>(topics::actuator_command, 100)),
      answers_(node.advertise<OptimisePolicyResult>(topics::target_answer, 10)) {}

void ControllerPublisher::send(const std::vector<std::string>& names, const std::vector<double>& values) const {
  ActuatorCommand command;
  command.header.stamp = ros::Time::now();
  command.names = names;
  command.values = values;
  commands_.publish(command);
}

void ControllerPublisher::show_ghost(const visualization_msgs::Marker& skin) { ghost_.publish(ghost_of(skin)); }
void ControllerPublisher::remove_ghost() { ghost_.publish(no_ghost()); }
void ControllerPublisher::show_preview(const visualization_msgs::Marker& skin) { preview_.publish(preview_of(skin)); }
void ControllerPublisher::remove_preview() { preview_.publish(no_preview()); }

}  // namespace soft_robot_lab
