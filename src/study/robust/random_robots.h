// SPDX-License-Identifier: BSD-3-Clause
// Robots that differ from a model as a randomisation draws them.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "control/identification/drive_play.h"
#include "randomisation_file.h"
#include "soft_robot_lab/control/forward_model.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

struct RandomRobot {
  std::vector<double> values;  // of the randomisation's parameters: the file's, the drives', the cameras'
  std::unique_ptr<Simulation> simulation;
  DrivePlay play;
  Eigen::Isometry3d measured_from_base = Eigen::Isometry3d::Identity();
};

// At rest under rest commands. The same for the same seed; `skip` leaves out so many, as to have others. Throws as
// load_scene, std::invalid_argument for unknown cables and axes, std::runtime_error where one does not rest.
std::vector<RandomRobot> draw_robots(const Randomisation& randomisation, const SceneOptions& options, int skip = 0);

// The names of values.
std::vector<std::string> names_of(const Randomisation& randomisation);

// The values of each robot, without the robots.
std::vector<std::vector<double>> values_of(const Randomisation& randomisation, int skip = 0);

}  // namespace soft_robot_lab
