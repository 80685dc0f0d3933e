// SPDX-License-Identifier: BSD-3-Clause
#include "session_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <set>
#include <sstream>
#include <stdexcept>

#include <Eigen/Core>
#include <opencv2/core/version.hpp>
#include <ros/common.h>

#include "session/report/html_page.h"
#include "session/report/plot.h"
#include "conversions.h"
#include "recording.h"
#include "session_pictures.h"
#include "soft_robot_lab/robot/scene/scene_file.h"
#include "soft_robot_lab/settings/config_folder.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

constexpr size_t kDrawnPoints = 1000, kDrawnMarks = 150;  // of a curve: more cannot be distinguished
constexpr size_t kPictured = 40;                          // configurations at rest, at most
const char* const kAxes = "xyz";

template <typename Item>
std::vector<Item> thinned(const std::vector<Item>& all, size_t count) {
  const size_t every = (all.size() + count - 1) / count;
  std::vector<Item> some;
  for (size_t i = 0; i < all.size(); i += every) some.push_back(all[i]);
  return some;
}

// Means over spans of time, so that noise does not hide the curve.
void smooth(Series& series) {
  const size_t every = series.x.size() / kDrawnMarks + 1;
  std::vector<double> x, y;
  for (size_t i = 0; i < series.x.size(); i += every) {
    const size_t end = std::min(series.x.size(), i + every);
    double sum_x = 0.0, sum_y = 0.0;
    for (size_t k = i; k < end; ++k) sum_x += series.x[k], sum_y += series.y[k];
    x.push_back(sum_x / static_cast<double>(end - i));
    y.push_back(sum_y / static_cast<double>(end - i));
  }
  series.x = std::move(x);
  series.y = std::move(y);
}

std::string number(double value, int digits = 3) {
  std::ostringstream text;
  text.precision(digits);
  text << value;
  return text.str();
}

std::string words_of(const std::map<std::string, double>& commands) {
  std::string words;
  for (const auto& [name, value] : commands) words += (words.empty() ? "" : ", ") + name + " " + number(value, 4);
  return words.empty() ? "none yet" : words;
}

Plot policy_plot(const Recording& recording) {
  Plot plot{"policy", "Commands", {}, {}, {}};
  plot.x.label = "time [s]";
  plot.y.label = "command";
  std::map<std::string, Series> by_name;
  for (const CommandsSince& since : recording.commands) {
    for (const auto& [name, value] : since.values) {
      Series& series = by_name.try_emplace(name, Series{name, {}, {}, SeriesStyle::lines}).first->second;
      const double time_s = since.time_s - recording.start_s;
      if (!series.y.empty()) {  // it stays until it is changed
        series.x.push_back(time_s);
        series.y.push_back(series.y.back());
      }
      series.x.push_back(time_s);
      series.y.push_back(value);
    }
  }
  for (auto& [name, series] : by_name) {
    series.x.push_back(recording.end_s - recording.start_s);
    series.y.push_back(series.y.back());
    plot.series.push_back(std::move(series));
  }
  return plot;
}

void add_track(const std::vector<MarkerObservations>& all, double start_s, size_t axis, bool seen_only,
               const std::string& suffix, SeriesStyle style, Plot& plot) {
  std::map<std::string, Series> by_name;
  for (const MarkerObservations& at : thinned(all, seen_only ? kDrawnMarks : kDrawnPoints)) {
    for (size_t i = 0; i < at.names.size(); ++i) {
      if (seen_only && at.sources.at(i) != MarkerObservations::SEEN) continue;
      Series& series = by_name.try_emplace(at.names[i], Series{at.names[i] + suffix, {}, {}, style}).first->second;
      series.x.push_back(at.header.stamp.toSec() - start_s);
      series.y.push_back(1e3 * from_message(at.positions.at(i), "positions")[static_cast<Eigen::Index>(axis)]);
    }
  }
  int colour = 0;
  for (auto& [name, series] : by_name) {
    series.colour = colour++ % 8;
    plot.series.push_back(std::move(series));
  }
}

Plot trajectory_plot(const Recording& recording, size_t axis) {
  const std::string name(1, kAxes[axis]);
  Plot plot{"markers_" + name, "Markers along " + name + ": measured (points), simulated (lines)", {}, {}, {}};
  plot.x.label = "time [s]";
  plot.y.label = name + " [mm]";
  add_track(recording.simulated, recording.start_s, axis, false, "", SeriesStyle::lines, plot);
  Plot measured = plot;
  measured.series.clear();
  add_track(recording.measured, recording.start_s, axis, true, "", SeriesStyle::points, measured);
  for (Series& series : measured.series) {
    if (!recording.simulated.empty()) series.label.clear();
    plot.series.push_back(std::move(series));
  }
  return plot;
}

Plot gap_plot(const std::vector<RealityGap>& gaps, double start_s) {
  Plot plot{"gap", "Gap between measured and simulated markers", {}, {}, {}};
  plot.x.label = "time [s]";
  plot.y.label = "distance [mm]";
  plot.y.min = 0.0;
  Series rms{"rms", {}, {}, SeriesStyle::lines};
  std::map<std::string, Series> by_name;
  for (const RealityGap& gap : gaps) {
    const double time_s = gap.header.stamp.toSec() - start_s;
    rms.x.push_back(time_s);
    rms.y.push_back(1e3 * gap.rms_m);
    for (size_t i = 0; i < gap.names.size(); ++i) {
      if (gap.seen[i] == 0) continue;
      Series& series =
          by_name.try_emplace(gap.names[i], Series{gap.names[i], {}, {}, SeriesStyle::dashes}).first->second;
      series.x.push_back(time_s);
      series.y.push_back(1e3 * gap.distances_m[i]);
    }
  }
  plot.series.push_back(std::move(rms));
  for (auto& [name, series] : by_name) plot.series.push_back(std::move(series));
  for (Series& series : plot.series) smooth(series);
  return plot;
}

// The gap over a rest period: of each marker seen in it, and of all.
struct RestGap {
  std::map<std::string, double> rms_m;
  double all_m = 0.0;
  bool known = false;
};

RestGap gap_over(const RestPeriod& period, const std::vector<RealityGap>& gaps) {
  std::map<std::string, std::pair<double, int>> sums;
  double sum = 0.0;
  int count = 0;
  for (const RealityGap& gap : gaps) {
    const double time_s = gap.header.stamp.toSec();
    if (time_s < period.start_s || time_s >= period.end_s) continue;
    for (size_t i = 0; i < gap.names.size(); ++i) {
      if (gap.seen[i] == 0) continue;
      const double squared = gap.distances_m[i] * gap.distances_m[i];
      sums[gap.names[i]].first += squared;
      ++sums[gap.names[i]].second;
      sum += squared;
      ++count;
    }
  }
  RestGap result;
  result.known = count > 0;
  if (result.known) result.all_m = std::sqrt(sum / count);
  for (const auto& [name, of] : sums) result.rms_m[name] = std::sqrt(of.first / of.second);
  return result;
}

Table rest_table(const std::vector<RestPeriod>& periods, const std::vector<RestGap>& gaps, double start_s) {
  std::set<std::string> markers;
  for (const RestGap& gap : gaps)
    for (const auto& [name, rms_m] : gap.rms_m) markers.insert(name);
  Table table;
  table.columns = {{"#"}, {"commands"}, {"from [s]", 4}, {"to [s]", 4}, {"rms gap [mm]", 3}};
  for (const std::string& name : markers) table.columns.push_back({name + " [mm]", 3});
  for (size_t i = 0; i < periods.size(); ++i) {
    std::vector<TableCell> row = {double(i + 1), words_of(periods[i].pose.commands), periods[i].start_s - start_s,
                                  periods[i].end_s - start_s, std::string()};
    if (gaps[i].known) row[4] = 1e3 * gaps[i].all_m;
    for (const std::string& name : markers) {
      const auto found = gaps[i].rms_m.find(name);
      row.push_back(found == gaps[i].rms_m.end() ? TableCell(std::string()) : TableCell(1e3 * found->second));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Plot rest_plot(const std::vector<RestGap>& gaps) {
  Plot plot{"gap_at_rest", "Gap at rest, by configuration (numbers as in the table)", {}, {}, {}};
  plot.x.label = "configuration";
  plot.y.label = "rms gap [mm]";
  plot.y.min = 0.0;
  Series series{"", {}, {}, SeriesStyle::bars};
  for (size_t i = 0; i < gaps.size(); ++i) {
    if (!gaps[i].known) continue;
    series.x.push_back(double(i + 1));
    series.y.push_back(1e3 * gaps[i].all_m);
  }
  plot.series = {series};
  return plot;
}

double rms_of(const std::vector<RestGap>& gaps) {
  double sum = 0.0;
  int count = 0;
  for (const RestGap& gap : gaps) {
    if (!gap.known) continue;
    sum += gap.all_m * gap.all_m;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

std::string file_text(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  return text.str();
}

bool lies_below(const std::string& file, const std::filesystem::path& folder) {
  const std::filesystem::path inside = std::filesystem::weakly_canonical(file).lexically_relative(
      std::filesystem::weakly_canonical(std::filesystem::absolute(folder)));
  return !inside.empty() && *inside.begin() != "..";
}

// A recording may come from anybody and name any file. Its page, which is passed on, shows scenes only, and of those
// that the user did not name, only the package's own and those that lie with the recording.
void add_parameters(const std::string& scene, bool given, const std::string& bag, HtmlPage& page) {
  if (scene.empty()) return page.paragraph("The scene is not known.");
  const bool trusted =
      given || lies_below(scene, config_folder()) || lies_below(scene, std::filesystem::absolute(bag).parent_path());
  if (!trusted)
    return page.paragraph(
        "The recording names a scene outside the package and its own folder, which is shown only where "
        "--scene names it: " +
        scene);
  if (!is_scene_file(scene)) return page.paragraph("The scene file is not there to be shown, or is no scene: " + scene);
  page.text(file_text(scene));
}

Table facts(const std::string& bag, const Recording& recording, const std::string& scene, double rest_rms_m,
            size_t rests) {
  Table table;
  table.columns = {{"what"}, {""}};
  table.rows = {{std::string("recording"), bag},
                {std::string("scene"), scene.empty() ? "not recorded" : scene},
                {std::string("duration"), number(recording.end_s - recording.start_s, 4) + " s"},
                {std::string("tracked observations"), std::to_string(recording.measured.size())},
                {std::string("simulated observations"), std::to_string(recording.simulated.size())},
                {std::string("changes of commands"), std::to_string(recording.commands.size())},
                {std::string("configurations at rest"), std::to_string(rests)},
                {std::string("rms gap at rest"), rest_rms_m > 0.0 ? number(1e3 * rest_rms_m) + " mm" : "not known"}};
  return table;
}

Table versions() {
  Table table;
  table.columns = {{"software"}, {"version"}};
  table.rows = {{std::string("soft_robot_lab"), std::string(SOFT_ROBOT_LAB_VERSION)},
                {std::string("roscpp"), std::to_string(ROS_VERSION_MAJOR) + "." + std::to_string(ROS_VERSION_MINOR) +
                                            "." + std::to_string(ROS_VERSION_PATCH)},
                {std::string("OpenCV"), std::string(CV_VERSION)},
                {std::string("Eigen"), std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) +
                                           "." + std::to_string(EIGEN_MINOR_VERSION)},
                {std::string("compiler"), std::string(__VERSION__)}};
  return table;
}

void add_plot(const Plot& plot, const std::string& folder, HtmlPage& page) {
  const bool drawable = std::any_of(plot.series.begin(), plot.series.end(), [](const auto& s) { return !s.x.empty(); });
  if (drawable) page.pictures({write_plot(plot, folder).png});
}

// One row for each configuration, as numbered in the table: what each camera saw in the middle of it.
void add_pictures(const std::string& bag, const Recording& recording, const std::vector<RestPeriod>& periods,
                  const std::string& folder, HtmlPage& page) {
  std::vector<size_t> numbers(periods.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  numbers = thinned(numbers, kPictured);
  std::vector<double> times_s;
  for (const size_t k : numbers) times_s.push_back(0.5 * (periods[k].start_s + periods[k].end_s));
  if (times_s.empty()) times_s.push_back(recording.start_s);
  const std::vector<SessionPicture> pictures = draw_session(bag, recording.gaps, times_s, folder);
  page.paragraph(pictures.empty() ? "The recording has no images with lens and place of their camera."
                                  : "The simulated robot in blue, lines from simulated to measured markers.");
  for (auto first = pictures.begin(); first != pictures.end();) {
    const auto last = std::find_if(first, pictures.end(), [&](const auto& p) { return p.asked != first->asked; });
    std::string words = numbers.empty() ? "" : "Configuration " + std::to_string(numbers[first->asked] + 1) + ": ";
    std::vector<std::string> files;
    for (auto p = first; p != last; ++p) {
      words += (p == first ? "" : ", ") + p->camera + " at " + number(p->time_s - recording.start_s, 4) + " s";
      files.push_back(p->file);
    }
    page.paragraph(words);
    page.pictures(files);
    first = last;
  }
}

}  // namespace

SessionReport write_session_report(const std::string& bag, const std::string& folder, const std::string& scene) {
  const Recording recording = read_recording(bag);
  const std::string scene_file = scene.empty() ? recording.scene : scene;
  std::filesystem::create_directories(folder);
  const std::vector<RestPeriod> periods = rest_periods(recording);
  std::vector<RestGap> gaps;
  for (const RestPeriod& period : periods) gaps.push_back(gap_over(period, recording.gaps));
  SessionReport report{folder + "/report.html", static_cast<int>(periods.size()), rms_of(gaps)};

  HtmlPage page("Session " + std::filesystem::path(bag).filename().string());
  page.table(facts(bag, recording, scene_file, report.rest_rms_m, periods.size()));
  page.heading("Gap over time");
  if (recording.gaps.empty())
    page.paragraph("No simulated markers at the times of tracked ones: the gap is not known.");
  add_plot(gap_plot(recording.gaps, recording.start_s), folder, page);
  page.heading("Gap by configuration");
  if (periods.empty()) page.paragraph("The robot was never at rest under commands that did not change.");
  if (!periods.empty()) page.table(rest_table(periods, gaps, recording.start_s));
  add_plot(rest_plot(gaps), folder, page);
  page.heading("Policy");
  if (recording.commands.empty()) page.paragraph("No commands were given.");
  add_plot(policy_plot(recording), folder, page);
  page.heading("Trajectories");
  for (size_t axis = 0; axis < 3; ++axis) add_plot(trajectory_plot(recording, axis), folder, page);
  page.heading("What the cameras saw");
  add_pictures(bag, recording, periods, folder, page);
  page.heading("Parameters");
  add_parameters(scene_file, !scene.empty(), bag, page);
  page.heading("Versions");
  page.table(versions());

  write_file(report.page, page.html());
  return report;
}

}  // namespace soft_robot_lab
