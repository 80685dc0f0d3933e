// SPDX-License-Identifier: BSD-3-Clause
// What a thread needs of its own to solve a model: matrix, factor, caches and scratch. Nothing in it belongs to a
// state; but the factor is that of the state's `linearisation`, or of none.
#pragma once

#include <memory>

#include "air_spans.h"
#include "skin_overlap.h"
#include "mechanics/xpbd/xpbd_solver.h"
#include "mechanics/newton/newton_solver.h"
#include "mechanics/state/interrupt.h"
#include "soft_robot_lab/mechanics/model.h"

namespace soft_robot_lab {

// What the solvers work out once about a model.
struct SolverTables {
  SolverTables(const Body& body, const std::vector<std::unique_ptr<const Actuator>>& actuators,
               SolverOptions::Method method);

  std::shared_ptr<const NewtonTables> newton;
  std::shared_ptr<const XpbdTables> xpbd;  // where it is the method
  AirSpans air_spans;
  SkinOverlap skin_overlap;
};

struct Workspace {
  explicit Workspace(const SolverTables& tables);
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  Interrupt interrupt;  // that both solvers ask
  NewtonSolver newton;
  std::unique_ptr<XpbdSolver> xpbd;  // where it is the method
};

}  // namespace soft_robot_lab
