// SPDX-License-Identifier: BSD-3-Clause
#include "design_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <sstream>

#include "robot/casting/cast_robot.h"
#include "robot/casting/mould_picture.h"
#include "robot/scene/parameters.h"
#include "session/report/html_page.h"
#include "session/report/plot.h"
#include "settings/words.h"
#include "settings/write_file.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostPictures = 12;

std::string name_of(std::size_t place) { return "design_" + std::to_string(place + 1); }

double value_of(const SearchSettings& search, const Design& design, std::size_t objective) {
  return search.objectives[objective].larger_is_better ? 0.0 - design.fitness[objective] : design.fitness[objective];
}

ParameterValues parameters_of(const SearchSettings& search, const Design& design) {
  ParameterValues values;
  for (std::size_t i = 0; i < search.parameters.size(); ++i)
    values.emplace_back(search.parameters[i].name, design.values[i]);
  return values;
}

Overrides overrides_of(const SearchSettings& search, const Design& design) {
  return parameter_overrides(load_settings(search.robot), parameters_of(search, design));
}

std::string quoted(const std::string& text) {
  std::string all = "\"";
  for (const char c : text) all += c == '"' ? "\"\"" : std::string(1, c == '\n' ? ' ' : c);
  return all + "\"";
}

std::string designs_csv(const SearchSettings& search, const std::vector<Design>& designs) {
  std::ostringstream csv;
  csv << "design";
  for (const StudyParameter& parameter : search.parameters) csv << "," << quoted(parameter.name);
  for (const Objective& objective : search.objectives) csv << "," << objective.name;
  csv << ",good,why_not\n";
  for (std::size_t i = 0; i < designs.size(); ++i) {
    csv << i + 1;
    for (const double value : designs[i].values) csv << "," << format_number(value);
    for (std::size_t k = 0; k < search.objectives.size(); ++k)
      csv << "," << (designs[i].good ? format_number(value_of(search, designs[i], k)) : "");
    csv << "," << (designs[i].good ? 1 : 0) << "," << quoted(designs[i].why_not) << "\n";
  }
  return csv.str();
}

Table front_table(const SearchSettings& search, const std::vector<Design>& designs,
                  const std::vector<std::size_t>& front) {
  Table table{{{"design"}}, {}};
  for (const Objective& objective : search.objectives) table.columns.push_back({objective.name, 4});
  for (const StudyParameter& parameter : search.parameters) table.columns.push_back({parameter.name, 4});
  for (const std::size_t place : front) {
    std::vector<TableCell> row = {static_cast<double>(place + 1)};
    for (std::size_t k = 0; k < search.objectives.size(); ++k) row.emplace_back(value_of(search, designs[place], k));
    row.insert(row.end(), designs[place].values.begin(), designs[place].values.end());
    table.rows.push_back(std::move(row));
  }
  return table;
}

// Reasons up to where they speak of numbers, with how often each was met.
Table refusals(const std::vector<Design>& designs) {
  std::map<std::string, int> counts;
  for (const Design& design : designs) {
    if (design.good) continue;
    const std::size_t colon = design.why_not.find(": ", design.why_not.find(": ") + 1);
    ++counts[design.why_not.substr(0, colon)];
  }
  Table table{{{"reason"}, {"designs"}}, {}};
  for (const auto& [reason, count] : counts) table.rows.push_back({reason, static_cast<double>(count)});
  return table;
}

Plot course_of(const SearchSettings& search, const std::vector<Design>& designs) {
  Plot plot{"course",
            search.objectives[0].name + " of the designs as they were tried",
            {"design"},
            {search.objectives[0].name}};
  Series tried{"tried", {}, {}, SeriesStyle::points}, best{"best so far", {}, {}, SeriesStyle::lines};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < designs.size(); ++i) {
    if (!designs[i].good) continue;
    tried.x.push_back(static_cast<double>(i + 1));
    tried.y.push_back(value_of(search, designs[i], 0));
    const bool better = designs[i].fitness[0] < least;
    least = std::min(least, designs[i].fitness[0]);
    best.x.push_back(tried.x.back());
    best.y.push_back(better || best.y.empty() ? tried.y.back() : best.y.back());
  }
  plot.series = {tried, best};
  return plot;
}

Plot front_plot(const SearchSettings& search, const std::vector<Design>& designs, const std::vector<std::size_t>& front,
                std::size_t other) {
  Plot plot{
      "front_" + std::to_string(other), "Pareto front", {search.objectives[0].name}, {search.objectives[other].name}};
  Series all{"all", {}, {}, SeriesStyle::points}, best{"front", {}, {}, SeriesStyle::squares};
  best.style = SeriesStyle::lines_points;
  for (const Design& design : designs) {
    if (!design.good) continue;
    all.x.push_back(value_of(search, design, 0));
    all.y.push_back(value_of(search, design, other));
  }
  for (const std::size_t place : front) {
    best.x.push_back(value_of(search, designs[place], 0));
    best.y.push_back(value_of(search, designs[place], other));
    best.point_labels.push_back(std::to_string(place + 1));
  }
  plot.series = {all, best};
  return plot;
}

std::string picture_of(const SearchSettings& search, const Design& design, const std::string& file,
                       const std::string& mesher) {
  SceneOptions options;
  options.mesher = mesher;
  options.actuator_factory = make_actuator;
  options.overrides = overrides_of(search, design);
  write_file(file, picture_png(load_cast_robot(search.robot, options).robot.surface, Paint{}));
  return file;
}

void write_designs(const SearchSettings& search, const std::vector<Design>& designs,
                   const std::vector<std::size_t>& front, const std::string& folder) {
  for (const auto& entry : fs::directory_iterator(folder))  // of an earlier front
    if (entry.path().filename().string().rfind("design_", 0) == 0) fs::remove(entry.path());
  const fs::path from = fs::weakly_canonical(folder);
  for (const std::size_t place : front)
    write_file(folder + "/" + name_of(place) + ".yaml", "# Found by a search.\ninclude: \"" +
                                                            fs::path(search.robot).lexically_relative(from).string() +
                                                            "\"\n" + overrides_of(search, designs[place]).text());
}

}  // namespace

void write_search_report(const SearchSettings& search, const std::vector<Design>& designs, const std::string& folder,
                         const std::string& mesher) {
  const std::vector<std::size_t> front = pareto_front(designs);
  fs::create_directories(folder);
  write_file(folder + "/designs.csv", designs_csv(search, designs));
  write_designs(search, designs, front, folder);
  HtmlPage page("Designs of " + fs::path(search.robot).parent_path().filename().string());
  const auto good = std::count_if(designs.begin(), designs.end(), [](const Design& one) { return one.good; });
  page.paragraph(std::to_string(designs.size()) + " designs, " + std::to_string(good) + " of them good.",
                 search.method + ":");
  if (!front.empty()) {
    page.heading(search.objectives.size() > 1 ? "Pareto front" : "Best design");
    page.table(front_table(search, designs, front));
    std::vector<std::string> pictures;
    for (const std::size_t place : front)
      if (pictures.size() < kMostPictures)
        pictures.push_back(picture_of(search, designs[place], folder + "/" + name_of(place) + ".png", mesher));
    page.pictures(pictures);
    for (std::size_t other = 1; other < search.objectives.size(); ++other)
      page.pictures({write_plot(front_plot(search, designs, front, other), folder).svg});
    page.heading("How it came about");
    page.pictures({write_plot(course_of(search, designs), folder).svg});
  }
  if (const Table refused = refusals(designs); !refused.rows.empty()) {
    page.heading("Not good");
    page.table(refused);
  }
  write_file(folder + "/report.html", page.html());
}

std::string search_summary(const SearchSettings& search, const std::vector<Design>& designs) {
  std::ostringstream text;
  const auto good = std::count_if(designs.begin(), designs.end(), [](const Design& one) { return one.good; });
  text << designs.size() << " designs, " << good << " good\n";
  for (const std::size_t place : pareto_front(designs)) {
    text << name_of(place) << ":";
    for (std::size_t k = 0; k < search.objectives.size(); ++k)
      text << " " << search.objectives[k].name << " " << value_of(search, designs[place], k);
    text << "\n";
  }
  return text.str();
}

}  // namespace soft_robot_lab
