// SPDX-License-Identifier: BSD-3-Clause
// chart_stability: every method in every hard case, drawn as a grid.
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "settings/command_line.h"
#include "progress_bar.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "study/charts/stability.h"
#include "soft_robot_lab/settings/config_folder.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  bool quick = false;
  std::string output = "charts", body, method, hard_case;
};

void declare(CommandLine& app, Arguments& arguments) {
  app.add_flag("--quick", arguments.quick,
               "coarse bodies, fewer cases, our solver alone, and files named stability_quick");
  app.add_option(
         "--output", arguments.output,
         "a folder for stability.svg, .png and .csv (the places of the squares) and stability_cells.csv (a line "
         "for each cell); cells that stand in that table already are not run again")
      .type_name("FOLDER")
      .show_default();
  app.add_option("--body", arguments.body, "only bodies whose name holds this");
  app.add_option("--method", arguments.method, "only methods whose name holds this");
  app.add_option("--case", arguments.hard_case, "only cases whose name holds this");
  app.footer(
      "Exit status: 0 the default solver survived or recovered everywhere and all was finite, 1 not so, 2 bad\n"
      "arguments, or the chart could not be made.");
}

template <class Item>
std::vector<Item> choose(const std::vector<Item>& all, const std::string& text) {
  std::vector<Item> chosen;
  for (const Item& item : all)
    if (item.name.find(text) != std::string::npos) chosen.push_back(item);
  if (chosen.empty()) throw std::invalid_argument("nothing is named like '" + text + "'");
  return chosen;
}

// A long chart that was stopped goes on where it was.
std::vector<StabilityCell> known_cells(const std::string& table) {
  std::ifstream file(table);
  if (!file) return {};
  try {
    return read_stability_csv(file);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(table + ": " + error.what());
  }
}

template <class Item>
std::size_t place_of(const std::string& name, const std::vector<Item>& all) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Item& item) { return item.name == name; });
  return static_cast<std::size_t>(found - all.begin());
}

// As in the lists, whatever order they were run in.
void sort_cells(bool quick, std::vector<StabilityCell>& cells) {
  const auto bodies = stability_bodies(quick);
  const auto methods = stability_methods(quick);
  const auto cases = hard_cases(quick);
  const auto place = [&](const StabilityCell& cell) {
    return std::array<std::size_t, 3>{place_of(cell.body, bodies), place_of(cell.method, methods),
                                      place_of(cell.hard_case, cases)};
  };
  std::stable_sort(cells.begin(), cells.end(),
                   [&](const StabilityCell& a, const StabilityCell& b) { return place(a) < place(b); });
}

std::vector<StabilityCell> run(const Arguments& arguments, const std::string& table) {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  StabilityBench bench(options, config_folder());
  const auto bodies = choose(stability_bodies(arguments.quick), arguments.body);
  const auto methods = choose(stability_methods(arguments.quick), arguments.method);
  const auto cases = choose(hard_cases(arguments.quick), arguments.hard_case);
  const double count = static_cast<double>(bodies.size() * methods.size() * cases.size());
  std::vector<StabilityCell> cells = known_cells(table);
  ProgressBar bar("chart_stability");
  double done = 0.0;
  for (const StabilityBody& body : bodies) {
    for (const StabilityMethod& method : methods) {
      for (const HardCase& hard_case : cases) {
        bar.show(done++ / count, body.name + ", " + method.name + ", " + hard_case.name);
        const bool known = std::any_of(cells.begin(), cells.end(), [&](const StabilityCell& cell) {
          return cell.body == body.name && cell.method == method.name && cell.hard_case == hard_case.name;
        });
        if (known || !fits(body, method, hard_case)) continue;
        cells.push_back(bench.run(body, method, hard_case));
        write_file(table, stability_csv(cells));
      }
    }
  }
  return cells;
}

int chart(const Arguments& arguments) {
  const std::string name = arguments.quick ? "stability_quick" : "stability";
  std::filesystem::create_directories(arguments.output);
  std::vector<StabilityCell> cells =
      run(arguments, (std::filesystem::path(arguments.output) / (name + "_cells.csv")).string());
  sort_cells(arguments.quick, cells);
  int good = 0, bad = 0;
  for (const StabilityCell& cell : cells) {
    if (is_good(cell.outcome)) ++good;
    if (cell.outcome != Outcome::not_finite && (!cell.ours || is_good(cell.outcome))) continue;
    ++bad;
    std::cout << cell.body << ", " << cell.method << ", " << cell.hard_case << ": " << name_of(cell.outcome) << ": "
              << cell.message << "\n";
  }
  Plot plot = stability_plot(cells);
  plot.name = name;
  const PlotFiles files = write_plot(plot, arguments.output);
  std::cout << good << " of " << cells.size() << " cells survived or recovered; " << files.png << "\n";
  return bad == 0 ? kGood : kNotGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app("Runs every method in every hard case, and draws a grid of how they ended.", "chart_stability");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return chart(arguments); });
}
