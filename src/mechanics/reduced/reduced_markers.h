// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "reduced_model.h"

namespace soft_robot_lab {

// The places of a model's markers as functions of reduced coordinates, by the nodes alone that they hang on: a tenth
// of a time step's cost, where all nodes cost as much as the step. One thread's.
class ReducedMarkers {
 public:
  explicit ReducedMarkers(const ReducedModel& model);

  Eigen::Matrix3Xd places_m(const Eigen::VectorXd& q);  // one column per marker, robot_base
  Eigen::MatrixXd motions(const Eigen::VectorXd& q);    // d place / dq: 3*marker + axis x modes

 private:
  void move_nodes(const Eigen::VectorXd& q);

  const std::vector<Marker>& markers_;  // these are the model's
  std::vector<int> nodes_;
  Eigen::VectorXd rest_m_;                   // 3*index + axis, of these nodes
  Eigen::MatrixXd modes_;                    // the same x modes
  Eigen::Matrix3Xd positions_m_, motion_m_;  // of all nodes; of others as at rest, and zero
};

}  // namespace soft_robot_lab
