// SPDX-License-Identifier: BSD-3-Clause
// How fast the robots of config/robots are simulated, and Spinebot taught. CPU time of one thread: run with
// OPENBLAS_NUM_THREADS=1 on a quiet machine. Comparable between versions on one machine; the ratio of the two methods
// also between machines.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/control/forward_model.h"
#include "soft_robot_lab/control/optimiser.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "settings/cpu_time.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "smallest.h"

namespace soft_robot_lab {
namespace {

constexpr double kPi = 3.14159265358979323846;
const std::string kConfig = std::string(SOFT_ROBOT_LAB_SOURCE) + "/config/";

Scene robot(const std::string& name, const std::string& file = "robot") {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.cache_folder = SOFT_ROBOT_LAB_CACHE;
  options.actuator_factory = make_actuator;
  return load_scene(kConfig + "robots/" + name + "/" + file + ".yaml", options);
}

Scene spinebot() { return robot("spinebot"); }

std::vector<std::string> actuator_names(const Simulation& simulation) {
  std::vector<std::string> names;
  for (const auto& actuator : simulation.actuators()) names.push_back(actuator->name());
  return names;
}

// Pulls the cables in turn, each between 0 and 20 %, once in two seconds; never at rest.
void pull_in_turn(Simulation& simulation) {
  const std::vector<std::string> names = actuator_names(simulation);
  for (size_t i = 0; i < names.size(); ++i) {
    const double phase = 2.0 * kPi * (0.5 * simulation.state().time_s + static_cast<double>(i) / names.size());
    simulation.set_command(names[i], 1.0 - 0.1 * (1.0 - std::cos(phase)));
  }
}

// One cable is pulled by a fifth, which takes it most of the second, and held.
void pull_and_hold(Simulation& simulation) { simulation.set_command("left", 0.8); }

// One simulated second at the scene's time step, so the time shown is CPU time per simulated second.
void SimulateOneSecond(benchmark::State& state, const std::string& name, void (*move)(Simulation&)) {
  Scene scene = robot(name);
  Simulation& simulation = *scene.simulation;
  const int steps = static_cast<int>(std::lround(1.0 / simulation.options().time_step_s));
  int iterations = 0, factorisations = 0, failed = 0;
  const auto one_second = [&] {
    for (int i = 0; i < steps; ++i) {
      move(simulation);
      const SolveReport report = simulation.step();
      iterations += report.iterations;
      factorisations += report.factorisations;
      failed += report.converged ? 0 : 1;
    }
  };
  simulation.solve_equilibrium();
  if (move == pull_in_turn) one_second();  // until all cables move
  iterations = factorisations = failed = 0;
  for (auto _ : state) one_second();
  const double seconds = static_cast<double>(state.iterations());
  state.counters["steps_per_s"] = steps;
  state.counters["iterations_per_step"] = iterations / (steps * seconds);
  state.counters["factorisations_per_step"] = factorisations / (steps * seconds);
  state.counters["not_converged"] = failed;
  state.counters["real_time_factor"] =
      benchmark::Counter(seconds, benchmark::Counter::kIsRate);  // simulated seconds per CPU second
  state.counters["nodes"] = simulation.body().mesh().node_count();
}
#define SIMULATE(robot_name, move)                                             \
  BENCHMARK_CAPTURE(SimulateOneSecond, robot_name##_##move, #robot_name, move) \
      ->Unit(benchmark::kMillisecond)                                          \
      ->Iterations(2)                                                          \
      ->Repetitions(5)                                                         \
      ->ComputeStatistics("min", smallest)                                     \
      ->DisplayAggregatesOnly()
SIMULATE(spinebot, pull_in_turn);
SIMULATE(spinebot, pull_and_hold);
SIMULATE(hammerbot, pull_in_turn);
SIMULATE(hammerbot, pull_and_hold);

// Spinebot pulled from rest to 5 x 5 commands over its range, 1.5 s each: the steps in which it touches itself.
void TouchOverAllCommands(benchmark::State& state) {
  Scene scene = robot("spinebot", "touching");
  Simulation& simulation = *scene.simulation;
  simulation.solve_equilibrium();
  const SimulationState rest = simulation.state();
  const double time_step_s = simulation.options().time_step_s;
  double touching_s = 0.0, cpu_s = 0.0, worst_s = 0.0, deepest_m = 0.0;
  int failed = 0, inverted = 0;
  const auto step = [&] {
    const double start_s = cpu_time_s();
    const SolveReport report = simulation.step();
    const double took_s = cpu_time_s() - start_s;
    failed += report.converged ? 0 : 1;
    inverted += report.inverted_elements;
    const std::vector<ContactReading> contacts = simulation.contacts();
    if (contacts.empty() || contacts[0].area_m2 == 0.0) return;
    touching_s += time_step_s;
    cpu_s += took_s;
    worst_s = std::max(worst_s, took_s);
    deepest_m = std::max(deepest_m, contacts[0].largest_penetration_m);
  };
  for (auto _ : state) {
    for (const double left : {0.7, 0.8, 0.9, 1.0, 1.1}) {
      for (const double right : {0.7, 0.8, 0.9, 1.0, 1.1}) {
        simulation.set_state(rest);
        simulation.set_command("left", left);
        simulation.set_command("right", right);
        for (int i = 0; i < std::lround(1.5 / time_step_s); ++i) step();
      }
    }
  }
  state.counters["times_real_time"] = touching_s / cpu_s;
  state.counters["worst_step_s"] = worst_s;
  state.counters["deepest_um"] = 1e6 * deepest_m;
  state.counters["not_converged"] = failed;
  state.counters["inverted_elements"] = inverted;
}
BENCHMARK(TouchOverAllCommands)->Unit(benchmark::kSecond)->Iterations(1);

// A second of a body at rest, which sleeps.
void RestOneSecond(benchmark::State& state) {
  Scene scene = spinebot();
  Simulation& simulation = *scene.simulation;
  simulation.solve_equilibrium();
  for (int i = 0; i < 10; ++i) simulation.step();
  if (!simulation.state().rest_residual) state.SkipWithError("does not come to rest");
  for (auto _ : state)
    for (int i = 0; i < 60; ++i) simulation.step();
}
BENCHMARK(RestOneSecond)->Unit(benchmark::kMillisecond);

// From rest under gravity to a pull of 5 % on the first cable.
void FindEquilibrium(benchmark::State& state) {
  Scene scene = spinebot();
  Simulation& simulation = *scene.simulation;
  simulation.solve_equilibrium();
  const SimulationState rest = simulation.state();
  SolveReport report;
  for (auto _ : state) {
    simulation.set_state(rest);
    simulation.set_command(simulation.actuators()[0]->name(), 0.95);
    report = simulation.solve_equilibrium();
    if (!report.converged) state.SkipWithError(report.message.c_str());
  }
  state.counters["iterations"] = report.iterations;
  state.counters["nodes"] = simulation.body().mesh().node_count();
}
BENCHMARK(FindEquilibrium)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(10)
    ->Repetitions(3)
    ->ComputeStatistics("min", smallest)
    ->DisplayAggregatesOnly();

OptimisationSummary reach(const std::string& method) {
  const YamlNode task = YamlNode::load_file(kConfig + "robots/spinebot/tasks/ball.yaml");
  Scene scene = spinebot();
  Simulation& simulation = *scene.simulation;
  const std::vector<std::string> names = actuator_names(simulation);
  ForwardModel model(simulation, {task.text("marker")}, names);
  ReachProblem problem;
  model.answer_for(problem);
  problem.goals = {{task.vector3("target_m")}};
  problem.names = names;
  const auto count = static_cast<Eigen::Index>(names.size());
  problem.start = problem.min = problem.max = Eigen::VectorXd(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const CommandLimits& limits = simulation.actuators()[static_cast<size_t>(i)]->limits();
    problem.start[i] = limits.rest;
    problem.min[i] = limits.min;
    problem.max[i] = limits.max;
  }
  OptimiserOptions options;
  options.method = method;
  return optimise(problem, options);
}

void report(const std::string& method, const OptimisationSummary& summary, benchmark::State& state) {
  state.counters[method + "_cpu_s"] = summary.cpu_s;
  state.counters[method + "_mm"] = 1e3 * summary.final_distance_m;
  state.counters[method + "_objective_m2"] = 0.5 * summary.final_distance_m * summary.final_distance_m;
  state.counters[method + "_equilibria"] = summary.evaluations;
  if (!summary.usable) state.SkipWithError((method + ": " + summary.stop_reason).c_str());
}

// The ball of the demonstration by both methods in one run: gauss_newton, and 1000 iterations of rmsprop.
void ReachTheBall(benchmark::State& state) {
  for (auto _ : state) {
    const OptimisationSummary ours = reach("gauss_newton");
    const OptimisationSummary theirs = reach("rmsprop");
    report("gauss_newton", ours, state);
    report("rmsprop", theirs, state);
    state.counters["start_mm"] = 1e3 * ours.initial_distance_m;
    state.counters["cpu_ratio"] = theirs.cpu_s / ours.cpu_s;
  }
}
BENCHMARK(ReachTheBall)->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace soft_robot_lab
