// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "fidelity.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "mechanics/mesh/subdivide.h"

namespace soft_robot_lab {
namespace {

constexpr double kStretch_s = 2.0;           // of a run is judged
constexpr double kLongestStep_s = 1.0 / 60;  // of those to choose from
constexpr int kHalvings = 4;                 // to the shortest

// Error over difference where the step is halved: 1 / (1 - 2^-order).
double richardson(Integrator integrator) { return integrator == Integrator::implicit_euler ? 2.0 : 4.0 / 3.0; }

// The first seconds of a scene's run, as often as asked for.
class Stretch {
 public:
  Stretch(const YamlNode& settings, const SceneOptions& options) : settings_(settings), options_(options) {}

  // Markers every `record_every_s`. Leaves the first trouble in `trouble`.
  Trajectory run(const TetMesh& mesh, Integrator integrator, double step_s, double record_every_s) {
    Scene scene = build_scene(overrides_of(TimeStepChoice{integrator, step_s}).over(settings_), mesh, options_);
    scene.run.duration_s = std::min(scene.run.duration_s, kStretch_s);
    scene.run.record_every_s = record_every_s;
    RunReport report = run_scene(scene);
    if (!report.solve.converged && trouble_.empty()) trouble_ = report.solve.message;
    return std::move(report.trajectory);
  }

  const std::string& trouble() const { return trouble_; }

 private:
  const YamlNode& settings_;
  const SceneOptions& options_;
  std::string trouble_;
};

double largest_gap_m(const Trajectory& a, const Trajectory& b) {
  double largest = 0.0;
  for (size_t i = 0; i < std::min(a.markers_m.size(), b.markers_m.size()); ++i)
    if (a.markers_m[i].cols() > 0)
      largest = std::max(largest, (a.markers_m[i] - b.markers_m[i]).colwise().norm().maxCoeff());
  return largest;
}

double step_error_m(const Trajectory& step, const Trajectory& half, Integrator integrator) {
  return richardson(integrator) * largest_gap_m(step, half);
}

// A body that swings puts together over time what a mesh gets wrong: its frequency.
double amplification(Stretch& stretch, const Trajectory& coarse, const YamlNode& settings, const TetMesh& mesh,
                     const SceneOptions& options, Integrator integrator, double step_s) {
  const MeshError at_rest = estimate_mesh_error(settings, mesh, options);
  if (!at_rest.expected_m || *at_rest.expected_m <= 0.0) return 1.0;
  TetMesh whole = mesh;
  complete_boundary(whole);
  const Trajectory fine = stretch.run(subdivide(whole).mesh, integrator, step_s, step_s);
  return std::max(1.0, 2.0 * largest_gap_m(coarse, fine) / *at_rest.expected_m);
}

}  // namespace

TimeError estimate_time_error(const YamlNode& settings, const TetMesh& mesh, const SceneOptions& options) {
  TimeError error;
  Stretch stretch(settings, options);
  const SolverOptions solver = build_scene(settings, mesh, options).simulation->options();
  const double h = solver.time_step_s;
  const Trajectory step = stretch.run(mesh, solver.integrator, h, h);
  const Trajectory half = stretch.run(mesh, solver.integrator, 0.5 * h, h);
  error.error_m = step_error_m(step, half, solver.integrator);
  error.amplification = amplification(stretch, step, settings, mesh, options, solver.integrator, h);
  error.trouble = stretch.trouble();
  return error;
}

TimeError choose_time_step(const YamlNode& settings, const TetMesh& mesh, const SceneOptions& options,
                           double tolerance_m) {
  TimeError error;
  Stretch stretch(settings, options);
  double h = kLongestStep_s;
  // Implicit Euler, the more robust, where its longest step will do; BDF2 gains faster on shorter ones.
  Integrator integrator = Integrator::implicit_euler;
  Trajectory step = stretch.run(mesh, integrator, h, h);
  error.error_m = step_error_m(step, stretch.run(mesh, integrator, 0.5 * h, h), integrator);
  if (error.error_m > tolerance_m) {
    integrator = Integrator::bdf2;
    for (int i = 0; i <= kHalvings; ++i) {
      h = kLongestStep_s / std::pow(2.0, i);
      step = stretch.run(mesh, integrator, h, h);
      error.error_m = step_error_m(step, stretch.run(mesh, integrator, 0.5 * h, h), integrator);
      if (error.error_m <= tolerance_m) break;
    }
  }
  error.choice = {integrator, h};
  error.amplification = amplification(stretch, step, settings, mesh, options, integrator, h);
  error.trouble = stretch.trouble();
  return error;
}

}  // namespace soft_robot_lab
