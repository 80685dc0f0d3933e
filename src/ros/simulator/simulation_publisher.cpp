// SPDX-License-Identifier: BSD-3-Clause
#include "simulation_publisher.h"

#include <algorithm>
#include <cmath>

#include <rosgraph_msgs/Clock.h>

#include "ros/messages/conversions.h"
#include "ros/base/latched_publisher.h"
#include "ros/display/obstacle_markers.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {

SimulationPublisher::SimulationPublisher(double surface_rate_hz, bool publish_clock)
    : surface_rate_hz_(surface_rate_hz) {
  if (publish_clock) clock_ = node_.advertise<rosgraph_msgs::Clock>("/clock", 10);
  markers_ = node_.advertise<MarkerObservations>(topics::simulator_markers, 1000);
  actuators_ = node_.advertise<ActuatorState>(topics::simulator_actuators, 10);
  joints_ = node_.advertise<sensor_msgs::JointState>(topics::simulator_joint_states, 10);
  reaction_ = node_.advertise<geometry_msgs::WrenchStamped>(topics::simulator_reaction, 10);
  contacts_ = node_.advertise<Contacts>(topics::simulator_contacts, 10);
  const auto show_again = [this](const auto&) { show_again_ = true; };
  surface_ = advertise_latched<visualization_msgs::Marker>(topics::simulator_surface, show_again);
  obstacles_ = advertise_latched<visualization_msgs::MarkerArray>(topics::simulator_obstacles, show_again);
}

void SimulationPublisher::show(const Simulation& simulation, const ros::Time& stamp) {
  surface_period_ = obstacles_period_ = -1.0;
  obstacles_shown_.clear();
  obstacles_.publish(obstacle_markers(simulation, stamp));
}

void SimulationPublisher::publish(const Simulation& simulation, SurfaceMarker& surface, const ros::Time& stamp) {
  if (clock_) {
    rosgraph_msgs::Clock clock;
    clock.clock = stamp;
    clock_.publish(clock);
  }
  if (show_again_.exchange(false)) {
    surface.forget();
    obstacles_shown_.clear();
  }
  publish_state(simulation, stamp);
  publish_surface(simulation, surface, stamp);
  publish_contact(simulation, stamp);
}

void SimulationPublisher::publish_state(const Simulation& simulation, const ros::Time& stamp) {
  markers_.publish(marker_observations(simulation, stamp));
  const ActuatorState actuators = actuator_states(simulation, stamp);
  actuators_.publish(actuators);
  if (joints_.getNumSubscribers() > 0) joints_.publish(joint_states(actuators));
  if (reaction_.getNumSubscribers() > 0) reaction_.publish(reaction_of(simulation, stamp));
}

namespace {

constexpr double kRounding = 1.0e-6;  // of sums of time steps

double period_at(const ros::Time& stamp, double rate_hz) { return std::floor(stamp.toSec() * rate_hz + kRounding); }

}  // namespace

void SimulationPublisher::publish_surface(const Simulation& simulation, SurfaceMarker& surface,
                                          const ros::Time& stamp) {
  surface.follow_clock(stamp);
  const double period = period_at(stamp, surface_rate_hz_);
  if (period == surface_period_ || !surface.moved(simulation.state().positions_m)) return;
  surface_.publish(surface.message(simulation.state().positions_m, stamp, gauge_pressures_pa(simulation)));
  surface_period_ = period;
}

void SimulationPublisher::publish_contact(const Simulation& simulation, const ros::Time& stamp) {
  if (simulation.body().obstacles().empty() && !simulation.body().touches_itself()) return;
  contacts_.publish(contacts(simulation, stamp));
  const double period = period_at(stamp, surface_rate_hz_);
  if (period == obstacles_period_) return;
  obstacles_period_ = period;
  const std::vector<Eigen::Isometry3d> poses = simulation.obstacle_poses();
  const auto same = [](const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) { return a.matrix() == b.matrix(); };
  if (std::equal(poses.begin(), poses.end(), obstacles_shown_.begin(), obstacles_shown_.end(), same)) return;
  obstacles_.publish(obstacle_markers(simulation, stamp));
  obstacles_shown_ = poses;
}

}  // namespace soft_robot_lab
