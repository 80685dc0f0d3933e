// SPDX-License-Identifier: BSD-3-Clause
// experiment NAME: repeats an experiment, prints its table and draws its pictures, without a ROS master.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "settings/command_line.h"
#include "progress_bar.h"
#include "study/experiment.h"
#include "study/report.h"
#include "study/rig/rig_experiments.h"
#include "soft_robot_lab/settings/config_folder.h"

namespace {

using namespace soft_robot_lab;

// Every part's experiments, in the order of a report.
std::vector<Experiment> all_experiments() {
  std::vector<Experiment> all;
  for (const auto& list : {simulation_experiments, rig_experiments}) {
    for (Experiment& experiment : list()) all.push_back(std::move(experiment));
  }
  std::set<std::string> names = {"all"};
  for (const Experiment& experiment : all) {
    if (!names.insert(experiment.name).second)
      throw std::logic_error("two experiments are named '" + experiment.name + "'");
  }
  return all;
}

struct Arguments {
  std::vector<std::string> names;
  std::string result;
  std::string output = "experiments";
  bool list = false;
};

void declare(CommandLine& app, Arguments& arguments) {
  app.add_option("NAME", arguments.names, "experiments, or `all`").type_name("");
  app.add_flag("--list", arguments.list, "name all experiments, and run none");
  app.add_option("--result", arguments.result, "where the numbers go as JSON").type_name("FILE");
  app.add_option("--output", arguments.output, "a folder for pictures (SVG, PNG, CSV) and report.html")
      .type_name("FOLDER")
      .show_default();
  app.footer(
      "Exit status: 0 all solves converged, 1 ran but some did not, 2 bad arguments, or an experiment could not run.");
}

std::vector<Experiment> choose(const std::vector<Experiment>& all, const std::vector<std::string>& names) {
  std::vector<Experiment> chosen;
  for (const std::string& name : names) {
    if (name == "all") return all;
    std::string known = "all";
    const std::size_t before = chosen.size();
    for (const Experiment& experiment : all) {
      if (experiment.name == name) chosen.push_back(experiment);
      known += ", " + experiment.name;
    }
    if (chosen.size() == before) throw std::invalid_argument("unknown experiment '" + name + "'; known: " + known);
  }
  return chosen;
}

ExperimentReport run(const Experiment& experiment, const std::string& output_folder) {
  ExperimentReport report;
  report.name = experiment.name;
  {
    ProgressBar bar(experiment.name);
    ExperimentContext context;
    context.config_folder = config_folder();
    context.output_folder = output_folder;
    context.progress = [&](double fraction, const std::string& what) { bar.show(fraction, what); };
    report.result = experiment.run(context);
    for (const Plot& plot : report.result.plots) {
      bar.show(1.0, "drawing");
      report.pictures.push_back(write_plot(plot, output_folder));
    }
  }
  print_report(report, std::cout);
  return report;
}

// One experiment that cannot run does not take the others with it.
int run_all(const std::vector<Experiment>& chosen, const Arguments& arguments) {
  std::filesystem::create_directories(arguments.output);
  int status = kGood;
  std::vector<ExperimentReport> reports;
  for (const Experiment& experiment : chosen) {
    try {
      reports.push_back(run(experiment, arguments.output));
      if (!reports.back().result.converged) status = std::max<int>(status, kNotGood);
    } catch (const std::exception& error) {
      std::cerr << "experiment: " << experiment.name << ": " << error.what() << "\n";
      status = kFailed;
    }
  }
  if (reports.empty()) return status;
  if (!arguments.result.empty()) write_file(arguments.result, experiments_json(reports));
  const std::string page = (std::filesystem::path(arguments.output) / "report.html").string();
  write_file(page, experiments_html(reports));
  std::cout << page << "\n";
  return status;
}

int experiment(const Arguments& arguments) {
  const std::vector<Experiment> all = all_experiments();
  if (arguments.list) {
    for (const Experiment& one : all) std::cout << one.name << ": " << one.summary << "\n";
    return kGood;
  }
  if (arguments.names.empty()) throw std::invalid_argument("no experiment named; --list names all");
  return run_all(choose(all, arguments.names), arguments);
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app("Runs experiments, prints their tables, and draws their pictures, without a ROS master.",
                  "experiment");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return experiment(arguments); });
}
