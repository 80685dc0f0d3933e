// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "stability.h"

namespace soft_robot_lab {
namespace {

// Green, light blue, orange, pink, red, black.
constexpr std::array<int, kOutcomes> kColours = {2, 5, 4, 3, 1, 6};

std::size_t place_of(const std::string& name, std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) names.push_back(name);
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

Axis axis_of(const std::vector<std::string>& names) {
  Axis axis;
  for (std::size_t i = 0; i < names.size(); ++i) axis.ticks.emplace_back(static_cast<double>(i), names[i]);
  axis.min = -0.6;
  axis.max = static_cast<double>(names.size()) - 0.4;
  return axis;
}

// Places of cells, in the order in which the cells name them; rows from the top.
struct Grid {
  std::vector<std::string> cases, rows, body_of_row;

  explicit Grid(const std::vector<StabilityCell>& cells) {
    for (const StabilityCell& cell : cells) {
      column(cell);
      if (place_of(row_name(cell), rows) == body_of_row.size()) body_of_row.push_back(cell.body);
    }
  }
  static std::string row_name(const StabilityCell& cell) { return cell.body + ": " + cell.method; }
  double column(const StabilityCell& cell) { return static_cast<double>(place_of(cell.hard_case, cases)); }
  double row(const StabilityCell& cell) {
    return static_cast<double>(rows.size() - 1 - place_of(row_name(cell), rows));
  }
  Axis y() const {
    Axis axis = axis_of({rows.rbegin(), rows.rend()});
    for (std::size_t i = 1; i < rows.size(); ++i)
      if (body_of_row[i] != body_of_row[i - 1]) axis.guides.push_back(static_cast<double>(rows.size() - i) - 0.5);
    return axis;
  }
};

}  // namespace

Plot stability_plot(const std::vector<StabilityCell>& cells) {
  Plot plot;
  plot.name = "stability";
  plot.title = "Hard cases: what survives, recovers, fails";
  Grid grid(cells);
  std::array<Series, kOutcomes> of_outcome;
  for (const StabilityCell& cell : cells) {
    Series& series = of_outcome[static_cast<std::size_t>(cell.outcome)];
    series.x.push_back(grid.column(cell));
    series.y.push_back(grid.row(cell));
  }
  for (int i = 0; i < kOutcomes; ++i) {
    Series& series = of_outcome[static_cast<std::size_t>(i)];
    series.label = name_of(static_cast<Outcome>(i));
    series.style = SeriesStyle::squares;
    series.colour = kColours[static_cast<std::size_t>(i)];
    if (!series.x.empty()) plot.series.push_back(series);
  }
  plot.x = axis_of(grid.cases);
  plot.y = grid.y();
  plot.width_px = 440 + 28 * static_cast<int>(grid.cases.size());
  plot.height_px = 340 + 24 * static_cast<int>(grid.rows.size());
  return plot;
}

}  // namespace soft_robot_lab
