// SPDX-License-Identifier: BSD-3-Clause
// workspace ROBOT.yaml --output FOLDER: where a robot's marker rests over all its commands, and what that takes.
#include <algorithm>
#include <iostream>
#include <string>
#include <thread>

#include "load_with_bar.h"
#include "progress_bar.h"
#include "robot/scene/parameters.h"
#include "settings/command_line.h"
#include "settings/interrupted.h"
#include "settings/limits.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "study/workspace/refinement.h"
#include "study/workspace/workspace_report.h"
#include "study/workspace/workspace_run.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  WorkspaceSettings settings;
  std::string output;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
};

void declare(CommandLine& app, Arguments& arguments) {
  WorkspaceSettings& settings = arguments.settings;
  app.add_option("ROBOT", settings.robot, "a scene's or robot's file").type_name("FILE").required();
  app.add_option("--output", arguments.output, "the folder of workspace.html, its pictures and results.csv")
      .type_name("FOLDER")
      .required();
  app.add_option("--marker", settings.marker, "whose places are shown (tip, else the last)").type_name("NAME");
  app.add_option("--steps", settings.steps, "of each command on a grid, its limits among them")
      .type_name("N")
      .range(2, 1000)
      .show_default();
  app.add_option("--samples", settings.samples, "so many points of Sobol's sequence instead of a grid")
      .type_name("N")
      .positive();
  app.add_option("--refine", settings.refine, "so many points more, where neighbouring tips are farthest apart")
      .type_name("N")
      .positive();
  app.add_option("--seed", settings.seed, "of the samples").type_name("N").show_default();
  app.add_option("--range", settings.range, "of an actuator's command, instead of its limits")
      .type_name("NAME MIN MAX");
  app.add_option("--threads", arguments.threads, "at a time").type_name("N").range(1, limits::kThreads).show_default();
  app.add_set_option(settings.set);
  app.footer(
      "Ctrl-C shows what is there; the same command goes on from it. Exit status: 0 every command has a rest state,\n"
      "1 some have none or were not asked, 2 bad robot or arguments.");
}

constexpr int kShownEvery_percent = 4;  // who looks on sees points as they come

void find_points(const Arguments& arguments, const WorkspacePlan& plan, const std::shared_ptr<const Model>& model,
                 Journal& journal) {
  ProgressBar bar("workspace");
  int percent = -1;
  run_workspace(plan, model, arguments.threads, journal, [&](const WorkspaceProgress& now) {
    const double fraction = static_cast<double>(now.done) / static_cast<double>(now.points);
    if (const int next = static_cast<int>(100.0 * fraction); next != percent) {
      percent = next;
      bar.show(fraction, std::to_string(now.done) + " of " + std::to_string(now.points) + " commands, " +
                             std::to_string(now.failed) + " without a rest state");
      if (percent % kShownEvery_percent == 0) write_results(workspace_table(plan, journal), arguments.output);
    }
    return !interrupted();
  });
}

int show_workspace(const Arguments& arguments) {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.reduced = ReducedUse::by_newton;  // audits and derivatives of each point cost what a reduced model saves
  options.overrides = parameter_overrides(arguments.settings.robot, arguments.settings.set);
  const Scene scene = load_scene(arguments.settings.robot, options);
  print_warnings("workspace", scene);
  const std::string version = program_version("workspace");
  WorkspacePlan plan = plan_workspace(arguments.settings, *scene.simulation, version);
  Journal journal(arguments.output);
  journal.set_tasks(plan.study, plan.tasks);
  heed_interrupts();
  const std::shared_ptr<const Model> model = scene.simulation->model();
  find_points(arguments, plan, model, journal);
  if (arguments.settings.refine > 0 && !interrupted()) {
    refine_workspace(plan, *model, arguments.settings.refine, version, journal);
    journal.set_tasks(plan.study, plan.tasks);
    find_points(arguments, plan, model, journal);
  }
  const ResultsTable table = workspace_table(plan, journal);
  write_results(table, arguments.output);
  std::cout << workspace_summary(plan, table);
  write_workspace_report(plan, table, arguments.output);
  std::cout << arguments.output << "/workspace.html\n";
  if (interrupted()) std::cerr << "workspace: stopped; the same command goes on from here\n";
  return table.all_good() ? kGood : kNotGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app("Finds where a robot rests over all its commands, without a ROS master.", "workspace");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return show_workspace(arguments); });
}
