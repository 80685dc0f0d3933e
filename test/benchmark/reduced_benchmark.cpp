// SPDX-License-Identifier: BSD-3-Clause
// benchmark_reduced [ROBOT [MODES...]]: trains reduced models of a robot of config/robots (or of its scene SCENE:
// ROBOT/SCENE), and prints a row for each: error on what it was not trained with, and CPU time beside that of newton on
// the same motion, in one process. One thread: OPENBLAS_NUM_THREADS=1.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "mechanics/reduced/audit.h"
#include "mechanics/reduced/held_out.h"
#include "mechanics/reduced/reduced_markers.h"
#include "mechanics/reduced/reduced_simulation.h"
#include "mechanics/reduced/snapshots.h"
#include "mechanics/reduced/train.h"
#include "settings/cpu_time.h"
#include "soft_robot_lab/mechanics/actuators/cable.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

constexpr double kDuration_s = 6.0;
constexpr int kRepeats = 5;
constexpr unsigned kSeed = 7;

Scene robot(const std::string& name) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.cache_folder = SOFT_ROBOT_LAB_CACHE;
  options.actuator_factory = make_actuator;
  return load_scene(std::string(SOFT_ROBOT_LAB_SOURCE) + "/config/robots/" + name +
                        (name.find('/') == std::string::npos ? "/robot" : "") + ".yaml",
                    options);
}

// Of cables contractions as they are used; of chambers from rest to their largest command.
CommandBox commands_of(const Simulation& simulation) {
  CommandBox box;
  for (const auto& actuator : simulation.actuators()) {
    const CommandLimits& limits = actuator->limits();
    const bool cable = dynamic_cast<const Cable*>(actuator.get()) != nullptr;
    box.min.push_back(cable ? 0.75 : limits.rest);
    box.max.push_back(cable ? 1.1 : limits.max);
  }
  return box;
}

struct Cost {
  double us = 0.0, iterations = 0.0, factorisations = 0.0;  // a step
  int unsolved = 0;
};

template <class AnySimulation>
Cost motion(const CommandBox& box, AnySimulation& simulation, double h) {
  const std::vector<std::vector<double>> targets = transient_commands(box, kDuration_s, kSeed);
  const int steps = static_cast<int>(std::lround(kDuration_s / h));
  Cost cost;
  simulation.reset();
  const double start_s = cpu_time_s();
  for (int i = 0; i < steps; ++i) {
    command(targets[std::min(targets.size() - 1, static_cast<std::size_t>(i * h / kTransientHold_s))], simulation);
    const auto report = simulation.step();
    cost.iterations += static_cast<double>(report.iterations) / steps;
    cost.factorisations += static_cast<double>(report.factorisations) / steps;
    cost.unsolved += report.converged ? 0 : 1;
  }
  cost.us = 1e6 * (cpu_time_s() - start_s) / steps;
  return cost;
}

void print(const char* what, const Cost& cost, double h) {
  std::printf(
      "%-8s %8.1f us a step, %7.1f times real time, %.2f iterations and %.2f factorisations a step, %d unsolved\n",
      what, cost.us, 1e6 * h / cost.us, cost.iterations, cost.factorisations, cost.unsolved);
}

void print(const char* what, const ReducedError& error) {
  std::printf("         %-11s rms %.4f mm, max %.4f mm, %d of %d unsolved\n", what, 1e3 * error.rms_m,
              1e3 * error.max_m, error.unsolved, error.states);
}

// 200 equilibria, each from rest, at commands that nothing else is measured at.
void print_audits(const std::shared_ptr<const ReducedModel>& model) {
  constexpr std::size_t kFirst = 7000, kStates = 200;
  Simulation full(model->full);
  ReducedSimulation fast(model);
  Audit audit(*model, model->full);
  std::vector<double> ratios;
  int corrected = 0, solved = 0;
  double cpu_s = 0.0;
  for (std::size_t i = kFirst; i < kFirst + kStates; ++i) {
    full.reset();
    fast.reset();
    command(commands_in(model->box, i), full);
    command(commands_in(model->box, i), fast);
    if (!full.solve_equilibrium().converged || !fast.solve_equilibrium().converged) continue;
    const double start_s = cpu_time_s();
    const AuditResult found = audit.at_rest(fast.state());
    cpu_s += cpu_time_s() - start_s;
    const auto rms_m = [&](const Eigen::Matrix3Xd& markers_m) {
      double sum = 0.0;
      for (Eigen::Index m = 0; m < markers_m.cols(); ++m)
        sum += (markers_m.col(m) - full.marker_position(static_cast<int>(m))).squaredNorm();
      return std::sqrt(sum / static_cast<double>(markers_m.cols()));
    };
    const double error_m = rms_m(ReducedMarkers(*model).places_m(fast.state().at.q));
    ratios.push_back(found.estimate_m / error_m);
    corrected += rms_m(found.markers_m) < error_m ? 1 : 0;
    solved += found.found ? 1 : 0;
  }
  const auto near = std::count_if(ratios.begin(), ratios.end(), [](double r) { return r > 0.5 && r < 2.0; });
  std::sort(ratios.begin(), ratios.end());
  const auto at = [&](double share) { return ratios[static_cast<std::size_t>(share * (ratios.size() - 1))]; };
  std::printf(
      "audits   %zu states: %d within a factor of 2 (2.5 %% %.2f, median %.2f, 97.5 %% %.2f), %d solved, %d nearer "
      "after "
      "correction, %.1f ms each\n",
      ratios.size(), static_cast<int>(near), at(0.025), at(0.5), at(0.975), solved, corrected,
      1e3 * cpu_s / static_cast<double>(ratios.size()));
}

void measure(const Scene& scene, const ReducedTraining& training, const HeldOut& held_out) {
  const double h = scene.simulation->options().time_step_s, start_s = cpu_time_s();
  const std::shared_ptr<const ReducedModel> model = train(scene.simulation->model(), training);
  std::printf("N = %d, %d multipliers, %zu points, %d snapshots, trained in %.1f CPU-s\n",
              static_cast<int>(model->energy.modes()), static_cast<int>(model->energy.pressures()),
              model->energy.points().size(), model->snapshots, cpu_time_s() - start_s);
  ReducedSimulation simulation(model);
  Cost best;
  best.us = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kRepeats; ++i)
    if (const Cost cost = motion(training.box, simulation, h); cost.us < best.us) best = cost;
  print("reduced", best, h);
  print("equilibria", held_out.equilibria(model));
  print("transient", held_out.transient(model));
  print_audits(model);
  std::fflush(stdout);
}

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  using namespace soft_robot_lab;
  const std::string name = argc > 1 ? argv[1] : "spinebot";
  std::vector<int> modes;
  for (int i = 2; i < argc; ++i) modes.push_back(std::atoi(argv[i]));
  if (modes.empty()) modes = {12, 20, 30};
  Scene scene = robot(name);
  ReducedTraining training;
  training.box = commands_of(*scene.simulation);
  const double h = scene.simulation->options().time_step_s;
  print("newton", motion(training.box, *scene.simulation, h), h);
  const HeldOut held_out(scene.simulation->model(), training.box, 20, kDuration_s);
  for (const int count : modes) {
    training.modes = count;
    measure(scene, training, held_out);
  }
}
