// SPDX-License-Identifier: BSD-3-Clause
// The rest states of many commands, each sought from a neighbour's, in several threads.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// What was found for one point.
struct WorkspacePoint {
  std::string failure;   // empty, or why there is no rest state
  bool snapped = false;  // the way from the neighbour leads through an unstable shape: the body buckles there
  Eigen::Matrix3Xd markers_m;
  std::vector<ActuatorReading> actuators;
  Eigen::MatrixXd jacobian_m;  // of one marker, 3 x actuators: d position / d command
};

struct WorkspaceWalk {
  std::shared_ptr<const Model> model;
  int marker = 0;            // whose Jacobian is asked for
  Eigen::MatrixXd commands;  // actuators x points, within their limits
  std::vector<int> starts;   // of each point (starts.h)
  std::vector<bool> wanted;  // points to find; others only where the way to a wanted one leads over them
  int threads = 1;           // >= 1
  // Called with each wanted point, by one thread at a time; false: stop as soon as those under way are found.
  std::function<bool(int point, const WorkspacePoint& found)> found;
};

// What is found is the same for any number of threads and any set of wanted points. Throws what `found` throws,
// std::runtime_error where the robot does not rest at its rest commands, and std::invalid_argument where an actuator
// has no rest state.
void walk_workspace(const WorkspaceWalk& walk);

// How far the marker moves at least, where the commands change by a unit of length in some direction; commands in their
// ranges [m]. Of as many directions as actuators can move it in, three at most: near zero the robot hardly moves along
// one of them there.
double least_singular_value_m(const Eigen::MatrixXd& jacobian_m, const Eigen::VectorXd& ranges);

// Whether the body snaps between two neighbours: the marker moves otherwise than the mean of both derivatives leads to,
// by more than their mean length. A cable that becomes taut between them explains no more than that.
bool folded_between(const Eigen::Vector3d& from_m, const Eigen::MatrixXd& from_jacobian_m, const Eigen::Vector3d& to_m,
                    const Eigen::MatrixXd& to_jacobian_m, const Eigen::VectorXd& command_change);

}  // namespace soft_robot_lab
