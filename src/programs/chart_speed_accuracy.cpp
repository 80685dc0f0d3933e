// SPDX-License-Identifier: BSD-3-Clause
// chart_speed_accuracy: draws error against CPU time of our methods and of Bullet's, without a ROS master.
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>

#include "settings/command_line.h"
#include "progress_bar.h"
#include "study/report.h"
#include "study/charts/speed_accuracy.h"
#include "soft_robot_lab/settings/config_folder.h"
#include "settings/find_program.h"
#include "settings/words.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  SpeedAccuracyOptions options;
  std::string output = "charts";
};

void declare(CommandLine& app, Arguments& arguments) {
  SpeedAccuracyOptions& options = arguments.options;
  app.add_flag("--quick", options.quick, "the coarsest rungs of the first problem");
  app.add_option("--part", options.parts, "one of " + join(speed_parts()) + "; can be repeated")
      .one_value_at_a_time()
      .type_name("NAME");
  app.add_option("--problem", options.problems, "cantilever, cook or cable_bar; can be repeated")
      .one_value_at_a_time()
      .type_name("NAME");
  app.add_option("--poissons-ratio", options.poissons_ratios, "one of a problem's; can be repeated")
      .one_value_at_a_time()
      .type_name("NUMBER");
  app.add_option("--reuse", options.reuse,
                 "runs.json of an earlier chart, whose measurements are taken over, so that a chart can be measured in "
                 "parts and drawn again; can be repeated")
      .one_value_at_a_time()
      .type_name("FILE");
  app.add_flag("--reuse-bullet-only", options.reuse_bullet_only, "measure our own runs again all the same");
  app.add_option("--output", arguments.output, "a folder for pictures (SVG, PNG, CSV), JSON and report.html")
      .type_name("FOLDER")
      .show_default();
  app.footer(
      "Takes some 20 minutes of CPU time. Set OPENBLAS_NUM_THREADS=1 and OMP_NUM_THREADS=1 to measure one core.\n"
      "Exit status: 0 all solves converged, 1 ran but some did not, 2 bad arguments, or it could not run.");
}

int chart(const Arguments& arguments) {
  std::filesystem::create_directories(arguments.output);
  SpeedAccuracyOptions options = arguments.options;
  options.bullet_program = find_program("bullet_peer");
  if (options.bullet_program.empty()) std::cerr << "chart_speed_accuracy: built without Bullet, so drawn without it\n";
  ExperimentReport report;
  report.name = "speed_accuracy";
  {
    ProgressBar bar("chart_speed_accuracy");
    ExperimentContext context;
    context.config_folder = config_folder();
    context.output_folder = arguments.output;
    context.progress = [&](double fraction, const std::string& what) { bar.show(fraction, what); };
    report.result = run_speed_accuracy(context, options);
    for (const Plot& plot : report.result.plots) report.pictures.push_back(write_plot(plot, arguments.output));
  }
  print_report(report, std::cout);
  const std::filesystem::path folder(arguments.output);
  write_file(folder / "speed_accuracy.json", experiments_json({report}));
  write_file(folder / "report.html", experiments_html({report}));
  std::cout << (folder / "report.html").string() << "\n";
  return report.result.converged ? kGood : kNotGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Runs the ladder of config/experiments/speed_accuracy.yaml and Bullet's deformable solver, and draws error\n"
      "against CPU time.",
      "chart_speed_accuracy");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return chart(arguments); });
}
