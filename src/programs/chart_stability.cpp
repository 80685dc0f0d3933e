// chart_stability: every method in every hard case, drawn as a grid.
#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "programs/config_folder.h"
#include "programs/progress_bar.h"
#include "soft_robot_lab/actuators/factory.h"
#include "soft_robot_lab/experiment/stability.h"

namespace {

using namespace soft_robot_lab;

constexpr const char* kUsage =
    "usage: chart_stability [--quick] [--output FOLDER] [--body TEXT] [--method TEXT] [--case TEXT]\n"
    "Runs every method in every hard case, and writes stability.svg, .png and .csv (the places of the squares) and\n"
    "stability_cells.csv (a line for each cell) to FOLDER, by default charts/ where it is started. --quick: coarse\n"
    "bodies, and fewer cases. --body, --method, --case: only those whose name holds the text.\n"
    "Exit status: 0 the default solver survived or recovered everywhere and all was finite, 1 not so, 2 bad "
    "arguments,\n"
    "or the chart could not be made.\n";

enum ExitStatus { kGood = 0, kFailedCells = 1, kError = 2 };

struct Arguments {
  bool quick = false, help = false;
  std::string output = "charts", body, method, hard_case;
};

Arguments parse(int count, char** values) {
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string word = values[i];
    const auto value = [&] {
      if (++i == count) throw std::invalid_argument(word + " needs a value");
      return values[i];
    };
    if (word == "-h" || word == "--help") {
      arguments.help = true;
    } else if (word == "--quick") {
      arguments.quick = true;
    } else if (word == "--output") {
      arguments.output = value();
    } else if (word == "--body") {
      arguments.body = value();
    } else if (word == "--method") {
      arguments.method = value();
    } else if (word == "--case") {
      arguments.hard_case = value();
    } else {
      throw std::invalid_argument("unknown argument " + word);
    }
  }
  return arguments;
}

template <class Item>
std::vector<Item> choose(const std::vector<Item>& all, const std::string& text) {
  std::vector<Item> chosen;
  for (const Item& item : all)
    if (item.name.find(text) != std::string::npos) chosen.push_back(item);
  if (chosen.empty()) throw std::invalid_argument("nothing is named like '" + text + "'");
  return chosen;
}

std::vector<StabilityCell> run(const Arguments& arguments) {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  StabilityBench bench(options, config_folder());
  const auto bodies = choose(stability_bodies(arguments.quick), arguments.body);
  const auto methods = choose(stability_methods(), arguments.method);
  const auto cases = choose(hard_cases(arguments.quick), arguments.hard_case);
  const double count = static_cast<double>(bodies.size() * methods.size() * cases.size());
  std::vector<StabilityCell> cells;
  ProgressBar bar("chart_stability");
  double done = 0.0;
  for (const StabilityBody& body : bodies) {
    for (const StabilityMethod& method : methods) {
      for (const HardCase& hard_case : cases) {
        bar.show(done++ / count, body.name + ", " + method.name + ", " + hard_case.name);
        if (method.fits(body) && !hard_case.commands(body).empty()) cells.push_back(bench.run(body, method, hard_case));
      }
    }
  }
  return cells;
}

int chart(const Arguments& arguments) {
  std::filesystem::create_directories(arguments.output);
  const std::vector<StabilityCell> cells = run(arguments);
  const std::string table = (std::filesystem::path(arguments.output) / "stability_cells.csv").string();
  std::ofstream file(table);
  file << stability_csv(cells) << std::flush;
  if (!file) throw std::runtime_error(table + ": cannot be written: " + std::strerror(errno));
  int good = 0, bad = 0;
  for (const StabilityCell& cell : cells) {
    if (is_good(cell.outcome)) ++good;
    if (cell.outcome != Outcome::not_finite && (!cell.ours || is_good(cell.outcome))) continue;
    ++bad;
    std::cout << cell.body << ", " << cell.method << ", " << cell.hard_case << ": " << name_of(cell.outcome) << ": "
              << cell.message << "\n";
  }
  const PlotFiles files = write_plot(stability_plot(cells), arguments.output);
  std::cout << good << " of " << cells.size() << " cells survived or recovered; " << files.png << "\n";
  return bad == 0 ? kGood : kFailedCells;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  try {
    arguments = parse(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "chart_stability: " << error.what() << "\n" << kUsage;
    return kError;
  }
  if (arguments.help) {
    std::cout << kUsage;
    return kGood;
  }
  try {
    return chart(arguments);
  } catch (const std::exception& error) {
    std::cerr << "chart_stability: " << error.what() << "\n";
    return kError;
  }
}
