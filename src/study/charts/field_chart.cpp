// SPDX-License-Identifier: BSD-3-Clause
#include "field_chart.h"

#include <sstream>

#include "plot_series.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kOurs = "ours, run here: ";
constexpr const char* kPublished = "published, not run here";

std::string percent_of_displacement(double error) {
  std::ostringstream text;
  text.precision(2);
  text << 100.0 * error << " % of the displacement";
  return text.str();
}

std::string millimetres(double rms_m) {
  std::ostringstream text;
  text.precision(2);
  text << 1e3 * rms_m << " mm rms";
  return text.str();
}

// Bullet's cheap runs that stop before their rest state are no answers.
void add_cantilever(const std::vector<SpeedRun>& runs, const std::string& poissons_ratio,
                    std::vector<FieldPoint>& points) {
  for (const bool bullet : {false, true}) {
    std::vector<SpeedRun> chosen;
    for (const SpeedRun& run : runs) {
      if (run.problem == "cantilever" && run.poissons_ratio == poissons_ratio && run.mode == "settled" &&
          run.bullet == bullet)
        chosen.push_back(run);
    }
    for (const SpeedRun& run : best_of(chosen)) {
      const std::string group = bullet ? "Bullet, run here: cantilever" : kOurs + std::string("cantilever, newton");
      points.push_back({group, run.rung, 3.0 * run.nodes, 1.0 / run.cost, percent_of_displacement(run.error),
                        "cantilever at " + poissons_ratio + ", 60 Hz, one core", ""});
    }
  }
}

void add_motion(const std::vector<MotionRun>& runs, std::vector<FieldPoint>& points) {
  for (const MotionRun& run : runs) {
    const std::string kind = run.modes > 0 ? "reduced" : run.rung.substr(0, run.rung.find(','));
    points.push_back({kOurs + std::string("Spinebot, ") + kind, run.rung + ", " + std::to_string(run.steps),
                      run.modes > 0 ? run.modes : 3.0 * run.nodes, 1.0 / run.cost, millimetres(run.rms_m),
                      "Spinebot in motion, " + std::to_string(run.steps) + " steps a frame of 1/60 s, one core", ""});
  }
}

}  // namespace

std::vector<PublishedFigure> read_published(const std::vector<YamlNode>& list) {
  std::vector<PublishedFigure> all;
  for (const YamlNode& item : list) {
    PublishedFigure figure;
    figure.name = item.text("name");
    if (item.has("unknowns")) figure.unknowns = item.number("unknowns", AllowedRange::positive());
    figure.times_real_time = item.number("times_real_time", AllowedRange::positive());
    figure.published = item.text("published");
    figure.setting = item.text("setting");
    figure.source = item.text("source");
    all.push_back(figure);
  }
  return all;
}

std::vector<FieldPoint> field_points(const std::vector<SpeedRun>& runs, const std::string& poissons_ratio,
                                     const std::vector<MotionRun>& motion,
                                     const std::vector<PublishedFigure>& published) {
  std::vector<FieldPoint> points;
  add_cantilever(runs, poissons_ratio, points);
  add_motion(motion, points);
  for (const PublishedFigure& figure : published)
    points.push_back({kPublished, figure.name, figure.unknowns, figure.times_real_time, "none stated",
                      figure.published + "; " + figure.setting, figure.source});
  return points;
}

Plot plot_field(const std::vector<FieldPoint>& points) {
  Plot plot{"against_the_field", "Speed over size; errors, machines and scenes differ (see the table)", {}, {}};
  plot.x = {"unknowns", true};
  plot.y = {"times real time", true};
  plot.y.guides = {1.0};
  plot.width_px = 1300;
  plot.height_px = 800;
  for (const FieldPoint& point : points) {
    if (!point.unknowns) continue;
    const bool published = point.group == kPublished;
    Series& series = series_of(plot, point.group);
    series.style = published ? SeriesStyle::crosses : SeriesStyle::points;
    series.x.push_back(*point.unknowns);
    series.y.push_back(point.times_real_time);
    if (published) series.point_labels.push_back(point.name);
  }
  return plot;
}

nlohmann::ordered_json field_json(const std::vector<FieldPoint>& points) {
  auto json = nlohmann::ordered_json::array();
  for (const FieldPoint& point : points) {
    nlohmann::ordered_json one = {{"group", point.group}, {"name", point.name}};
    one["unknowns"] = point.unknowns ? nlohmann::ordered_json(*point.unknowns) : nlohmann::ordered_json(nullptr);
    one["times_real_time"] = point.times_real_time;
    one["error"] = point.error;
    one["setting"] = point.setting;
    if (!point.source.empty()) one["source"] = point.source;
    json.push_back(one);
  }
  return json;
}

}  // namespace soft_robot_lab
