// SPDX-License-Identifier: BSD-3-Clause
#include "robust_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <sstream>

#include "session/report/html_page.h"
#include "session/report/plot.h"
#include "settings/quantile.h"
#include "settings/words.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

constexpr int kBins = 20;

std::vector<double> at_rest(const std::vector<double>& distances_m) {
  std::vector<double> all;
  std::copy_if(distances_m.begin(), distances_m.end(), std::back_inserter(all),
               [](double distance) { return std::isfinite(distance); });
  return all;
}

Table quantiles(const std::vector<double>& distances_m) {
  const std::vector<double> all = at_rest(distances_m);
  Table table{{{"of the distances"}, {"mm", 4}}, {}};
  if (all.empty()) return table;
  const double mean = std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
  table.rows.push_back({"mean", 1e3 * mean});
  for (const double fraction : {0.1, 0.5, 0.9, 0.95})
    table.rows.push_back({format_number(100.0 * fraction) + " %", 1e3 * quantile(all, fraction)});
  table.rows.push_back({"largest", 1e3 * *std::max_element(all.begin(), all.end())});
  return table;
}

std::string robots_csv(const std::vector<std::string>& names, const std::vector<RandomRobot>& robots,
                       const std::vector<double>& distances_m) {
  std::string csv;
  for (const std::string& name : names) csv += "\"" + name + "\",";
  csv += "distance_m\n";
  for (std::size_t i = 0; i < robots.size(); ++i) {
    for (const double value : robots[i].values) csv += format_number(value) + ",";
    csv += (std::isfinite(distances_m[i]) ? format_number(distances_m[i]) : "") + "\n";
  }
  return csv;
}

Plot histogram_of(const std::vector<double>& distances_m) {
  std::vector<double> mm = at_rest(distances_m);
  for (double& distance : mm) distance *= 1e3;
  Plot plot{"distances", "Distances from the target", {"distance [mm]"}, {"robots"}};
  plot.series = {histogram("", mm, 0.0, 1.05 * *std::max_element(mm.begin(), mm.end()) + 1e-9, kBins)};
  return plot;
}

Plot plot_over(const std::string& name, std::size_t parameter, const std::vector<RandomRobot>& robots,
               const std::vector<double>& distances_m) {
  Plot plot{"over_" + std::to_string(parameter), "Distance over " + name, {name}, {"distance [mm]"}};
  Series points{"", {}, {}, SeriesStyle::points};
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (!std::isfinite(distances_m[i])) continue;
    points.x.push_back(robots[i].values[parameter]);
    points.y.push_back(1e3 * distances_m[i]);
  }
  plot.series = {points};
  return plot;
}

}  // namespace

std::string robust_summary(const std::vector<double>& distances_m) {
  std::ostringstream text;
  text.precision(4);
  const std::size_t resting = at_rest(distances_m).size();
  text << distances_m.size() << " random robots, " << distances_m.size() - resting << " without a rest state\n";
  for (const auto& row : quantiles(distances_m).rows)
    text << "  " << std::get<std::string>(row[0]) << ": " << std::get<double>(row[1]) << " mm\n";
  return text.str();
}

void write_robust_report(const Randomisation& randomisation, const std::vector<RandomRobot>& robots,
                         const std::vector<double>& distances_m, const std::string& folder) {
  std::filesystem::create_directories(folder);
  const std::vector<std::string> names = names_of(randomisation);
  write_file(folder + "/robots.csv", robots_csv(names, robots, distances_m));
  HtmlPage page("A policy on random robots");
  page.paragraph(std::to_string(robots.size()) + " robots, " +
                 std::to_string(robots.size() - at_rest(distances_m).size()) + " of them without a rest state.");
  page.table(quantiles(distances_m));
  if (!at_rest(distances_m).empty()) {
    page.pictures({write_plot(histogram_of(distances_m), folder).svg});
    for (std::size_t i = 0; i < names.size(); ++i)
      page.pictures({write_plot(plot_over(names[i], i, robots, distances_m), folder).svg});
  }
  write_file(folder + "/report.html", page.html());
}

}  // namespace soft_robot_lab
