// SPDX-License-Identifier: BSD-3-Clause
// benchmark_xpbd [ROBOT [SECONDS [SUBSTEPS...]]]: error over CPU time of newton and xpbd on the same motion of a robot
// of config/robots, against tr_bdf2 with 16 steps a frame of 1/60 s. One thread: OPENBLAS_NUM_THREADS=1
// OMP_NUM_THREADS=1.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "mechanics/reduced/snapshots.h"
#include "settings/cpu_time.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

constexpr double kFrame_s = 1.0 / 60.0;
constexpr unsigned kSeed = 7;

struct Rung {
  std::string name;
  Overrides solver;
  int steps = 1;  // a frame
};

Simulation robot(const std::string& name, const Rung& rung) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.cache_folder = SOFT_ROBOT_LAB_CACHE;
  options.actuator_factory = make_actuator;
  options.overrides = rung.solver;
  options.overrides.set({"solver", "time_step_s"}, kFrame_s / rung.steps);
  return std::move(
      *load_scene(std::string(SOFT_ROBOT_LAB_SOURCE) + "/config/robots/" + name + "/robot.yaml", options).simulation);
}

struct Run {
  std::vector<Eigen::Matrix3Xd> frames_m;  // nodes
  double cpu_s = 0.0, iterations = 0.0;
  int rejected = 0, unsolved = 0;
};

// New random commands within [0.75, 1.1] every 0.83 s, from `start`.
Run run(const std::string& name, const Rung& rung, double duration_s, const SimulationState& start) {
  Simulation simulation = robot(name, rung);
  SimulationState state = start;
  state.linearisation.reset();
  simulation.set_state(state);
  CommandBox box;
  box.min.assign(simulation.actuators().size(), 0.75);
  box.max.assign(simulation.actuators().size(), 1.1);
  const std::vector<std::vector<double>> targets = transient_commands(box, duration_s, kSeed);
  const int frames = static_cast<int>(std::lround(duration_s / kFrame_s));
  Run result;
  const double start_s = cpu_time_s();
  for (int i = 0; i < frames; ++i) {
    command(targets[std::min(targets.size() - 1, static_cast<std::size_t>(i * kFrame_s / kTransientHold_s))],
            simulation);
    for (int k = 0; k < rung.steps; ++k) {
      const SolveReport report = simulation.step();
      result.iterations += static_cast<double>(report.iterations) / frames;
      result.rejected += report.rejected_steps;
      result.unsolved += report.converged ? 0 : 1;
    }
    result.frames_m.push_back(simulation.state().positions_m);
  }
  result.cpu_s = cpu_time_s() - start_s;
  return result;
}

void print(const Rung& rung, const Run& found, const Run& reference, double duration_s) {
  double sum = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < reference.frames_m.size(); ++i) {
    const Eigen::VectorXd apart = (found.frames_m[i] - reference.frames_m[i]).colwise().norm();
    sum += apart.squaredNorm() / static_cast<double>(apart.size() * reference.frames_m.size());
    largest = std::max(largest, apart.maxCoeff());
  }
  std::printf(
      "%-22s %9.2f ms a second, rms %8.4f mm, max %8.3f mm, %7.1f iterations a frame, %d rejected, %d unsolved\n",
      rung.name.c_str(), 1e3 * found.cpu_s / duration_s, 1e3 * std::sqrt(sum), 1e3 * largest, found.iterations,
      found.rejected, found.unsolved);
  std::fflush(stdout);
}

Overrides integrator(const std::string& name) { return Overrides().set({"solver", "integrator"}, name); }

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  using namespace soft_robot_lab;
  const std::string name = argc > 1 ? argv[1] : "spinebot";
  const double duration_s = argc > 2 ? std::atof(argv[2]) : 3.0;
  std::vector<int> substeps;
  for (int i = 3; i < argc; ++i) substeps.push_back(std::atoi(argv[i]));
  if (substeps.empty()) substeps = {20, 30, 50, 100};
  std::vector<Rung> rungs;
  for (const int steps : {1, 2, 4, 8})
    rungs.push_back({"newton, " + std::to_string(steps) + " a frame", integrator("implicit_euler"), steps});
  for (const int steps : {1, 2, 4})
    rungs.push_back({"newton bdf2, " + std::to_string(steps), integrator("bdf2"), steps});
  for (const int count : substeps)
    rungs.push_back({"xpbd, " + std::to_string(count) + " substeps",
                     Overrides().set({"solver", "method"}, "xpbd").set({"solver", "substeps"}, count), 1});
  const Rung fine = {"reference", integrator("tr_bdf2").set({"solver", "dynamic_tolerance"}, 1e-6), 16};
  Simulation resting = robot(name, rungs[0]);
  resting.solve_equilibrium();
  const SimulationState start = resting.state();
  const Run reference = run(name, fine, duration_s, start);
  print(fine, reference, reference, duration_s);
  for (const Rung& rung : rungs) print(rung, run(name, rung, duration_s, start), reference, duration_s);
}
