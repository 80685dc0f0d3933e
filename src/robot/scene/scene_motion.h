// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "mechanics/reduced/audit.h"
#include "mechanics/reduced/reduced_markers.h"
#include "mechanics/reduced/reduced_simulation.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

// Moves a scene's simulation. With a reduced model that one moves in its place, until it is given a command that it was
// not trained for, finds no way, or fails an audit: then the simulation goes on from there, with a warning. Audited are
// equilibria, and motion every audit_every_s; a rest state that passes is shown as the audit corrects it.
class SceneMotion {
 public:
  explicit SceneMotion(Scene& scene) : SceneMotion(*scene.simulation, scene.reduction) {}
  // `reduction` may be null. Keeps the simulation, which must outlive it.
  SceneMotion(Simulation& simulation, std::shared_ptr<const SceneReduction> reduction);

  void reset();  // as it was made: the rest shape, and the reduced model where there is one

  // A state of all that moves, to come back to.
  struct Place {
    SimulationState full;
    std::optional<ReducedState> reduced;
  };
  Place place();
  void go_to(const Place& place);

  // Goes on where a state of the same scene is that another solver came to, at its velocities. What solvers remember of
  // steps before is left out. Throws as Simulation::set_state; the state is then the rest shape.
  void go_on_from(const SimulationState& state);

  // For what the reduced model does not know; a warning says why. Nothing where newton moves the robot already.
  void to_newton(const std::string& why);
  // To the reduced model, or to this one, from a state that it can take: within its commands, with no marker farther
  // off than it is trusted to, and, once an audit failed, by one that passes at rest. False where it cannot yet.
  bool to_reduced();
  bool to_reduced(std::shared_ptr<const SceneReduction> trained);

  void set_command(const std::string& actuator, double command);  // throws as Simulation does
  SolveReport step();
  SolveReport solve_equilibrium();

  bool reduced() const { return fast_.has_value(); }                    // still
  bool left() const { return reduction_ && !fast_; }                    // a reduced model, for newton
  const SceneReduction* reduction() const { return reduction_.get(); }  // null where there is none
  double time_s() const;
  Eigen::Matrix3Xd markers_m();  // 3 x markers
  const DriveStates& drives() const;
  int inverted_elements() const { return fast_->inverted_elements(); }  // while reduced()

  void audit_end(SolveReport& report);  // of motion since the last audit
  const RunAudits& audits() const { return audits_; }

  void show();  // gives the simulation the present state
  Simulation& simulation() { return simulation_; }

 private:
  // Nothing where there is no reduced model, or it failed and was left.
  std::optional<SolveReport> by_reduced(ReducedReport (ReducedSimulation::*move)(), const std::string& failure);
  void judge_by_reduction();        // its markers and audits
  std::string audit(bool at_rest);  // empty, or why it failed
  bool trusted_to_begin(const ReducedState& state);
  void leave(const std::string& why);
  void warn(const std::string& text);
  SolveReport finish(SolveReport report);  // with the warnings

  Simulation& simulation_;
  std::shared_ptr<const SceneReduction> reduction_;
  std::optional<ReducedSimulation> fast_;
  std::optional<ReducedMarkers> fast_markers_;
  std::optional<Audit> audit_;
  std::optional<AuditResult> corrected_;  // the present state, where it is a rest state that was audited
  double audited_s_ = 0.0;                // the last time
  RunAudits audits_;
  std::vector<SolveWarning> warnings_;
};

// What several solves came to: all converged, sums, the largest residual, the last message. `total` starts as
// converged.
void add_report(const SolveReport& part, SolveReport& total);

// Throws std::invalid_argument for an unknown actuator, and a value that it refuses.
void require_commands(const Model& model, const std::vector<std::pair<std::string, double>>& commands);

// Steps until the duration of the run has passed, giving commands when their time comes. The simulation keeps the last
// state.
RunReport run_in_time(SceneMotion& motion, const RunSettings& run, const RunProgress& progress = {});

}  // namespace soft_robot_lab
