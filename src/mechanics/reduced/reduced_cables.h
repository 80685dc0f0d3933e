// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "mechanics/actuators/cable/path_length.h"
#include "soft_robot_lab/mechanics/model.h"

namespace soft_robot_lab {

// The exact lengths of all frictionless cables of a model, as functions of reduced coordinates.
class ReducedCables {
 public:
  // Keeps the model's constraints, so lives no longer than it. Throws std::invalid_argument naming an actuator that is
  // no frictionless cable.
  ReducedCables(const Model& model, const Eigen::MatrixXd& modes);

  struct Values {
    Eigen::MatrixXd gradients;  // modes x cables: d length / dq
    std::vector<ConstraintLaw> laws;
    std::vector<std::vector<Path::Span>> spans;  // per cable
  };
  Values at(const Eigen::VectorXd& q, const Eigen::VectorXd& tensions_n, const DriveStates& drives) const;

  // sum over cables of tension times d2 length / dq2.
  Eigen::MatrixXd hessian(const Values& values, const Eigen::VectorXd& tensions_n) const;

  std::size_t count() const { return cables_.size(); }
  std::size_t actuator_of(std::size_t cable) const { return cables_[cable].actuator; }

 private:
  struct Cable {
    const PathLength* length;
    std::size_t actuator;
    Eigen::VectorXd rest_places_m;       // 3*point + axis
    Eigen::MatrixXd places;              // 3*point + axis x modes
    std::vector<Eigen::MatrixXd> spans;  // per span 3 x modes: second end less first
  };
  void add_cable(const PathLength& length, std::size_t actuator, const Eigen::Matrix3Xd& rest_positions_m,
                 const Eigen::MatrixXd& modes);

  std::vector<Cable> cables_;
  Eigen::Index modes_;
};

}  // namespace soft_robot_lab
