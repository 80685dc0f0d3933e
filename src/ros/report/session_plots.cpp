// SPDX-License-Identifier: BSD-3-Clause
#include "session_plots.h"

#include <algorithm>

namespace soft_robot_lab {
namespace {

constexpr size_t kDrawnPoints = 1000, kDrawnMarks = 150;  // of a curve: more cannot be distinguished
constexpr size_t kMostNumbered = 20;                      // bars, each over its number
const char* const kAxes = "xyz";

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

Axis time_axis(const RecordedSession& recording) {
  Axis axis{"time [s]"};
  for (const auto* events : {&recording.events, &recording.settings})
    for (const RecordedEvent& event : *events) axis.guides.push_back(event.time_s - recording.start_s);
  return axis;
}

void add_track(const std::vector<ObservedMarkers>& all, double start_s, size_t axis, bool seen_only,
               const std::string& suffix, SeriesStyle style, Plot& plot) {
  std::map<std::string, Series> by_name;
  for (const ObservedMarkers& at : thinned(all, seen_only ? kDrawnMarks : kDrawnPoints)) {
    for (const ObservedMarker& marker : at.markers) {
      if (seen_only && !marker.seen) continue;
      Series& series = by_name.try_emplace(marker.name, Series{marker.name + suffix, {}, {}, style}).first->second;
      series.x.push_back(at.time_s - start_s);
      series.y.push_back(1e3 * marker.position_m[static_cast<Eigen::Index>(axis)]);
    }
  }
  int colour = 0;
  for (auto& [name, series] : by_name) {
    series.colour = colour++ % 8;
    plot.series.push_back(std::move(series));
  }
}

}  // namespace

Plot policy_plot(const RecordedSession& recording) {
  Plot plot{"policy", "Commands", {}, {}, {}};
  plot.x = time_axis(recording);
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

Plot trajectory_plot(const RecordedSession& recording, size_t axis) {
  const std::string name(1, kAxes[axis]);
  Plot plot{"markers_" + name, "Markers along " + name + ": measured (points), simulated (lines)", {}, {}, {}};
  plot.x = time_axis(recording);
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

Plot gap_plot(const RecordedSession& recording) {
  Plot plot{"gap", "Gap between measured and simulated markers", {}, {}, {}};
  plot.x = time_axis(recording);
  plot.y.label = "distance [mm]";
  plot.y.min = 0.0;
  Series rms{"rms", {}, {}, SeriesStyle::lines};
  std::map<std::string, Series> by_name;
  for (const RealityGap& gap : recording.gaps) {
    const double time_s = gap.header.stamp.toSec() - recording.start_s;
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

Plot rest_plot(const std::vector<RestGap>& gaps) {
  Plot plot{"gap_at_rest", "Gap at rest, by configuration (numbers as in the table)", {}, {}, {}};
  plot.x.label = "configuration";
  plot.y.label = "rms gap [mm]";
  plot.y.min = 0.0;
  Series series{"", {}, {}, SeriesStyle::bars};
  for (size_t i = 0; i < gaps.size(); ++i) {
    if (gaps.size() <= kMostNumbered) plot.x.ticks.emplace_back(double(i + 1), std::to_string(i + 1));
    if (!gaps[i].known) continue;
    series.x.push_back(double(i + 1));
    series.y.push_back(1e3 * gaps[i].all_m);
  }
  plot.series = {series};
  return plot;
}

}  // namespace soft_robot_lab
