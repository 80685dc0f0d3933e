// SPDX-License-Identifier: BSD-3-Clause
#include "configuration_pages.h"

#include <sstream>

#include <Eigen/Core>

#include "session/report/html_page.h"
#include "session_pictures.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

std::string number(double value) {
  std::ostringstream text;
  text.precision(4);
  text << value;
  return text.str();
}

// Means over the period.
std::map<std::string, Eigen::Vector3d> simulated_over(const RestPeriod& period, const RecordedSession& recording) {
  std::map<std::string, std::pair<Eigen::Vector3d, int>> sums;
  for (const ObservedMarkers& at : recording.simulated) {
    if (at.time_s < period.start_s || at.time_s >= period.end_s) continue;
    for (const ObservedMarker& marker : at.markers) {
      auto& [sum_m, count] = sums.try_emplace(marker.name, Eigen::Vector3d::Zero(), 0).first->second;
      sum_m += marker.position_m;
      ++count;
    }
  }
  std::map<std::string, Eigen::Vector3d> means;
  for (const auto& [name, of] : sums) means[name] = of.first / of.second;
  return means;
}

Table marker_table(const RestPeriod& period, const RecordedSession& recording) {
  Table table;
  table.columns = {{"marker"}};
  for (const char* which : {"tracked", "simulated"})
    for (const char axis : {'x', 'y', 'z'}) table.columns.push_back({std::string(which) + " " + axis + " [mm]", 4});
  table.columns.push_back({"apart [mm]", 3});
  const std::map<std::string, Eigen::Vector3d> simulated_m = simulated_over(period, recording);
  for (const MeasuredMarker& marker : period.pose.markers) {
    std::vector<TableCell> row = {marker.name};
    for (int axis = 0; axis < 3; ++axis) row.emplace_back(1e3 * marker.position_m[axis]);
    const auto model = simulated_m.find(marker.name);
    for (int axis = 0; axis < 3; ++axis)
      row.push_back(model == simulated_m.end() ? TableCell(std::string()) : TableCell(1e3 * model->second[axis]));
    row.push_back(model == simulated_m.end() ? TableCell(std::string())
                                             : TableCell(1e3 * (marker.position_m - model->second).norm()));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<std::string> files_of(const std::vector<SessionPicture>& pictures, std::size_t configuration) {
  std::vector<std::string> files;
  for (const SessionPicture& picture : pictures)
    if (picture.asked == configuration) files.push_back(picture.file);
  return files;
}

}  // namespace

std::string words_of(const std::map<std::string, double>& commands) {
  std::string words;
  for (const auto& [name, value] : commands) words += (words.empty() ? "" : ", ") + name + " " + number(value);
  return words.empty() ? "none yet" : words;
}

std::vector<std::string> write_configuration_pages(const std::string& bag, const RecordedSession& recording,
                                                   const std::vector<RestPeriod>& periods, const std::string& folder) {
  std::vector<double> times_s;
  for (const RestPeriod& period : periods) times_s.push_back(0.5 * (period.start_s + period.end_s));
  const std::vector<SessionPicture> pictures = draw_session(bag, recording.gaps, times_s, folder);
  std::vector<std::string> names;
  for (std::size_t k = 0; k < periods.size(); ++k) {
    const RestPeriod& period = periods[k];
    HtmlPage page("Configuration " + std::to_string(k + 1) + ": " + words_of(period.pose.commands));
    page.paragraph("At rest from " + number(period.start_s - recording.start_s) + " to " +
                   number(period.end_s - recording.start_s) +
                   " s of the recording. Positions are means, in robot_base.");
    page.table(marker_table(period, recording));
    page.pictures(files_of(pictures, k));
    names.push_back("configuration_" + std::to_string(k + 1) + ".html");
    write_file(folder + "/" + names.back(), page.html());
  }
  return names;
}

}  // namespace soft_robot_lab
