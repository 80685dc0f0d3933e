// SPDX-License-Identifier: BSD-3-Clause
// What a search may believe where a reduced model was trained: the same questions as to the ForwardModel, some hundred
// times cheaper, and wrong by the reduced model's error.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mechanics/reduced/audit.h"
#include "mechanics/reduced/reduced_markers.h"
#include "mechanics/reduced/reduced_simulation.h"
#include "soft_robot_lab/control/reach_problem.h"

namespace soft_robot_lab {

class ReducedForwardModel {
 public:
  // Names in the model; throws std::invalid_argument listing the known ones.
  ReducedForwardModel(std::shared_ptr<const ReducedModel> model, const std::vector<std::string>& markers,
                      const std::vector<std::string>& actuators);

  // As Simulation has it. Then what asks the model may throw ForwardModelInterrupted.
  void set_interrupt(const std::function<bool()>& ends) { simulation_.set_interrupt(ends); }

  // Whether these commands of all actuators lie within what the model was trained for.
  bool knows(const std::vector<double>& commands) const;

  // To rest at these commands of all actuators, from the rest shape; throws ForwardModelError.
  void start_at(const std::vector<double>& commands);

  // Equilibrium from the nearest of the last ones found. Throws ForwardModelError where none was found; the model is
  // then as before.
  Prediction predict(const Eigen::VectorXd& commands, bool with_derivatives);

  // The same for a step of a search: throws ForwardModelError too where the body would buckle on the way.
  Prediction try_out(const Eigen::VectorXd& commands, bool with_derivatives);

  // Cuts the bounds of a problem to the trained range, and makes itself its model; must outlive its use.
  void answer_for(ReachProblem& problem);

  // From here on it answers, to first order about these commands, as a model that has the markers (all, 3 x markers)
  // and derivatives (3*markers x actuators) there: manifold mapping (Echeverria & Hemker 2005).
  void correct(const Eigen::VectorXd& commands, const Eigen::Matrix3Xd& markers_m, const Eigen::MatrixXd& jacobian);

  Eigen::Matrix3Xd markers_m();  // one column per marker named, before any correction
  const ReducedState& state() const { return simulation_.state(); }

 private:
  Eigen::MatrixXd named(const Eigen::MatrixXd& jacobian) const;  // of these markers and actuators
  struct Known {
    Eigen::VectorXd commands;
    ReducedState state;
  };

  bool start_near(const Eigen::VectorXd& commands);  // whether that is at these commands already
  void remember(const Eigen::VectorXd& commands);
  void follow(const Eigen::VectorXd& commands);
  void move(const Eigen::VectorXd& commands);
  Prediction answer(const Eigen::VectorXd& commands, bool with_derivatives, const std::function<void()>& settle);
  std::vector<ActuatorReading> readings(const Eigen::VectorXd& multipliers) const;
  void add_derivatives(Prediction& prediction);

  std::shared_ptr<const ReducedModel> model_;
  ReducedSimulation simulation_;
  ReducedMarkers places_;
  std::vector<int> markers_, actuators_;
  std::vector<Known> known_;      // the last equilibria
  Eigen::VectorXd corrected_at_;  // commands; empty: nothing is corrected
  Eigen::VectorXd offsets_m_;     // 3*marker + axis
  Eigen::MatrixXd slopes_;        // the same x commands
};

}  // namespace soft_robot_lab
