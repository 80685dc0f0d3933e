#include <algorithm>
#include <array>

#include "soft_robot_lab/experiment/stability.h"

namespace soft_robot_lab {
namespace {

constexpr std::array<int, kOutcomes> kColours = {2, 5, 4, 1, 6};  // green, light blue, orange, red, black

double place_of(const std::string& name, std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<double>(found - names.begin());
  names.push_back(name);
  return static_cast<double>(names.size() - 1);
}

Axis axis_of(const std::vector<std::string>& names) {
  Axis axis;
  for (std::size_t i = 0; i < names.size(); ++i) axis.ticks.emplace_back(static_cast<double>(i), names[i]);
  axis.min = -0.6;
  axis.max = static_cast<double>(names.size()) - 0.4;
  return axis;
}

}  // namespace

Plot stability_plot(const std::vector<StabilityCell>& cells) {
  Plot plot;
  plot.name = "stability";
  plot.title = "Hard cases: what survives, recovers, fails";
  std::array<Series, kOutcomes> of_outcome;
  std::vector<std::string> cases, rows;
  for (const StabilityCell& cell : cells) {
    Series& series = of_outcome[static_cast<std::size_t>(cell.outcome)];
    series.x.push_back(place_of(cell.hard_case, cases));
    series.y.push_back(place_of(cell.body + ": " + cell.method, rows));
  }
  for (int i = 0; i < kOutcomes; ++i) {
    Series& series = of_outcome[static_cast<std::size_t>(i)];
    series.label = name_of(static_cast<Outcome>(i));
    series.style = SeriesStyle::squares;
    series.colour = kColours[static_cast<std::size_t>(i)];
    if (!series.x.empty()) plot.series.push_back(series);
  }
  plot.x = axis_of(cases);
  plot.y = axis_of(rows);
  plot.width_px = 360 + 36 * static_cast<int>(cases.size());
  plot.height_px = 260 + 26 * static_cast<int>(rows.size());
  return plot;
}

}  // namespace soft_robot_lab
