// SPDX-License-Identifier: BSD-3-Clause
// search_design SEARCH.yaml --output FOLDER: finds designs of a robot that can be cast and do better.
#include <iostream>
#include <string>
#include <thread>

#include "progress_bar.h"
#include "settings/command_line.h"
#include "settings/interrupted.h"
#include "settings/limits.h"
#include "study/search/design_report.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  std::string search, output;
  int workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
};

void declare(CommandLine& app, Arguments& arguments) {
  app.add_option("SEARCH", arguments.search, "the search's file").type_name("FILE").required();
  app.add_option("--output", arguments.output, "the folder of journal.sqlite, designs.csv, report.html and the designs")
      .type_name("FOLDER")
      .required();
  app.add_option("--workers", arguments.workers, "how many designs are tried at a time")
      .type_name("N")
      .range(1, limits::kThreads)
      .show_default();
  app.footer(
      "The same command goes on where it was stopped. Exit status: 0 a design was found, 1 none was, or it was "
      "stopped,\n"
      "2 bad search or arguments.");
}

int search(const Arguments& arguments) {
  const SearchSettings settings = read_search(arguments.search);
  Journal journal(arguments.output);
  heed_interrupts();
  ProgressBar bar("search_design");
  std::size_t shown = 0;
  DesignEvaluator evaluator(
      settings, journal, arguments.workers,
      [&](std::size_t done) {
        if (done != std::exchange(shown, done))
          bar.show(static_cast<double>(done) / settings.designs,
                   std::to_string(done) + " of " + std::to_string(settings.designs) + " designs");
        return !interrupted();
      },
      [](const std::string& what) { std::cerr << "search_design: warning: " << what << "\n"; });
  const bool ended = search_designs(settings, evaluator);
  std::cout << search_summary(settings, evaluator.designs());
  write_search_report(settings, evaluator.designs(), arguments.output);
  std::cout << arguments.output << "/report.html\n";
  if (!ended) std::cerr << "search_design: stopped; the same command goes on from here\n";
  return ended && !pareto_front(evaluator.designs()).empty() ? kGood : kNotGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app("Searches for better designs of a robot, only those that can be cast, without a ROS master.",
                  "search_design");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return search(arguments); });
}
