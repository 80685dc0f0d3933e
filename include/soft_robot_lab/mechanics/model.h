// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "actuator.h"
#include "body.h"
#include "marker.h"
#include "solver_options.h"

namespace soft_robot_lab {

struct SolverTables;

// A body with its actuators and markers, how it is solved, and what solvers work out about it once. It never changes:
// simulations in several threads share one.
class Model {
 public:
  // Throws std::invalid_argument where no node is fixed, two actuators or markers share a name, or an option is out of
  // range.
  Model(Body body, std::vector<std::unique_ptr<Actuator>> actuators, std::vector<Marker> markers,
        const SolverOptions& options);
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  const Body& body() const { return body_; }
  const SolverOptions& options() const { return options_; }
  const std::vector<Marker>& markers() const { return markers_; }
  const std::vector<std::unique_ptr<const Actuator>>& actuators() const { return actuators_; }
  int actuator_index(const std::string& name) const;  // throws std::invalid_argument listing the names
  int marker_index(const std::string& name) const;    // the same
  const SolverTables& tables() const { return *tables_; }

 private:
  Body body_;
  std::vector<std::unique_ptr<const Actuator>> actuators_;
  std::vector<Marker> markers_;
  SolverOptions options_;
  std::unique_ptr<const SolverTables> tables_;
};

}  // namespace soft_robot_lab
