// SPDX-License-Identifier: BSD-3-Clause
#include "workspace_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>

#include "geometry/convex_hull.h"
#include "session/report/html_page.h"
#include "session/report/plot.h"
#include "settings/words.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

constexpr double kThin = 0.02;  // of the largest extent: the tips lie in a plane
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
constexpr std::size_t kMostFailures = 20;

using Numbers = std::vector<double>;  // one a point; NaN where there is none

Numbers column(const ResultsTable& table, const std::string& name, double factor) {
  const auto found = std::find(table.results.begin(), table.results.end(), name);
  if (found == table.results.end()) return Numbers(table.tasks.size(), kNothing);
  Numbers values = table.numbers(static_cast<std::size_t>(found - table.results.begin()));
  for (double& value : values) value *= factor;
  return values;
}

// A number of each point, to colour it by.
struct Quantity {
  std::string label;  // with the unit
  Numbers values;
};

Numbers largest_of(const WorkspacePlan& plan, const ResultsTable& table, const std::string& reading, double factor) {
  Numbers largest(table.tasks.size(), kNothing);
  for (const StudyParameter& actuator : plan.study.parameters) {
    const Numbers values = column(table, "actuators." + actuator.name + "." + reading, factor);
    for (std::size_t i = 0; i < values.size(); ++i) largest[i] = std::fmax(largest[i], values[i]);
  }
  return largest;
}

bool is_finite(double value) { return std::isfinite(value); }

// What the robot's actuators have: cables a tension, chambers a pressure.
Quantity effort_of(const WorkspacePlan& plan, const ResultsTable& table) {
  const Numbers tensions = largest_of(plan, table, "tension_n", 1.0);
  if (std::any_of(tensions.begin(), tensions.end(), is_finite)) return {"largest tension [N]", tensions};
  return {"largest gauge pressure [kPa]", largest_of(plan, table, "gauge_pressure_pa", 1e-3)};
}

struct Tips {
  std::array<Numbers, 3> at_mm;
  Numbers snapped, folded;  // 1 or 0
};

Tips tips_of(const WorkspacePlan& plan, const ResultsTable& table) {
  Tips tips{{}, column(table, "snapped", 1.0), column(table, "folded", 1.0)};
  for (std::size_t axis = 0; axis < 3; ++axis)
    tips.at_mm[axis] = column(table, "markers." + plan.marker + ".position_m." + kAxes[axis], 1e3);
  return tips;
}

bool snaps(const Tips& tips, std::size_t point) { return tips.snapped[point] == 1.0 || tips.folded[point] == 1.0; }

struct Range {
  double least = 0.0, largest = 0.0;
};

Range range_of(Numbers values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !is_finite(v); }), values.end());
  if (values.empty()) return {};
  const auto [least, largest] = std::minmax_element(values.begin(), values.end());
  return {*least, *largest};
}

double extent(const Tips& tips, std::size_t axis) {
  const Range range = range_of(tips.at_mm[axis]);
  return range.largest - range.least;
}

// Pairs of axes that span a view: none that shows a plane of tips from its edge.
std::vector<std::pair<std::size_t, std::size_t>> views_of(const Tips& tips) {
  const double largest = std::max({extent(tips, 0), extent(tips, 1), extent(tips, 2)});
  std::vector<std::size_t> wide;
  for (const std::size_t axis : {0u, 1u, 2u})
    if (extent(tips, axis) > kThin * largest) wide.push_back(axis);
  if (wide.size() < 2) return {{0, 2}};
  if (wide.size() == 2) return {{wide[0], wide[1]}};
  return {{0, 2}, {1, 2}, {0, 1}};
}

Series places(const Numbers& x, const Numbers& y, const Numbers& values, SeriesStyle style) {
  Series series{"", {}, {}, style};
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!is_finite(x[i]) || !is_finite(y[i]) || !is_finite(values[i])) continue;
    series.x.push_back(x[i]);
    series.y.push_back(y[i]);
    series.values.push_back(values[i]);
  }
  return series;
}

// Crosses over the points at which the robot snaps.
void add_crosses(const Numbers& x, const Numbers& y, const Tips& tips, Plot& plot) {
  Series crosses{"snaps towards a neighbour", {}, {}, SeriesStyle::crosses, 1};
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!is_finite(x[i]) || !is_finite(y[i]) || !snaps(tips, i)) continue;
    crosses.x.push_back(x[i]);
    crosses.y.push_back(y[i]);
  }
  if (!crosses.x.empty()) plot.series.push_back(std::move(crosses));
}

// Around all tips, as it is seen.
Series hull_of(const Numbers& x, const Numbers& y) {
  std::vector<Eigen::Vector2d> seen;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (is_finite(x[i]) && is_finite(y[i])) seen.emplace_back(x[i], y[i]);
  std::vector<std::size_t> corners = convex_hull(seen);
  if (!corners.empty()) corners.push_back(corners.front());
  Series hull{"convex hull", {}, {}, SeriesStyle::lines, 0};
  for (const std::size_t i : corners) {
    hull.x.push_back(seen[i].x());
    hull.y.push_back(seen[i].y());
  }
  return hull;
}

Plot tip_plot(const WorkspacePlan& plan, const Tips& tips, const Quantity& quantity, std::size_t a, std::size_t b) {
  Plot plot;
  plot.name = std::string("workspace_") + kAxes[a] + kAxes[b];
  plot.title = "Where " + plan.marker + " rests";
  plot.x.label = std::string(kAxes[a]) + " [mm]";
  plot.y.label = std::string(kAxes[b]) + " [mm]";
  plot.equal_scale = true;
  plot.height_px = 760;
  plot.colour_bar = quantity.label;
  plot.series = {hull_of(tips.at_mm[a], tips.at_mm[b]),
                 places(tips.at_mm[a], tips.at_mm[b], quantity.values, SeriesStyle::points)};
  add_crosses(tips.at_mm[a], tips.at_mm[b], tips, plot);
  return plot;
}

Numbers commands_of(const WorkspacePlan& plan, Eigen::Index actuator) {
  const Eigen::VectorXd row = plan.commands.row(actuator).transpose();
  return {row.data(), row.data() + row.size()};
}

// Over the commands of two actuators.
Plot command_plot(const WorkspacePlan& plan, const Tips& tips, const Quantity& quantity, const std::string& name) {
  const auto& parameters = plan.study.parameters;
  Plot plot;
  plot.name = "workspace_" + name;
  plot.title = quantity.label;
  plot.x.label = "command of " + parameters[0].name;
  plot.y.label = "command of " + parameters[1].name;
  plot.height_px = 760;
  plot.colour_bar = quantity.label;
  const Numbers x = commands_of(plan, 0), y = commands_of(plan, 1);
  const bool grid = plan.study.method == SamplingMethod::grid;
  Numbers even(quantity.values), between(quantity.values);
  std::fill(even.begin() + std::ptrdiff_t(plan.even), even.end(), kNothing);
  std::fill(between.begin(), between.begin() + std::ptrdiff_t(plan.even), kNothing);
  plot.series = {places(x, y, even, grid ? SeriesStyle::squares : SeriesStyle::points)};
  const auto half_step = [](const StudyParameter& p) { return 0.5 * (p.max - p.min) / std::max(1, p.steps - 1); };
  plot.series[0].half_size = {half_step(parameters[0]), half_step(parameters[1])};
  if (plan.even < between.size()) plot.series.push_back(places(x, y, between, SeriesStyle::points));
  add_crosses(x, y, tips, plot);
  return plot;
}

std::string words(const Range& range) {
  std::ostringstream text;
  text.precision(4);
  text << range.least << " to " << range.largest;
  return text.str();
}

std::string count_text(const ResultsTable& table, const Tips& tips) {
  const auto count = [&](const char* state) { return std::count(table.states.begin(), table.states.end(), state); };
  const auto on_the_way = std::count(tips.snapped.begin(), tips.snapped.end(), 1.0);
  std::ptrdiff_t snapping = 0;
  for (std::size_t i = 0; i < tips.folded.size(); ++i) snapping += snaps(tips, i) ? 1 : 0;
  std::ostringstream text;
  text << table.tasks.size() << " commands: " << count("good") << " with a rest state, " << count("failed")
       << " without, " << count("") << " not asked yet; the robot snaps at " << snapping << ", at " << on_the_way
       << " of them on the way there";
  return text.str();
}

Table extents(const WorkspacePlan& plan, const ResultsTable& table, const Tips& tips) {
  Table rows{{{"of " + plan.marker}, {"least to largest"}}, {}};
  for (std::size_t axis = 0; axis < 3; ++axis)
    rows.rows.push_back({std::string(kAxes[axis]) + " [mm]", words(range_of(tips.at_mm[axis]))});
  for (const Quantity& quantity :
       {effort_of(plan, table), Quantity{"least singular value [mm]", column(table, "least_singular_value_m", 1e3)}})
    rows.rows.push_back({quantity.label, words(range_of(quantity.values))});
  return rows;
}

Table failures(const ResultsTable& table) {
  Table rows;
  for (const std::string& name : table.parameters) rows.columns.push_back({name});
  rows.columns.push_back({"why there is no rest state"});
  for (std::size_t row = 0; row < table.tasks.size() && rows.rows.size() < kMostFailures; ++row) {
    if (table.states[row] != "failed") continue;
    std::vector<TableCell> cells(table.tasks[row].values.begin(), table.tasks[row].values.end());
    cells.emplace_back(table.reasons[row]);
    rows.rows.push_back(std::move(cells));
  }
  return rows;
}

constexpr const char* kReading =
    "Each rest state was sought from that of a neighbour nearer to rest. Crosses mark commands where the body snaps: "
    "the way from the neighbour leads through an unstable shape, or the marker is elsewhere at a neighbour's commands "
    "than the derivatives lead to. Which shape the robot takes there may depend on the order of pulling. A body that "
    "buckles gradually has no cross; maps over the commands show it by an edge.";
constexpr const char* kSingular =
    "The least singular value is how far the marker moves at least where the commands change by their whole range in "
    "some direction, taken from the derivatives there. Near zero the marker cannot be moved along one direction.";

void add_pictures(const WorkspacePlan& plan, const ResultsTable& table, const Tips& tips, const std::string& folder,
                  HtmlPage& page) {
  const Quantity effort = effort_of(plan, table);
  page.heading("Places");
  for (const auto& [a, b] : views_of(tips)) page.pictures({write_plot(tip_plot(plan, tips, effort, a, b), folder).svg});
  page.paragraph(kReading);
  if (plan.study.parameters.size() != 2) return;
  page.heading("Commands");
  page.pictures({write_plot(command_plot(plan, tips, effort, "effort"), folder).svg});
  const Quantity singular{"least singular value [mm]", column(table, "least_singular_value_m", 1e3)};
  page.pictures({write_plot(command_plot(plan, tips, singular, "singular"), folder).svg});
  page.paragraph(kSingular);
}

}  // namespace

std::string workspace_summary(const WorkspacePlan& plan, const ResultsTable& table) {
  const Tips tips = tips_of(plan, table);
  std::ostringstream text;
  text << count_text(table, tips) << "\n";
  for (const auto& row : extents(plan, table, tips).rows)
    text << "  " << plan.marker << ": " << std::get<std::string>(row[0]) << " " << std::get<std::string>(row[1])
         << "\n";
  return text.str();
}

void write_workspace_report(const WorkspacePlan& plan, const ResultsTable& table, const std::string& folder) {
  const Tips tips = tips_of(plan, table);
  HtmlPage page("Workspace of " + std::filesystem::path(plan.study.scene).filename().string());
  page.paragraph(count_text(table, tips));
  page.table(extents(plan, table, tips));
  if (std::any_of(tips.at_mm[0].begin(), tips.at_mm[0].end(), is_finite)) add_pictures(plan, table, tips, folder, page);
  if (const Table failed = failures(table); !failed.rows.empty()) {
    page.heading("Without a rest state");
    page.table(failed);
  }
  write_file(folder + "/workspace.html", page.html());
}

}  // namespace soft_robot_lab
