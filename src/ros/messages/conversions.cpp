// SPDX-License-Identifier: BSD-3-Clause
#include "conversions.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "frames.h"
#include "robot/scene/reaction.h"
#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

CableState cable_state(const ActuatorReading& state) {
  CableState cable;
  cable.name = state.name;
  cable.length_m = *state.length_m;
  cable.rest_length_m = state.rest_length_m.value_or(*state.length_m);
  cable.tension_n = state.tension_n.value_or(0.0);
  cable.stretch_m = state.stretch_m.value_or(0.0);
  cable.slack_m = state.slack_m.value_or(0.0);
  cable.pretension_n = state.pretension_n.value_or(0.0);
  for (const Eigen::Vector3d& point_m : state.path_m) cable.path.push_back(to_message(point_m));
  return cable;
}

ChamberState chamber_state(const ActuatorReading& state) {
  ChamberState chamber;
  chamber.name = state.name;
  chamber.volume_m3 = *state.volume_m3;
  chamber.initial_volume_m3 = state.initial_volume_m3.value_or(*state.volume_m3);
  chamber.gauge_pressure_pa = state.gauge_pressure_pa.value_or(0.0);
  if (state.center_m) chamber.centre = to_message(*state.center_m);
  return chamber;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

constexpr double largest_vector = 1e6;  // of no unit in particular: squares and sums of these are finite

Eigen::Vector3d checked(const Eigen::Vector3d& vector, const std::string& field, const std::string& unit,
                        double largest) {
  if (vector.allFinite() && vector.cwiseAbs().maxCoeff() <= largest) return vector;
  std::ostringstream message;
  message << field << ": [" << vector.x() << ", " << vector.y() << ", " << vector.z()
          << "] must be three finite numbers" << unit << ", within " << largest;
  throw std::invalid_argument(message.str());
}

}  // namespace

geometry_msgs::Point to_message(const Eigen::Vector3d& position_m) {
  geometry_msgs::Point point;
  point.x = position_m.x();
  point.y = position_m.y();
  point.z = position_m.z();
  return point;
}

geometry_msgs::Quaternion to_message(const Eigen::Quaterniond& turn) {
  geometry_msgs::Quaternion message;
  message.x = turn.x();
  message.y = turn.y();
  message.z = turn.z();
  message.w = turn.w();
  return message;
}

geometry_msgs::Vector3 vector_message(const Eigen::Vector3d& vector) {
  geometry_msgs::Vector3 message;
  message.x = vector.x();
  message.y = vector.y();
  message.z = vector.z();
  return message;
}

Eigen::Vector3d from_message(const geometry_msgs::Point& position, const std::string& field) {
  return checked({position.x, position.y, position.z}, field, " [m]", limits::kPlace_m);
}

Eigen::Vector3d from_message(const geometry_msgs::Vector3& vector, const std::string& field) {
  return checked({vector.x, vector.y, vector.z}, field, "", largest_vector);
}

void require_whole(const MarkerObservations& markers) {
  const size_t count = markers.names.size();
  if (markers.positions.size() != count || markers.sources.size() != count)
    throw std::invalid_argument("markers: " + std::to_string(count) + " names, " +
                                std::to_string(markers.positions.size()) + " positions and " +
                                std::to_string(markers.sources.size()) + " sources; they must be as many");
  for (const geometry_msgs::Point& position : markers.positions) from_message(position, "positions");
}

MarkerObservations marker_observations(const Simulation& simulation, const ros::Time& stamp) {
  MarkerObservations message;
  message.header.stamp = stamp;
  message.header.frame_id = robot_frame();
  const size_t count = simulation.markers().size();
  for (size_t i = 0; i < count; ++i) {
    message.names.push_back(simulation.markers()[i].name());
    message.positions.push_back(to_message(simulation.marker_position(static_cast<int>(i))));
  }
  message.covariances.assign(9 * count, 0.0);
  message.sources.assign(count, MarkerObservations::SIMULATED);
  return message;
}

ActuatorRanges actuator_ranges(const Simulation& simulation, const ros::Time& stamp) {
  ActuatorRanges message;
  message.header.stamp = stamp;
  for (const auto& actuator : simulation.actuators()) {
    const CommandLimits& limits = actuator->limits();
    message.names.push_back(actuator->name());
    message.units.push_back(limits.unit);
    message.rests.push_back(limits.rest);
    message.mins.push_back(limits.min);
    message.maxs.push_back(limits.max);
  }
  return message;
}

Contacts contacts(const Simulation& simulation, const ros::Time& stamp) {
  Contacts message;
  message.header.stamp = stamp;
  message.header.frame_id = robot_frame();
  for (const ContactReading& reading : simulation.contacts()) {
    if (reading.normal_force_n == 0.0) continue;
    Contact contact;
    contact.first = reading.on;
    contact.second = reading.surface;
    contact.force = vector_message(reading.force_n);
    contact.normal_force_n = reading.normal_force_n;
    contact.center = to_message(reading.center_m);
    contact.normal = vector_message(reading.normal);
    contact.area_m2 = reading.area_m2;
    contact.sticking_area_m2 = reading.sticking_area_m2;
    contact.slipping_area_m2 = reading.slipping_area_m2;
    contact.largest_penetration_m = reading.largest_penetration_m;
    message.contacts.push_back(std::move(contact));
  }
  return message;
}

ActuatorState actuator_states(const Simulation& simulation, const ros::Time& stamp) {
  ActuatorState message;
  message.header.stamp = stamp;
  message.header.frame_id = robot_frame();
  for (int i = 0; i < static_cast<int>(simulation.actuators().size()); ++i) {
    const ActuatorReading state = simulation.actuator_state(i);
    message.names.push_back(state.name);
    message.commands.push_back(state.command);
    message.actuated_commands.push_back(state.actuated_command);
    if (state.length_m) message.cables.push_back(cable_state(state));
    if (state.volume_m3) message.chambers.push_back(chamber_state(state));
  }
  return message;
}

sensor_msgs::JointState joint_states(const ActuatorState& actuators) {
  std::map<std::string, double> efforts;
  for (const CableState& cable : actuators.cables) efforts[cable.name] = cable.tension_n;
  for (const ChamberState& chamber : actuators.chambers) efforts[chamber.name] = chamber.gauge_pressure_pa;
  sensor_msgs::JointState message;
  message.header = actuators.header;
  message.name = actuators.names;
  message.position = actuators.actuated_commands;
  for (const std::string& name : actuators.names) message.effort.push_back(efforts[name]);
  return message;
}

geometry_msgs::WrenchStamped reaction_of(const Simulation& simulation, const ros::Time& stamp) {
  const Reaction reaction = total_reaction(simulation, simulation.reaction_forces_n());
  geometry_msgs::WrenchStamped message;
  message.header.stamp = stamp;
  message.header.frame_id = robot_frame();
  message.wrench.force = vector_message(reaction.force_n);
  message.wrench.torque = vector_message(reaction.moment_nm);
  return message;
}

std::map<std::string, double> gauge_pressures_pa(const Simulation& simulation) {
  std::map<std::string, double> pressures_pa;
  for (int i = 0; i < static_cast<int>(simulation.actuators().size()); ++i) {
    const ActuatorReading state = simulation.actuator_state(i);
    if (state.gauge_pressure_pa && !state.surface.empty()) pressures_pa[state.surface] = *state.gauge_pressure_pa;
  }
  return pressures_pa;
}

namespace {

double command_of(const Simulation& simulation, int actuator) {
  return simulation.state().drives[static_cast<size_t>(actuator)].command;
}
double command_of(const SceneMotion& motion, int actuator) {
  return motion.drives()[static_cast<size_t>(actuator)].command;
}

int index_of(const Simulation& simulation, const std::string& name) { return simulation.actuator_index(name); }
int index_of(SceneMotion& motion, const std::string& name) { return motion.simulation().actuator_index(name); }

// All of them or none.
template <class Moved>
void apply_to(Moved& moved, const ActuatorCommand& command) {
  if (command.names.size() != command.values.size()) {
    throw std::invalid_argument("values: " + std::to_string(command.values.size()) + " values for " +
                                std::to_string(command.names.size()) + " names; they must be as many");
  }
  const std::set<std::string> different(command.names.begin(), command.names.end());
  if (different.size() != command.names.size()) throw std::invalid_argument("names: an actuator is named twice");
  std::vector<std::pair<std::string, double>> replaced;
  try {
    for (size_t i = 0; i < command.names.size(); ++i) {
      const double old = command_of(moved, index_of(moved, command.names[i]));
      moved.set_command(command.names[i], command.values[i]);
      replaced.emplace_back(command.names[i], old);
    }
  } catch (const std::invalid_argument&) {
    std::reverse(replaced.begin(), replaced.end());
    for (const auto& [name, value] : replaced) moved.set_command(name, value);
    throw;
  }
}

}  // namespace

void apply_command(const ActuatorCommand& command, Simulation& simulation) { apply_to(simulation, command); }
void apply_command(const ActuatorCommand& command, SceneMotion& motion) { apply_to(motion, command); }

Eigen::Vector3d position_of(const MarkerObservations& markers, const std::string& name) {
  const auto found = std::find(markers.names.begin(), markers.names.end(), name);
  if (found == markers.names.end()) {
    throw std::invalid_argument("marker: '" + name + "' is not one of " + joined(markers.names));
  }
  return from_message(markers.positions.at(found - markers.names.begin()), "positions");
}

}  // namespace soft_robot_lab
