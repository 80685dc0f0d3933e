// SPDX-License-Identifier: BSD-3-Clause
#include "session_report.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include <Eigen/Core>
#include <opencv2/core/version.hpp>
#include <ros/common.h>
#include <sys/stat.h>

#include "configuration_pages.h"
#include "session_film.h"
#include "session_pictures.h"
#include "session_plots.h"
#include "ros/recording/recorded_session.h"
#include "session/report/html_page.h"
#include "session/report/plot.h"
#include "session/rest_periods.h"
#include "soft_robot_lab/robot/scene/scene_file.h"
#include "soft_robot_lab/settings/config_folder.h"
#include "settings/words.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

constexpr size_t kPictured = 40;  // configurations at rest, at most

std::string number(double value, int digits = 3) {
  std::ostringstream text;
  text.precision(digits);
  text << value;
  return text.str();
}

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

Table facts(const std::string& bag, const RecordedSession& recording, const std::string& scene, double rest_rms_m,
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
void add_pictures(const std::string& bag, const RecordedSession& recording, const std::vector<RestPeriod>& periods,
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

// The machine's day where stamps are of a clock, the file's where they are a simulation's.
std::string day_of(const std::string& bag, const Recording& recording) {
  constexpr double earliest_s = 1e9;  // 2001
  std::time_t time = static_cast<std::time_t>(recording.start_s);
  if (recording.start_s < earliest_s) {
    struct stat file {};
    if (stat(bag.c_str(), &file) != 0) return "an unknown day";
    time = file.st_mtime;
  }
  std::tm parts{};
  char text[64];
  if (gmtime_r(&time, &parts) == nullptr || std::strftime(text, sizeof text, "%e %B %Y, %H:%M UTC", &parts) == 0)
    return "an unknown day";
  return text[0] == ' ' ? text + 1 : text;
}

std::string count_of(size_t count, const std::string& one) {
  return std::to_string(count) + " " + one + (count == 1 ? "" : "s");
}

std::string how_far(const RecordedSession& recording, const std::vector<RestPeriod>& periods,
                    const std::vector<RestGap>& gaps) {
  if (recording.gaps.empty()) return "Tracked and simulated markers were never seen at one time: the gap is not known.";
  const auto worst =
      std::max_element(gaps.begin(), gaps.end(), [](const auto& a, const auto& b) { return a.all_m < b.all_m; });
  if (worst == gaps.end() || !worst->known)
    return "It never rested under commands that did not change, so the gap at rest is not known.";
  const auto number_of_worst = static_cast<size_t>(worst - gaps.begin());
  return "At rest, in " + count_of(periods.size(), "configuration") + ", tracked and simulated markers were " +
         number(1e3 * rms_of(gaps)) + " mm apart (rms), and most in number " + std::to_string(number_of_worst + 1) +
         " (" + words_of(periods[number_of_worst].pose.commands) + "): " + number(1e3 * worst->all_m) + " mm.";
}

std::string what_disturbed(const Recording& recording) {
  if (recording.events.empty()) return "No event of the motors disturbed it.";
  const RecordedEvent& first = recording.events.front();
  return count_of(recording.events.size(), "event") + " of the motors disturbed it, the first at " +
         number(first.time_s - recording.start_s, 4) + " s: " + first.text + ".";
}

// Three sentences and a picture: what a reader needs who reads no further.
void add_head(const std::string& bag, const RecordedSession& recording, const std::vector<RestPeriod>& periods,
              const std::vector<RestGap>& gaps, const std::string& folder, HtmlPage& page) {
  page.paragraph("On " + day_of(bag, recording) + ", a robot was recorded for " +
                 number(recording.end_s - recording.start_s, 4) + " s while its commands changed " +
                 (recording.commands.size() == 1 ? "once" : std::to_string(recording.commands.size()) + " times") +
                 ". " + how_far(recording, periods, gaps) + " " + what_disturbed(recording));
  const std::optional<SessionFilm> film = film_session(bag, recording, folder);
  if (!film)
    return page.paragraph("There is no film: the recording has no skin of the robot, or no film can be written here.");
  page.film(film->file, film->middle);
  if (film->speed > 1.0) page.paragraph("The film is " + number(film->speed) + " times as fast as the session was.");
}

Table event_table(const RecordedSession& recording) {
  std::vector<RecordedEvent> events = recording.events;
  events.insert(events.end(), recording.settings.begin(), recording.settings.end());
  std::stable_sort(events.begin(), events.end(), [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  Table table;
  table.columns = {{"time [s]", 4}, {"event"}};
  for (const RecordedEvent& event : events) table.rows.push_back({event.time_s - recording.start_s, event.text});
  return table;
}

}  // namespace

SessionReport write_session_report(const std::string& bag, const std::string& folder, const std::string& scene,
                                   bool configurations) {
  const RecordedSession recording = read_recorded_session(bag);
  const std::string scene_file = scene.empty() ? recording.scene : scene;
  std::filesystem::create_directories(folder);
  const std::vector<RestPeriod> periods = rest_periods(recording);
  std::vector<RestGap> gaps;
  for (const RestPeriod& period : periods) gaps.push_back(gap_over(period, recording.gaps));
  SessionReport report{folder + "/report.html", static_cast<int>(periods.size()), rms_of(gaps)};

  HtmlPage page("Session " + std::filesystem::path(bag).filename().string());
  add_head(bag, recording, periods, gaps, folder, page);
  if (const Table events = event_table(recording); !events.rows.empty()) page.table(events);
  page.table(facts(bag, recording, scene_file, report.rest_rms_m, periods.size()));
  page.heading("Gap over time");
  if (recording.gaps.empty())
    page.paragraph("No simulated markers at the times of tracked ones: the gap is not known.");
  add_plot(gap_plot(recording), folder, page);
  page.heading("Gap by configuration");
  if (periods.empty()) page.paragraph("The robot was never at rest under commands that did not change.");
  if (!periods.empty()) page.table(rest_table(periods, gaps, recording.start_s));
  if (configurations && !periods.empty())
    page.paragraph("Each has a page of its own beside this one: " +
                   join(write_configuration_pages(bag, recording, periods, folder)) + ".");
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
