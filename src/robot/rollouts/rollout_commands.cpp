// SPDX-License-Identifier: BSD-3-Clause
#include "rollout_commands.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <sstream>
#include <stdexcept>

#include "settings/require.h"
#include "npz.h"
#include "robot/scene/reduction.h"
#include "settings/csv_cells.h"
#include "settings/limits.h"
#include "settings/read_file.h"
#include "settings/unit_limits.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

constexpr std::uintmax_t kLargestCommands_bytes = limits::kCommands_bytes;
using limits::kRollouts;

[[noreturn]] void fail(const std::string& where, const std::string& why) {
  throw std::invalid_argument(where + ": " + printable(why));
}

// Before memory is asked for: a number of a file takes many times as much here.
void require_count(const std::string& where, double rollouts, double commands_each) {
  if (!(rollouts >= 1 && rollouts <= static_cast<double>(kRollouts)))
    fail(where, format_number(rollouts) + " rollouts are not in [1, 1000000]");
  if (!(commands_each >= 1)) fail(where, "its rollouts hold no commands");
  if (rollouts * commands_each > static_cast<double>(limits::kRolloutCommands))
    fail(where, format_number(rollouts * commands_each) + " commands in all rollouts are more than " +
                    format_number(static_cast<double>(limits::kRolloutCommands)));
}

// A table, read line by line.
class CommandTable {
 public:
  CommandTable(const std::string& file, const std::string& header, const Model& model)
      : file_(file), columns_(csv_cells(header)), model_(model) {
    for (const char part : {';', '\t'})
      if (columns_.size() == 1 && header.find(part) != std::string::npos)
        fail(file + ":1", "its cells are parted by " + std::string(part == ';' ? "';'" : "tabs") +
                              ", must be by ',', with a point in decimal numbers");
    if (header.rfind("\xff\xfe", 0) == 0 || header.rfind("\xfe\xff", 0) == 0)
      fail(file + ":1", "is text in UTF-16; save it as CSV in UTF-8");
    for (const char* needed : {"rollout", "time_s"})
      if (std::count(columns_.begin(), columns_.end(), needed) == 0)
        fail(file + ":1", "has no column '" + std::string(needed) + "'");
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (std::count(columns_.begin(), columns_.begin() + static_cast<std::ptrdiff_t>(i), columns_[i]) > 0)
        fail(file + ":1", "has the column '" + columns_[i] + "' twice");
      if (columns_[i] != "rollout" && columns_[i] != "time_s") require_known(file + ":1", columns_[i]);
    }
  }

  void add(const std::string& line, std::size_t number, std::vector<RolloutCommands>& all) const {
    const std::string where = file_ + ":" + std::to_string(number);
    const std::vector<std::string> cells = csv_cells(line);
    if (cells.size() != columns_.size())
      fail(where, std::to_string(cells.size()) + " cells, must be " + std::to_string(columns_.size()));
    double rollout = 0.0;
    TimedCommands timed;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i].empty() && i > 0) continue;
      const double value = number_in(where, columns_[i], cells[i]);
      if (columns_[i] == "rollout") {
        rollout = value;
      } else if (columns_[i] == "time_s") {
        timed.time_s = value;
      } else {
        timed.commands.emplace_back(columns_[i], value);
      }
    }
    RolloutCommands& commands = place(where, rollout, all);
    const double before_s = commands.empty() ? 0.0 : commands.back().time_s;
    if (!(timed.time_s >= before_s))
      fail(where, "time_s: " + format_number(timed.time_s) + " comes after " + format_number(before_s) +
                      " of the same rollout; rows stand in the order of time, from 0 on");
    commands.push_back(std::move(timed));
  }

 private:
  void require_known(const std::string& where, const std::string& actuator) const {
    try {
      model_.actuator_index(actuator);
    } catch (const std::invalid_argument& error) {
      fail(where, error.what());
    }
  }

  double number_in(const std::string& where, const std::string& column, const std::string& cell) const {
    const std::optional<double> value = parse_number<double>(cell);
    if (!value || !std::isfinite(*value)) fail(where, column + ": '" + cell + "' is not a finite number");
    if (column == "rollout") return *value;
    try {
      if (column == "time_s") {
        require_in_unit(column, *value);
      } else {
        model_.actuators()[static_cast<std::size_t>(model_.actuator_index(column))]->require_in_limits(*value);
      }
    } catch (const std::invalid_argument& error) {
      fail(where, error.what());
    }
    return *value;
  }

  static RolloutCommands& place(const std::string& where, double rollout, std::vector<RolloutCommands>& all) {
    const auto last = static_cast<double>(all.size()) - 1.0;
    if (!(rollout == last || rollout == last + 1.0) || rollout < 0.0)
      fail(where, "rollout " + format_number(rollout) + " comes after " + format_number(last) +
                      "; they are counted from 0, in order");
    if (all.size() >= kRollouts) fail(where, "more than 1000000 rollouts");
    if (rollout > last) all.emplace_back();
    return all.back();
  }

  const std::string file_;
  const std::vector<std::string> columns_;
  const Model& model_;
};

std::vector<RolloutCommands> from_table(const std::string& file, const Model& model) {
  std::istringstream lines(read_regular_file(file, kLargestCommands_bytes));
  std::string line;
  if (!std::getline(lines, line)) fail(file, "is empty; its first line names the columns");
  const CommandTable table(file, line, model);
  std::vector<RolloutCommands> all;
  std::size_t commands = 0;
  for (std::size_t number = 2; std::getline(lines, line); ++number)
    if (line.find_first_not_of(" \r") != std::string::npos) {
      table.add(line, number, all);
      commands += all.back().back().commands.size() + 1;
      require_count(file, static_cast<double>(all.size()),
                    static_cast<double>(commands) / static_cast<double>(all.size()));
    }
  require_count(file, static_cast<double>(all.size()), 1);
  return all;
}

// Adds the column of one actuator.
void add_array(const NpzArray& array, double hold_s, std::vector<RolloutCommands>& all) {
  if (array.shape.size() != 2) fail(array.name, "must have two dimensions, rollouts x holds");
  const std::size_t rollouts = array.shape[0], holds = array.shape[1];
  require_count(array.name, static_cast<double>(rollouts), 2 * static_cast<double>(holds));
  if (all.empty()) all.assign(rollouts, RolloutCommands(holds));
  if (all.size() != rollouts || all.front().size() != holds)
    fail(array.name, "is " + std::to_string(rollouts) + " x " + std::to_string(holds) + ", another array is " +
                         std::to_string(all.size()) + " x " + std::to_string(all.front().size()));
  const std::vector<double> numbers = numbers_of(array);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    TimedCommands& timed = all[i / holds][i % holds];
    timed.time_s = hold_s * static_cast<double>(i % holds);
    timed.commands.emplace_back(array.name, numbers[i]);
  }
}

std::vector<RolloutCommands> from_arrays(const std::string& file, double hold_s, const Model& model) {
  require(hold_s > 0.0 && hold_s <= limits::kTime_s, "hold_s", hold_s, "(0, 1e6]");
  std::vector<RolloutCommands> all;
  try {
    for (const NpzArray& array : read_npz(read_regular_file(file, kLargestCommands_bytes))) {
      const auto& actuator = *model.actuators()[static_cast<std::size_t>(model.actuator_index(array.name))];
      for (const double value : numbers_of(array)) actuator.require_in_limits(value);
      add_array(array, hold_s, all);
    }
    require_count("archive", static_cast<double>(all.size()), 1);
  } catch (const std::invalid_argument& error) {
    fail(file, error.what());
  }
  return all;
}

bool ends_with(const std::string& file, const std::string& ending) {
  return file.size() >= ending.size() && file.compare(file.size() - ending.size(), ending.size(), ending) == 0;
}

}  // namespace

void require_commands_ending(const std::string& file) {
  if (!ends_with(file, ".csv") && !ends_with(file, ".npz")) fail(file, "must end in .csv or .npz");
}

CommandBox command_box(const Scene& scene) {
  if (scene.reduction) return scene.reduction->choice.model->box;
  CommandBox box;
  for (const auto& actuator : scene.simulation->actuators()) {
    box.min.push_back(actuator->limits().min);
    box.max.push_back(actuator->limits().max);
  }
  return box;
}

std::vector<RolloutCommands> random_commands(const RandomCommands& random, const Model& model) {
  require(random.rollouts > 0 && random.rollouts <= static_cast<int>(kRollouts), "rollouts", random.rollouts,
          "[1, 1000000]");
  require(random.hold_s > 0.0 && random.hold_s <= limits::kTime_s, "hold_s", random.hold_s, "(0, 1e6]");
  require(random.duration_s > 0.0 && random.duration_s <= limits::kTime_s, "duration_s", random.duration_s, "(0, 1e6]");
  require_count("random commands", random.rollouts,
                (1 + static_cast<double>(random.box.min.size())) * std::ceil(random.duration_s / random.hold_s));
  for (std::size_t a = 0; a < random.box.min.size(); ++a)
    if (!std::isfinite(random.box.min[a]) || !std::isfinite(random.box.max[a]))
      fail(model.actuators()[a]->name(), "has no limits to draw commands within; give it a range");
  std::vector<RolloutCommands> all(static_cast<std::size_t>(random.rollouts));
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::seed_seq seeds{random.seed, static_cast<unsigned>(i)};
    std::mt19937 generator(seeds);
    for (int k = 0; k * random.hold_s < random.duration_s; ++k) {
      TimedCommands& timed = all[i].emplace_back();
      timed.time_s = k * random.hold_s;
      for (std::size_t a = 0; a < random.box.min.size(); ++a)
        timed.commands.emplace_back(
            model.actuators()[a]->name(),
            random.box.min[a] + (random.box.max[a] - random.box.min[a]) * (generator() / 4294967296.0));
    }
  }
  return all;
}

std::vector<RolloutCommands> read_commands_file(const std::string& file, double hold_s, const Model& model) {
  require_commands_ending(file);
  return ends_with(file, ".csv") ? from_table(file, model) : from_arrays(file, hold_s, model);
}

}  // namespace soft_robot_lab
