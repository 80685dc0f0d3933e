// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "fidelity.h"
#include "mechanics/mesh/subdivide.h"
#include "mechanics/reduced/snapshots.h"

namespace soft_robot_lab {
namespace {

constexpr double kStretch_s = 2.0;       // of a run is judged
constexpr std::size_t kMostTargets = 3;  // of a stretch that no run commands
constexpr double kWay_s = 0.4;           // in which it goes from one to the next
constexpr int kPartsOfWay = 24;
constexpr double kLongestStep_s = 1.0 / 60;  // of those to choose from
constexpr int kHalvings = 4;                 // to the shortest

// Error over difference where the step is halved: 1 / (1 - 2^-order).
double richardson(Integrator integrator) { return integrator == Integrator::implicit_euler ? 2.0 : 4.0 / 3.0; }

// The commands after so many parts of the way.
TimedCommands between(const Simulation& simulation, const std::vector<double>& from, const std::vector<double>& to,
                      int part, double begin_s) {
  TimedCommands timed;
  const double share = static_cast<double>(part) / kPartsOfWay;
  timed.time_s = begin_s + kWay_s * (share - 1.0 / kPartsOfWay);
  for (std::size_t a = 0; a < to.size(); ++a)
    timed.commands.emplace_back(simulation.actuators()[a]->name(), from[a] + share * (to[a] - from[a]));
  return timed;
}

// To the judged commands one after the other, as a hand moves a slider, where the scene's run moves nothing.
RunSettings motion_of(const Simulation& simulation, const RunSettings& run, FidelityUse use) {
  RunSettings motion = run;
  if (run.mode != RunMode::dynamic) {
    motion.mode = RunMode::dynamic;
    motion.duration_s = kStretch_s;
    motion.commands.clear();
    std::vector<std::vector<double>> targets = judged_commands(simulation, run, use);
    std::reverse(targets.begin(), targets.end());  // what a hand may ask for comes first
    if (targets.size() > kMostTargets) targets.resize(kMostTargets);
    std::vector<double> from;
    for (const auto& actuator : simulation.actuators()) from.push_back(actuator->limits().rest);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const double begin_s = kStretch_s * static_cast<double>(i) / static_cast<double>(targets.size());
      for (int part = 1; part <= kPartsOfWay; ++part)
        motion.commands.push_back(between(simulation, from, targets[i], part, begin_s));
      from = targets[i];
    }
  }
  motion.duration_s = std::min(motion.duration_s, kStretch_s);
  motion.record_every_s = 0.0;
  return motion;
}

struct Motion {
  std::vector<Eigen::Matrix3Xd> markers_m;  // at the start, and after each step
  SolveReport solve;
  double duration_s = 0.0;
};

// The first seconds of a scene's motion, as often as asked for.
class Stretch {
 public:
  Stretch(const YamlNode& settings, Judgement& judgement) : settings_(settings), judgement_(judgement) {}

  // Leaves the first trouble in `trouble`.
  Motion run(const TetMesh& mesh, Integrator integrator, double step_s) {
    return run(overrides_of(TimeStepChoice{integrator, step_s}).over(settings_), mesh);
  }
  Motion run(const YamlNode& settings, const TetMesh& mesh) {
    Scene scene = build_scene(settings, mesh, judgement_.options);
    scene.run = motion_of(*scene.simulation, scene.run, judgement_.use);
    RunReport report = run_scene(scene);
    judgement_.count(solve_cost(*scene.simulation->model()), report.solve);
    if (!report.solve.converged && trouble_.empty()) trouble_ = report.solve.message;
    return {std::move(report.trajectory.markers_m), std::move(report.solve), scene.run.duration_s};
  }

  const std::string& trouble() const { return trouble_; }

 private:
  const YamlNode& settings_;
  Judgement& judgement_;
  std::string trouble_;
};

// The first is at every `every`-th place of the second.
double largest_gap_m(const Motion& a, const Motion& b, std::size_t every) {
  double largest = 0.0;
  for (size_t i = 0; i < a.markers_m.size() && every * i < b.markers_m.size(); ++i)
    if (a.markers_m[i].cols() > 0)
      largest = std::max(largest, (a.markers_m[i] - b.markers_m[every * i]).colwise().norm().maxCoeff());
  return largest;
}

double step_error_m(const Motion& step, const Motion& half, Integrator integrator) {
  return richardson(integrator) * largest_gap_m(step, half, 2);
}

// A body that swings puts together over time what a mesh gets wrong: its frequency.
double amplification(Stretch& stretch, const Motion& coarse, const TetMesh& mesh, double rest_error_m,
                     const TimeStepChoice& step) {
  if (rest_error_m <= 0.0) return 1.0;
  TetMesh whole = mesh;
  complete_boundary(whole);
  const Motion fine = stretch.run(subdivide(whole).mesh, step.integrator, step.time_step_s);
  return std::max(1.0, 2.0 * largest_gap_m(coarse, fine, 1) / rest_error_m);
}

void finish(Stretch& stretch, const Motion& step, const TetMesh& mesh, double rest_error_m,
            const TimeStepChoice& choice, TimeError& error) {
  error.amplification = amplification(stretch, step, mesh, rest_error_m, choice);
  error.counts = step.solve;
  error.stretch_s = step.duration_s;
  error.trouble = stretch.trouble();
}

}  // namespace

TimeError estimate_time_error(const YamlNode& settings, const TetMesh& mesh, double rest_error_m,
                              Judgement& judgement) {
  TimeError error;
  Stretch stretch(settings, judgement);
  const SolverOptions solver = build_scene(settings, mesh, judgement.options).simulation->options();
  const TimeStepChoice asked{solver.integrator, solver.time_step_s};
  const Motion step = stretch.run(mesh, asked.integrator, asked.time_step_s);
  const Motion half = stretch.run(mesh, asked.integrator, 0.5 * asked.time_step_s);
  error.error_m = step_error_m(step, half, asked.integrator);
  finish(stretch, step, mesh, rest_error_m, asked, error);
  return error;
}

TimeError choose_time_step(const YamlNode& settings, const TetMesh& mesh, double rest_error_m, double tolerance_m,
                           const TooDear& too_dear, Judgement& judgement) {
  Stretch stretch(settings, judgement);
  // Implicit Euler, the more robust, where its longest step will do; BDF2 gains faster on shorter ones.
  TimeStepChoice choice{Integrator::implicit_euler, kLongestStep_s};
  Motion best = stretch.run(mesh, choice.integrator, choice.time_step_s);
  TimeError error;
  error.error_m = step_error_m(best, stretch.run(mesh, choice.integrator, 0.5 * choice.time_step_s), choice.integrator);
  error.choice = choice;
  if (error.error_m > tolerance_m) {
    choice.integrator = Integrator::bdf2;
    Motion step = stretch.run(mesh, choice.integrator, choice.time_step_s);
    for (int i = 0; i <= kHalvings && !too_dear(step.solve, step.duration_s); ++i) {
      Motion half = stretch.run(mesh, choice.integrator, 0.5 * choice.time_step_s);
      const double here_m = step_error_m(step, half, choice.integrator);
      if (here_m < error.error_m) {
        error.error_m = here_m;
        error.choice = choice;
        best = std::move(step);
      }
      if (error.error_m <= tolerance_m) break;
      choice.time_step_s *= 0.5;
      step = std::move(half);
    }
  }
  finish(stretch, best, mesh, rest_error_m, *error.choice, error);
  return error;
}

std::vector<Eigen::Matrix3Xd> judged_motion(const YamlNode& settings, const TetMesh& mesh, Judgement& judgement,
                                            std::string& trouble) {
  Stretch stretch(settings, judgement);
  std::vector<Eigen::Matrix3Xd> markers_m = stretch.run(settings, mesh).markers_m;
  trouble = stretch.trouble();
  return markers_m;
}

}  // namespace soft_robot_lab
