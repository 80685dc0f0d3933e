// SPDX-License-Identifier: BSD-3-Clause
// Core types to messages and back. Frame of all positions: robot_base.
#pragma once

#include <map>
#include <string>

#include <Eigen/Geometry>
#include <geometry_msgs/Point.h>
#include <geometry_msgs/Quaternion.h>
#include <geometry_msgs/Vector3.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/time.h>
#include <sensor_msgs/JointState.h>

#include "messages.h"
#include "robot/scene/scene_motion.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

geometry_msgs::Point to_message(const Eigen::Vector3d& position_m);
geometry_msgs::Quaternion to_message(const Eigen::Quaterniond& turn);
geometry_msgs::Vector3 vector_message(const Eigen::Vector3d& vector);

// Throws std::invalid_argument naming the field where a coordinate is not finite, or far beyond any robot.
Eigen::Vector3d from_message(const geometry_msgs::Point& position, const std::string& field);
Eigen::Vector3d from_message(const geometry_msgs::Vector3& vector, const std::string& field);

// Throws std::invalid_argument: names, positions and sources that are not as many, or positions as above.
void require_whole(const MarkerObservations& markers);

MarkerObservations marker_observations(const Simulation& simulation, const ros::Time& stamp);
ActuatorRanges actuator_ranges(const Simulation& simulation, const ros::Time& stamp);
ActuatorState actuator_states(const Simulation& simulation, const ros::Time& stamp);

// Of each actuator as `position` its command as reached, in the unit of that command, and as `effort` what it pulls or
// presses with: tension [N], gauge pressure [Pa]. For tools that know only joints.
sensor_msgs::JointState joint_states(const ActuatorState& actuators);

// What holds the body where it is clamped, all holds together, about the origin of robot_base [N, Nm].
geometry_msgs::WrenchStamped reaction_of(const Simulation& simulation, const ros::Time& stamp);

Contacts contacts(const Simulation& simulation, const ros::Time& stamp);

// By the name of the surface it acts on.
std::map<std::string, double> gauge_pressures_pa(const Simulation& simulation);

// Sets all commands of the message, or none: throws std::invalid_argument naming actuator, value and allowed range.
void apply_command(const ActuatorCommand& command, Simulation& simulation);
void apply_command(const ActuatorCommand& command, SceneMotion& motion);

// The position of a named marker; throws std::invalid_argument listing the known names.
Eigen::Vector3d position_of(const MarkerObservations& markers, const std::string& name);

}  // namespace soft_robot_lab
