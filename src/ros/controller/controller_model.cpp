// SPDX-License-Identifier: BSD-3-Clause
#include "controller_model.h"

#include <stdexcept>

#include <ros/time.h>

namespace soft_robot_lab {

ControllerModel::Lock ControllerModel::lock_or_refuse() {
  Lock lock = try_lock();
  if (!lock) throw std::runtime_error("busy: the model is used by another request; ask again when that ended");
  return lock;
}

void ControllerModel::take(Scene scene) {
  motion_.reset();
  simulation_ = std::move(scene.simulation);
  motion_.emplace(*simulation_, std::move(scene.reduction));
  surface_ = std::make_unique<SurfaceMarker>(simulation_->body().mesh());
  searched_ = true;
}

void ControllerModel::leave_reduced() {
  motion_.emplace(*simulation_, nullptr);
  searched_ = true;
}

bool ControllerModel::follow(const std::map<std::string, double>& commands) {
  if (searched_) motion_->reset();
  searched_ = false;
  motion_->to_reduced();
  for (const auto& [name, value] : commands) motion_->set_command(name, value);
  const bool found = motion_->solve_equilibrium().converged;
  motion_->show();
  return found;
}

std::vector<Eigen::Vector3d> ControllerModel::markers_m() const {
  std::vector<Eigen::Vector3d> markers_m;
  for (int i = 0; i < static_cast<int>(simulation_->markers().size()); ++i)
    markers_m.push_back(simulation_->marker_position(i));
  return markers_m;
}

visualization_msgs::Marker ControllerModel::skin() {
  return surface_->message(simulation_->state().positions_m, ros::Time::now());
}

}  // namespace soft_robot_lab
