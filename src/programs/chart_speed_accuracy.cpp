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

namespace {

using namespace soft_robot_lab;

constexpr const char* kUsage =
    "usage: chart_speed_accuracy [--quick] [--problem NAME]... [--poissons-ratio NUMBER]...\n"
    "                            [--reuse FILE]... [--reuse-bullet-only] [--output FOLDER]\n"
    "Runs the ladder of config/experiments/speed_accuracy.yaml and Bullet's deformable solver, and writes pictures\n"
    "(SVG, PNG, CSV), speed_accuracy.json and report.html to FOLDER, by default charts/ where it is started. Takes\n"
    "some 10 minutes of CPU time. --problem (cantilever, cook, cable_bar) and --poissons-ratio choose a part; --quick\n"
    "runs the coarsest rungs of the first. --reuse takes what an earlier chart measured from its runs.json, so that a\n"
    "chart can be measured in parts and drawn again; with --reuse-bullet-only our own runs are measured again.\n"
    "Set OPENBLAS_NUM_THREADS=1 and OMP_NUM_THREADS=1 to measure one core.\n"
    "Exit status: 0 all solves converged, 1 ran but some did not, 2 bad arguments, or it could not run.\n";

struct Arguments {
  SpeedAccuracyOptions options;
  std::string output = "charts";
  bool help = false;
};

Arguments parse(int count, char** values) {
  Arguments arguments;
  for (Words words(count, values); words.next();) {
    const std::string word = words.word();
    if (word == "-h" || word == "--help") {
      arguments.help = true;
    } else if (word == "--quick") {
      arguments.options.quick = true;
    } else if (word == "--reuse-bullet-only") {
      arguments.options.reuse_bullet_only = true;
    } else if (word == "--output") {
      arguments.output = words.value();
    } else if (word == "--problem") {
      arguments.options.problems.push_back(words.value());
    } else if (word == "--poissons-ratio") {
      arguments.options.poissons_ratios.push_back(words.value());
    } else if (word == "--reuse") {
      arguments.options.reuse.push_back(words.value());
    } else {
      throw std::invalid_argument("unknown argument " + word);
    }
  }
  return arguments;
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

int main(int argc, char** argv) { return run_program("chart_speed_accuracy", kUsage, argc, argv, parse, chart); }
