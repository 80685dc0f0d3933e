// SPDX-License-Identifier: BSD-3-Clause
// A body's motions within what it was trained for, in some tens of unknowns. It knows one load case: the loads and
// gravity of its model, and commands within its box.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "reduced_constraints.h"
#include "reduced_energy.h"
#include "reduced_skin.h"
#include "soft_robot_lab/mechanics/model.h"

namespace soft_robot_lab {

// Per actuator, in the model's order.
struct CommandBox {
  std::vector<double> min, max;
};

// Against the full model on the same mesh: distances of nodes, over all nodes, states and steps compared.
struct ReducedError {
  int states = 0, unsolved = 0;  // of either model
  double rms_m = 0.0, max_m = 0.0;
};

// Rest states that training came to from the rest shape, one a column.
struct KnownRests {
  Eigen::MatrixXd commands, q, pressures, multipliers;  // of actuators, modes, elements, constraints
};

// It never changes once trained; simulations in several threads share one.
struct ReducedModel {
  std::shared_ptr<const Model> full;
  CommandBox box;
  ReducedBasis basis;
  ReducedEnergy energy;
  ReducedConstraints constraints;
  ReducedSkin skin;
  Eigen::VectorXd point_factors;  // as kept; empty where every point is
  KnownRests rests;
  double mass_kg, size_m;                // of the body
  int snapshots = 0, failed_solves = 0;  // of the training

  ReducedModel(std::shared_ptr<const Model> model, CommandBox commands, ReducedBasis modes)
      : full(std::move(model)),
        box(std::move(commands)),
        basis(std::move(modes)),
        energy(full->body(), basis),
        constraints(*full, basis.modes),
        mass_kg(full->body().node_masses_kg().sum()),
        size_m(full->body().size_m()) {}

  void let_touch(const std::vector<FacePair>& pairs) {
    if (!pairs.empty()) skin = ReducedSkin(full->body(), basis.modes, pairs);
  }

  void hyper_reduce(const Eigen::VectorXd& factors) {
    energy.hyper_reduce(factors, full->body());
    point_factors = factors;
  }

  Eigen::Matrix3Xd positions_m(const Eigen::VectorXd& q) const {
    const Eigen::VectorXd moved = basis.modes * q;
    return full->body().mesh().nodes_m + Eigen::Map<const Eigen::Matrix3Xd>(moved.data(), 3, moved.size() / 3);
  }
};

}  // namespace soft_robot_lab
