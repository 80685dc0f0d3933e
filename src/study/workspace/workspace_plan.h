// SPDX-License-Identifier: BSD-3-Clause
// Which commands of a robot are asked for, as the tasks of a study, so that its journal and its table serve.
#pragma once

#include <string>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "control/workspace/starts.h"
#include "soft_robot_lab/mechanics/simulation.h"
#include "study/sweeps/task.h"

namespace soft_robot_lab {

struct WorkspaceSettings {
  std::string robot;                                           // a scene's or robot's file
  std::vector<std::string> set;                                // PATH=NUMBER
  std::string marker;                                          // empty: `tip`, else the last
  int steps = 21;                                              // of each command, its limits among them
  int samples = 0;                                             // > 0: so many points of Sobol's sequence instead
  int seed = 1;                                                // of samples
  int refine = 0;                                              // so many points more, once these are found
  std::vector<std::tuple<std::string, double, double>> range;  // actuator, least and largest command
};

struct WorkspacePlan {
  StudySettings study;  // a parameter an actuator
  std::vector<StudyTask> tasks;
  Eigen::MatrixXd commands;               // actuators x tasks
  std::vector<int> starts;                // control/workspace/starts.h
  std::vector<NeighbourPair> neighbours;  // whose shapes are compared
  std::string marker;
  Eigen::VectorXd ranges;  // of the commands
  std::size_t even = 0;    // so many points lie on the grid, or are samples; the others are between them
};

// Throws std::invalid_argument: a marker or an actuator that the robot does not have, a range beyond its limits, too
// many points.
WorkspacePlan plan_workspace(const WorkspaceSettings& settings, const Simulation& robot, const std::string& version);

}  // namespace soft_robot_lab
