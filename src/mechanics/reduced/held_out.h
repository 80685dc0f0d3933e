// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "reduced_model.h"
#include "training_set.h"

namespace soft_robot_lab {

// What the full model does where no reduced one was trained: equilibria at other commands of the box, each from rest,
// and a transient of other commands from the rest shape. Worked out once for all reduced models of that box.
class HeldOut {
 public:
  HeldOut(const std::shared_ptr<const Model>& model, const CommandBox& box, int equilibria, double transient_s,
          const TrainingProgress& progress = {});

  ReducedError equilibria(const std::shared_ptr<const ReducedModel>& reduced) const;
  ReducedError transient(const std::shared_ptr<const ReducedModel>& reduced) const;

  // Of the best shapes that the modes hold over the transient: no equations of motion do better.
  ReducedError projection(const ReducedModel& reduced) const;

 private:
  struct Shape {
    std::vector<double> commands;
    bool converged;
    Eigen::Matrix3Xd positions_m;
  };
  static Shape shape_of(const Simulation& simulation, bool converged);

  std::vector<Shape> equilibria_, transient_;
};

}  // namespace soft_robot_lab
