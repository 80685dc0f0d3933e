// SPDX-License-Identifier: BSD-3-Clause
// rollouts ROBOT.yaml --commands FILE --output FILE.npz: runs a robot many times, for learning from it.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "load_with_bar.h"
#include "robot/rollouts/rollout_commands.h"
#include "robot/rollouts/rollout_file.h"
#include "robot/scene/parameters.h"
#include "settings/command_line.h"
#include "settings/interrupted.h"
#include "settings/cpu_time.h"
#include "settings/limits.h"
#include "settings/words.h"
#include "settings/write_file.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/rollouts/batch.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  std::string robot, commands, output, result;
  int random = 0;
  double duration_s = 10.0, hold_s = 0.5, record_every_s = 0.0;
  unsigned seed = 1;
  std::vector<std::tuple<std::string, double, double>> range;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  std::vector<std::string> set;
};

void declare(CommandLine& app, Arguments& arguments) {
  app.add_option("ROBOT", arguments.robot, "a scene's or robot's file").type_name("FILE").required();
  CommandLine source = app.add_group("Commands", "one of", 1, 1);
  source.add_option("--commands", arguments.commands, "a table (.csv), or arrays of NumPy (.npz)").type_name("FILE");
  source.add_option("--random", arguments.random, "so many rollouts of random commands")
      .type_name("N")
      .range(1, static_cast<int>(limits::kRollouts));
  CommandLine files = app.add_group("Results", "one of, or both", 1, 2);
  files.add_option("--output", arguments.output, "what the rollouts did, as arrays of NumPy (.npz)").type_name("FILE");
  files.add_option("--result", arguments.result, "the same in a few numbers (.json)").type_name("FILE");
  app.add_option("--duration", arguments.duration_s, "of each rollout").type_name("S").show_default();
  app.add_option("--hold", arguments.hold_s, "of each command, with --random and .npz").type_name("S").show_default();
  app.add_option("--record-every", arguments.record_every_s, "what goes into the output; 0: every step")
      .type_name("S")
      .show_default();
  app.add_option("--seed", arguments.seed, "of random commands").type_name("N").show_default();
  app.add_option("--range", arguments.range, "of an actuator's random commands, instead of its limits")
      .type_name("NAME MIN MAX");
  app.add_option("--threads", arguments.threads, "at a time").type_name("N").range(1, limits::kThreads).show_default();
  app.add_set_option(arguments.set);
  app.footer(
      "Ctrl-C writes the rollouts that have ended. Exit status: 0 all converged, 1 some did not or were not run, 2 "
      "bad\n"
      "robot, commands or arguments.");
}

std::vector<RolloutCommands> commands_for(const Arguments& arguments, const Scene& scene) {
  const Model& model = *scene.simulation->model();
  if (!arguments.commands.empty()) return read_commands_file(arguments.commands, arguments.hold_s, model);
  RandomCommands random{command_box(scene), arguments.random, arguments.duration_s, arguments.hold_s, arguments.seed};
  for (const auto& [name, min, max] : arguments.range) {
    const auto i = static_cast<std::size_t>(model.actuator_index(name));
    model.actuators()[i]->require_in_limits(min);
    model.actuators()[i]->require_in_limits(max);
    if (!(min < max))
      throw std::invalid_argument("--range " + name + ": " + format_number(min) + " must be below " +
                                  format_number(max));
    random.box.min[i] = min;
    random.box.max[i] = max;
  }
  return random_commands(random, model);
}

std::vector<RunReport> run(const Arguments& arguments, const Scene& scene, const RolloutPlan& plan) {
  ProgressBar bar("rollouts");
  int twentieth = -1;
  return RolloutBatch(scene).run(
      plan, arguments.threads,
      [&](std::size_t ended) {
        const double fraction = static_cast<double>(ended) / static_cast<double>(plan.rollouts.size());
        if (const int next = static_cast<int>(20.0 * fraction); next != twentieth) {
          twentieth = next;
          bar.show(fraction, std::to_string(ended) + " of " + std::to_string(plan.rollouts.size()) + " rollouts");
        }
        return !interrupted();
      },
      interrupted);
}

// What went wrong, once for all rollouts; whether anything did.
bool warn(const Scene& scene, const std::vector<RunReport>& reports) {
  std::vector<SolveWarning> warnings;
  std::size_t failed = 0, left = 0, missing = 0;
  for (const RunReport& report : reports) {
    for (const SolveWarning& warning : report.solve.warnings) add_warning(warning, warnings);
    const bool run = !report.trajectory.time_s.empty();
    missing += run ? 0 : 1;
    failed += run && !report.solve.converged ? 1 : 0;
    left += report.left_reduced ? 1 : 0;
  }
  // At its end a rollout may be on its way; `reached` has how far.
  const auto on_its_way = [](const SolveWarning& warning) { return warning.kind == "command_not_reached"; };
  warnings.erase(std::remove_if(warnings.begin(), warnings.end(), on_its_way), warnings.end());
  print_new_warnings("rollouts", scene, warnings);
  if (left > 0) std::cerr << "rollouts: " << left << " left the reduced model, and went on by newton\n";
  if (failed > 0) std::cerr << "rollouts: " << failed << " did not converge\n";
  if (missing > 0) std::cerr << "rollouts: " << missing << " were not run\n";
  return failed + missing > 0;
}

// Who reads an archive goes by its ending. A device, such as /dev/null, needs none.
void require_archive(const std::string& file) {
  namespace fs = std::filesystem;
  if (file.empty() || fs::path(file).extension() == ".npz" || (fs::exists(file) && !fs::is_regular_file(file))) return;
  throw std::invalid_argument("--output: " + file + " must end in .npz: it is an archive of NumPy's arrays");
}

int make_rollouts(const Arguments& arguments) {
  require_archive(arguments.output);
  if (!arguments.commands.empty()) require_commands_ending(arguments.commands);
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.overrides = parameter_overrides(arguments.robot, arguments.set);
  const Scene scene = load_with_bar("rollouts", arguments.robot, options);
  const RolloutPlan plan{arguments.duration_s, arguments.record_every_s, commands_for(arguments, scene)};
  heed_interrupts();
  const auto start = std::chrono::steady_clock::now();
  const double cpu_start_s = cpu_time_s();
  const std::vector<RunReport> reports = run(arguments, scene, plan);
  const double cpu_s = cpu_time_s() - cpu_start_s;
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!arguments.output.empty()) write_file(arguments.output, rollouts_npz(scene, reports));
  if (!arguments.result.empty()) write_file(arguments.result, rollouts_json(scene, reports));
  std::printf("%zu rollouts of %g s in %.2f s, %.2f s CPU: %.0f times real time a core; %s\n", reports.size(),
              arguments.duration_s, wall_s, cpu_s,
              static_cast<double>(reports.size()) * arguments.duration_s / std::max(cpu_s, 1e-9),
              (arguments.output.empty() ? arguments.result : arguments.output).c_str());
  return warn(scene, reports) ? kNotGood : kGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app("Runs a robot many times, with other commands each, without a ROS master.", "rollouts");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return make_rollouts(arguments); });
}
