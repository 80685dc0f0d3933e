// SPDX-License-Identifier: BSD-3-Clause
#include "plant.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr double kMostBacklash_steps = 1000.0;

std::map<std::string, double> read_backlash(const YamlNode& file) {
  std::map<std::string, double> backlash_steps;
  const auto node = file.optional_child("backlash_steps");
  if (!node) return backlash_steps;
  for (const std::string& actuator : node->keys())
    backlash_steps[actuator] = node->number(actuator, {0.0, kMostBacklash_steps});
  return backlash_steps;
}

std::map<std::string, CameraShift> read_cameras(const YamlNode& file) {
  std::map<std::string, CameraShift> cameras;
  const auto node = file.optional_child("cameras");
  if (!node) return cameras;
  for (const std::string& name : node->keys()) {
    const YamlNode camera = node->child(name);
    CameraShift& shift = cameras[name];
    shift.translation_m = camera.vector3_or("translation_m", shift.translation_m);
    shift.rotation_deg = camera.vector3_or("rotation_deg", shift.rotation_deg);
  }
  return cameras;
}

}  // namespace

PlantSettings load_plant(const std::string& path) {
  const YamlNode file = YamlNode::load_file(path);
  PlantSettings settings{YamlNode::load_file(path).child("robot"), read_backlash(file), read_cameras(file)};
  file.child("robot").dump();  // counts as read here; its copy is read strictly when the scene is loaded
  file.require_all_read();
  return settings;
}

CameraSetup PlantSettings::shifted(CameraSetup believed) const {
  for (const auto& [name, shift] : cameras) {
    const auto camera = std::find_if(believed.cameras.begin(), believed.cameras.end(),
                                     [&name = name](const RigCamera& one) { return one.pose.name == name; });
    if (camera == believed.cameras.end())
      throw std::invalid_argument("cameras: the rig of cameras has none named '" + name + "'");
    Eigen::Isometry3d& pose = camera->pose.world_from_camera;
    const Eigen::Vector3d turn_rad = shift.rotation_deg * (M_PI / 180.0);
    pose.linear() = Eigen::AngleAxisd(turn_rad.norm(), turn_rad.stableNormalized()) * pose.linear();
    pose.translation() += shift.translation_m;
  }
  return believed;
}

Plant::Plant(const PlantSettings& settings, const SceneOptions& options, std::function<bool()> ends)
    : simulation_(load_scene(settings.robot, options).simulation) {
  simulation_->set_interrupt(std::move(ends));
  const SolveReport report = simulation_->solve_equilibrium();
  if (!report.converged) throw std::runtime_error("plant finds no rest: " + report.message);
  previous_ = simulation_->state();
}

void Plant::advance(double duration_s, const std::vector<std::string>& names, const std::vector<double>& values) {
  if (!(duration_s >= 0.0) || !std::isfinite(duration_s))
    throw std::invalid_argument("duration_s: " + std::to_string(duration_s) + " is out of range [0, inf)");
  if (names.size() != values.size()) throw std::invalid_argument("names and values are not equally many");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const CommandLimits& limits =
        simulation_->actuators()[static_cast<std::size_t>(simulation_->actuator_index(names[i]))]->limits();
    if (!(values[i] >= limits.min && values[i] <= limits.max))
      throw std::invalid_argument(names[i] + ": " + std::to_string(values[i]) + " is out of range [" +
                                  std::to_string(limits.min) + ", " + std::to_string(limits.max) + "]");
  }
  for (std::size_t i = 0; i < names.size(); ++i) simulation_->set_command(names[i], values[i]);
  const double step_s = simulation_->options().time_step_s;
  for (ahead_s_ += duration_s; ahead_s_ >= step_s; ahead_s_ -= step_s) {
    previous_ = simulation_->state();
    const SolveReport report = simulation_->step();
    failed_steps_ += !report.converged || report.inverted_elements > 0;
    if (!report.interrupted) continue;
    ahead_s_ = 0.0;
    return;
  }
}

std::map<std::string, Eigen::Vector3d> Plant::markers_m() const {
  std::map<std::string, Eigen::Vector3d> markers_m;
  for (const Marker& marker : simulation_->markers()) markers_m[marker.name()] = marker.position(present().positions_m);
  return markers_m;
}

}  // namespace soft_robot_lab
