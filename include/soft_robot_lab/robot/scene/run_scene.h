// SPDX-License-Identifier: BSD-3-Clause
// Carries out what a scene's `run` asks for, and writes down the outcome.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene.h"

namespace soft_robot_lab {

struct Trajectory {
  std::vector<double> time_s;
  std::vector<Eigen::Matrix3Xd> markers_m;  // per time: one column per marker, robot_base
  std::vector<Eigen::Matrix2Xd> commands;   // per time: one column per actuator, as commanded and as its drive reached
  std::vector<FreePoses> free;              // per time: of free obstacles
};

// Of a reduced model, against the full one (mechanics/reduced/audit.h).
struct RunAudits {
  int states = 0;
  double largest_estimate_m = 0.0;  // rms over the markers
  double limit_m = 0.0;             // beyond it the reduced model is left
  bool failed = false;              // one of them; a warning says which
};

struct RunReport {
  SolveReport solve;            // sums over the run; `converged` where all did, the largest residual, the last message
  Trajectory trajectory;        // dynamic runs
  bool left_reduced = false;    // a reduced model did not serve to the end; a warning says why
  RunAudits audits;             // of a reduced model
  Eigen::MatrixXd sensitivity;  // 3*markers x actuators, where the run asked for it and converged; otherwise empty
  Eigen::VectorXd frequencies_hz;  // modal runs, ascending; their `solve.residual` is ModalResult::change
};

// Hears after each step or equilibrium which fraction of the run is done; false ends it there.
using RunProgress = std::function<bool(double fraction)>;

// Equilibrium: solves for each of the timed commands in their order, from the state before, and stops at the first that
// does not converge. Dynamic: steps until the duration has passed, giving commands when their time comes. Modal:
// vibrations about the rest shape (mechanics/simulation/modal.h). The simulation keeps the last state. A run that was
// ended early has not converged, and says so.
RunReport run_scene(Scene& scene, const RunProgress& progress = {});

// result.json (config/README.md, "Scene"). Numbers that are not finite would be written as null, never as NaN.
std::string result_json(const Scene& scene, const RunReport& report);

// The same for a reader's eye, in a few lines.
std::string result_summary(const Scene& scene, const RunReport& report);

}  // namespace soft_robot_lab
