// SPDX-License-Identifier: BSD-3-Clause
#include "study_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include "session/report/html_page.h"
#include "session/report/plot.h"
#include "settings/words.h"
#include "settings/write_file.h"
#include "sobol_indices.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t kMostShown = 4, kMostPlots = 16, kMostFailures = 20;

struct Spread {
  std::size_t count = 0;
  double least = 0.0, mean = 0.0, largest = 0.0;
};

Spread spread_of(const std::vector<double>& all) {
  std::vector<double> values;
  std::copy_if(all.begin(), all.end(), std::back_inserter(values), [](double value) { return std::isfinite(value); });
  if (values.empty()) return {};
  const auto [least, largest] = std::minmax_element(values.begin(), values.end());
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  return {values.size(), *least, sum / static_cast<double>(values.size()), *largest};
}

Table failures(const ResultsTable& table) {
  Table all{{{"task"}}, {}};
  for (const std::string& name : table.parameters) all.columns.push_back({name});
  all.columns.push_back({"state"});
  all.columns.push_back({"reason"});
  for (std::size_t row = 0; row < table.tasks.size() && all.rows.size() < kMostFailures; ++row) {
    if (table.states[row] == "good" || table.states[row].empty()) continue;
    std::vector<TableCell> cells = {static_cast<double>(row + 1)};
    for (const double value : table.tasks[row].values) cells.emplace_back(value);
    cells.emplace_back(table.states[row]);
    cells.emplace_back(table.reasons[row]);
    all.rows.push_back(std::move(cells));
  }
  return all;
}

Table spreads(const std::vector<std::size_t>& shown, const ResultsTable& table) {
  Table all{{{"result"}, {"tasks"}, {"least"}, {"mean"}, {"largest"}}, {}};
  for (const std::size_t result : shown) {
    const Spread spread = spread_of(table.numbers(result));
    all.rows.push_back(
        {table.results[result], static_cast<double>(spread.count), spread.least, spread.mean, spread.largest});
  }
  return all;
}

std::string count_text(const ResultsTable& table) {
  const auto count = [&](const char* state) { return std::count(table.states.begin(), table.states.end(), state); };
  std::ostringstream text;
  text << table.tasks.size() << " tasks: " << count("good") << " good, " << count("not_good") << " not good, "
       << count("failed") << " failed, " << count("") << " not run";
  return text.str();
}

Plot plot_of(const StudySettings& study, const ResultsTable& table, std::size_t result, std::size_t parameter) {
  Plot plot;
  plot.name = "plot_" + std::to_string(result) + "_" + std::to_string(parameter);
  plot.title = table.results[result] + " over " + table.parameters[parameter];
  plot.x = {table.parameters[parameter], study.parameters[parameter].logarithmic};
  plot.y = {table.results[result]};
  Series points{"", {}, {}, SeriesStyle::points};
  const std::vector<double> values = table.numbers(result);
  for (std::size_t row = 0; row < values.size(); ++row) {
    if (!std::isfinite(values[row])) continue;
    points.x.push_back(table.tasks[row].values[parameter]);
    points.y.push_back(values[row]);
  }
  plot.series.push_back(std::move(points));
  return plot;
}

void write_indices(const StudySettings& study, const ResultsTable& table, const std::vector<std::size_t>& shown,
                   HtmlPage& page) {
  if (study.method != SamplingMethod::sobol_indices) return;
  page.heading("What matters");
  page.paragraph(
      "Fraction of a result's variance that a parameter causes alone, and together with others (Sobol indices), each "
      "with its 95 % interval. Base points with a task without this result are left out.");
  page.table(sobol_table(table, shown));
}

void print(const Table& table, std::ostream& out) {
  for (const auto& row : table.rows) {
    out << " ";
    for (std::size_t i = 0; i < row.size(); ++i)
      std::visit(
          [&](const auto& cell) {
            out << " " << table.columns[i].name << " " << cell << (i + 1 < row.size() ? "," : "");
          },
          row[i]);
    out << "\n";
  }
}

}  // namespace

std::vector<std::size_t> shown_results(const StudySettings& study, const ResultsTable& table) {
  std::vector<std::size_t> shown;
  for (const std::string& name : study.show) {
    const auto found = std::find(table.results.begin(), table.results.end(), name);
    if (found == table.results.end() && !table.results.empty())
      throw std::invalid_argument("show: no task has the result '" + name + "'; there are " + join(table.results));
    if (found != table.results.end()) shown.push_back(static_cast<std::size_t>(found - table.results.begin()));
  }
  if (!study.show.empty()) return shown;
  for (std::size_t i = 0; i < table.results.size() && shown.size() < kMostShown; ++i) {
    const Spread spread = spread_of(table.numbers(i));
    if (spread.count > 0 && spread.largest > spread.least) shown.push_back(i);
  }
  return shown;
}

std::string study_summary(const StudySettings& study, const ResultsTable& table) {
  std::ostringstream text;
  text << count_text(table) << "\n" << std::setprecision(6);
  const std::vector<std::size_t> shown = shown_results(study, table);
  print(spreads(shown, table), text);
  if (study.method == SamplingMethod::sobol_indices) print(sobol_table(table, shown), text);
  print(failures(table), text);
  return text.str();
}

void write_study_report(const StudySettings& study, const ResultsTable& table, const std::string& folder) {
  HtmlPage page("Study of " + std::filesystem::path(study.scene).filename().string());
  page.paragraph(count_text(table), study.program + ":");
  const std::vector<std::size_t> shown = shown_results(study, table);
  page.heading("Results");
  page.table(spreads(shown, table));
  write_indices(study, table, shown, page);
  std::size_t plots = 0;
  for (const std::size_t result : shown)
    for (std::size_t parameter = 0; parameter < table.parameters.size(); ++parameter) {
      if (spread_of(table.numbers(result)).count == 0 || ++plots > kMostPlots) continue;
      page.pictures({write_plot(plot_of(study, table, result, parameter), folder).svg});
    }
  if (const Table failed = failures(table); !failed.rows.empty()) {
    page.heading("Not good");
    page.table(failed);
  }
  write_file(folder + "/report.html", page.html());
}

}  // namespace soft_robot_lab
