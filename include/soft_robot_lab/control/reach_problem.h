// SPDX-License-Identifier: BSD-3-Clause
// What an optimisation is about, apart from how it is solved: variables, their bounds, and the objective
//   1/2 sum_k w_k |target_k - marker_k(commands)|^2 + 1/2 sum_i (effort_m (commands_i - rest_i))^2,   sum_k w_k = 1.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// What the model expects at some commands. The derivatives are empty where none were asked for.
struct Prediction {
  Eigen::Matrix3Xd markers_m;        // one column per goal, robot_base
  Eigen::MatrixXd marker_jacobian;   // 3 goals x commands [m per command]
  Eigen::VectorXd tensions_n;        // one per command, 0 for what has none; empty where the model does not know
  Eigen::MatrixXd tension_jacobian;  // commands x commands [N per command]
  Eigen::VectorXd slack;  // one per command: below it by so much an idle one begins to act; empty where all act
};

// Throws ForwardModelError where no equilibrium was found.
using PredictionFunction = std::function<Prediction(const Eigen::VectorXd& commands, bool with_derivatives)>;

struct Goal {
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero();
  double weight = 1.0;  // > 0, relative to the other goals'
};

struct ReachProblem {
  PredictionFunction model;
  PredictionFunction trial = {};   // for a search's steps; may refuse what costs much, and be rough. Empty: `model`
  std::vector<Goal> goals;         // at least one, in the order of the model's markers
  std::vector<std::string> names;  // of the commands, for messages
  Eigen::VectorXd start;           // commands, within the bounds
  Eigen::VectorXd min;
  Eigen::VectorXd max;
  std::vector<std::string> bound_words = {};  // per command why its bounds are where they are; empty: its own limits
  Eigen::VectorXd max_tension_n = {};         // per command, > 0, infinity for none; empty for none at all
  Eigen::VectorXd rest = {};                  // the commands without effort; needed with effort only
  double effort_m = 0.0;                      // >= 0; what distance a unit of command away from rest is worth

  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

}  // namespace soft_robot_lab
