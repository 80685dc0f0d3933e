// SPDX-License-Identifier: BSD-3-Clause
// time_solvers SCENE ...: CPU of a simulated second by newton and by a scene's reduced model, as a session steps them,
// under commands that change within what the model was trained for. Both take turns five times; the medians count. By
// hand: it says how fast a machine is.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <vector>

#include "mechanics/reduced/snapshots.h"
#include "robot/scene/reduction.h"
#include "robot/scene/scene_motion.h"
#include "settings/cpu_time.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace {

using namespace soft_robot_lab;

constexpr double kDuration_s = 5.0;
constexpr int kTurns = 5;

Scene load(const char* file, const char* method) {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.method = method;
  options.reduced = ReducedUse::trained;
  return load_scene(file, options);
}

// Of steps, with what each step gives the simulation to be published.
double cpu_s(SceneMotion& motion, const std::vector<std::vector<double>>& commands, double step_s) {
  motion.reset();
  motion.solve_equilibrium();
  const double start_s = cpu_time_s();
  for (int i = 0; i < static_cast<int>(kDuration_s / step_s); ++i) {
    const std::vector<double>& now = commands[static_cast<std::size_t>(i * step_s / kTransientHold_s)];
    for (std::size_t a = 0; a < now.size(); ++a) motion.set_command(motion.simulation().actuators()[a]->name(), now[a]);
    motion.step();
    motion.show();
  }
  return (cpu_time_s() - start_s) / kDuration_s;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void measure(const char* file) {
  Scene reduced = load(file, "reduced"), full = load(file, "newton");
  const double step_s = full.simulation->options().time_step_s;
  SceneMotion fast(reduced), newton(full);
  const ReducedModel& model = *reduced.reduction->choice.model;
  const auto commands = transient_commands(model.box, kDuration_s + 1.0, 7);
  std::vector<double> fast_s, newton_s;
  bool left = false;
  for (int turn = 0; turn < kTurns; ++turn) {
    newton_s.push_back(cpu_s(newton, commands, step_s));
    fast_s.push_back(cpu_s(fast, commands, step_s));
    left = left || fast.left();
  }
  const double a = median(newton_s), b = median(fast_s);
  std::printf("%s: step %.4f s, %d modes, CPU s a second: newton %.4f, reduced %.4f (%.1f %%)%s, audited %.3f mm\n",
              file, step_s, model.energy.modes(), a, b, 100.0 * b / a, left ? ", which was left" : "",
              1e3 * fast.audits().largest_estimate_m);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    for (int i = 1; i < argc; ++i) measure(argv[i]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "time_solvers: %s\n", error.what());
    return 2;
  }
}
