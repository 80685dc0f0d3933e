// SPDX-License-Identifier: BSD-3-Clause
#include "random_robots.h"

#include <algorithm>
#include <stdexcept>

#include "control/identification/fit_parameters.h"
#include "robot/scene/parameters.h"
#include "study/sweeps/sampling.h"

namespace soft_robot_lab {
namespace {

const std::vector<std::string> kAxes = {"x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"};

std::string after_dot(const std::string& name) { return name.substr(name.find('.') + 1); }

Eigen::Isometry3d camera_of(const std::vector<StudyParameter>& cameras, const double* values) {
  Eigen::Matrix<double, 6, 1> six = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const auto axis = std::find(kAxes.begin(), kAxes.end(), after_dot(cameras[i].name));
    if (axis == kAxes.end())
      throw std::invalid_argument("parameters: " + cameras[i].name +
                                  " is not camera_to_base. with x_m, y_m, z_m, rx_rad, ry_rad or rz_rad");
    six[axis - kAxes.begin()] = values[i];
  }
  const Eigen::Vector3d turn = six.tail<3>();
  Eigen::Isometry3d camera = Eigen::Isometry3d::Identity();
  camera.translation() = six.head<3>();
  camera.linear() = Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()).toRotationMatrix();
  return camera;
}

std::vector<double> rest_commands(const Simulation& simulation) {
  std::vector<double> commands;
  for (const auto& actuator : simulation.actuators()) commands.push_back(actuator->limits().rest);
  return commands;
}

RandomRobot make_robot(const Randomisation& random, const SceneOptions& asked, const std::vector<double>& values) {
  ParameterValues numbers;
  for (std::size_t i = 0; i < random.study.parameters.size(); ++i)
    numbers.emplace_back(random.study.parameters[i].name, values[i]);
  SceneOptions options = asked;
  options.overrides.lay(parameter_overrides(load_settings(random.study.scene), numbers));
  Scene scene = load_scene(random.study.scene, options);
  if (const SolveReport rest = scene.simulation->solve_equilibrium(); !rest.converged)
    throw std::runtime_error("a random robot does not rest: " + rest.message);
  std::map<std::string, double> backlash_m;
  const std::size_t first = random.study.parameters.size();
  for (std::size_t i = 0; i < random.drives.size(); ++i)
    backlash_m[after_dot(random.drives[i].name)] = std::max(0.0, values[first + i]);
  DrivePlay play(*scene.simulation, backlash_m);
  play.go(rest_commands(*scene.simulation));
  const Eigen::Isometry3d camera = camera_of(random.cameras, values.data() + first + random.drives.size());
  return {values, std::move(scene.simulation), std::move(play), camera};
}

StudySettings all_of(const Randomisation& random, int samples) {
  StudySettings all = random.study;
  all.parameters.insert(all.parameters.end(), random.drives.begin(), random.drives.end());
  all.parameters.insert(all.parameters.end(), random.cameras.begin(), random.cameras.end());
  all.samples = samples;
  return all;
}

}  // namespace

std::vector<std::string> names_of(const Randomisation& random) {
  std::vector<std::string> names;
  for (const StudyParameter& parameter : all_of(random, 1).parameters) names.push_back(parameter.name);
  return names;
}

std::vector<std::vector<double>> values_of(const Randomisation& random, int skip) {
  StudySettings all = all_of(random, random.study.samples);
  all.seed += skip;
  return sample(all);
}

std::vector<RandomRobot> draw_robots(const Randomisation& random, const SceneOptions& options, int skip) {
  std::vector<RandomRobot> robots;
  for (const std::vector<double>& values : values_of(random, skip))
    robots.push_back(make_robot(random, options, values));
  return robots;
}

}  // namespace soft_robot_lab
