// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "tracking_score.h"
#include "vision_experiments.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "settings/quantile.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

struct TrackingRun {
  std::string name;
  SensorModel sensor;
  DepthSettings depth;  // what the tracker knows of it
  double fraction = 1;  // of the film
};

struct TrackingExperiment {
  std::string robot;
  CameraSetup rig;
  TrackerSettings tracker;
  std::vector<CablePull> pulls;
  double hold_s = 0, rate_hz = 0;
  std::vector<TrackingRun> runs;
};

Cuboid read_post(const YamlNode& node, const CameraSetup& rig) {
  const Eigen::Vector3d half_m = 0.5 * node.vector3("size_m"), center_m = node.vector3("center_m");
  Cuboid post{center_m - half_m, center_m + half_m, {}};
  if (!rig.surroundings.cuboids.empty()) post.colour = rig.surroundings.cuboids.front().colour;
  return post;
}

TrackingExperiment read_experiment(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("tracking"));
  const auto file = [&](const std::string& key) { return context.config_folder + "/" + node.text(key); };
  TrackingExperiment experiment;
  experiment.robot = file("robot");
  experiment.rig = read_camera_setup(file("cameras"));
  experiment.tracker = load_tracker(file("tracker"));
  const Eigen::VectorXd contractions = node.child("contractions").as_numbers();
  for (const double left : contractions)
    for (const double right : contractions) experiment.pulls.push_back({left, right});
  experiment.hold_s = node.number("hold_s", {0.1, 100});
  experiment.rate_hz = node.number("rate_hz", {1, 120});
  if (const auto post = node.optional_child("post"))
    experiment.rig.surroundings.cuboids.push_back(read_post(*post, experiment.rig));
  for (const YamlNode& run : node.sequence("runs"))
    experiment.runs.push_back({run.text("name"), read_sensor_model(run.child("sensor")),
                               read_depth_settings(run, experiment.tracker.depth),
                               run.number_or("fraction", 1, {0, 1, true})});
  node.require_all_read();
  return experiment;
}

void add_run(const TrackingRun& run, const TrackingScore& score, const std::vector<TrackedMarker>& markers,
             double rate_hz, ExperimentResult& result) {
  result.table.rows.push_back({run.name, double(score.frames), double(score.visible), double(score.hidden_from_one),
                               double(score.seen), 1e3 * score.rms_m(), 1e3 * score.worst_error_m,
                               100 * score.missed_ratio(), 100 * score.false_ratio(), double(score.swaps),
                               1e3 * score.interpolated_rms_m(), score.cpu_cores(rate_hz)});
  const auto latency_s = [&](double fraction) { return score.frames ? quantile(score.latency_s, fraction) : 0; };
  auto& numbers = result.numbers[run.name];
  numbers = {{"rms_m", score.rms_m()},
             {"worst_m", score.worst_error_m},
             {"missed_ratio", score.missed_ratio()},
             {"false_ratio", score.false_ratio()},
             {"swaps", score.swaps},
             {"interpolated_rms_m", score.interpolated_rms_m()},
             {"update_median_s", latency_s(0.5)},
             {"update_worst_s", latency_s(1)}};
  for (std::size_t i = 0; i < markers.size(); ++i)
    numbers["marker_rms_m"][markers[i].name] =
        score.marker_seen[i] ? std::sqrt(score.marker_squared_error_m2[i] / score.marker_seen[i]) : 0;
}

Plot error_plot(const ExperimentResult& result, const std::vector<TrackedMarker>& markers) {
  Plot plot{"tracking", "Error of markers that were seen, by the sensor's model", {}, {}};
  plot.x.label = "marker";
  plot.y.label = "root mean square error [mm]";
  plot.y.min = 0;
  for (std::size_t i = 0; i < markers.size(); ++i) plot.x.ticks.push_back({double(i), markers[i].name});
  for (const auto& [name, run] : result.numbers.items()) {
    if (!run.contains("marker_rms_m")) continue;
    Series series{name, {}, {}, SeriesStyle::bars};
    for (std::size_t i = 0; i < markers.size(); ++i) {
      series.x.push_back(double(i));
      series.y.push_back(1e3 * run["marker_rms_m"][markers[i].name].get<double>());
    }
    plot.series.push_back(series);
  }
  return plot;
}

}  // namespace

ExperimentResult run_tracking_experiment(const ExperimentContext& context) {
  const TrackingExperiment experiment = read_experiment(context);
  const Overrides step = Overrides().set({"solver", "time_step_s"}, 0.5 / experiment.rate_hz);
  const Scene scene = load_scene(experiment.robot, context.scene_options(step));
  Simulation& simulation = *scene.simulation;
  context.report(0, "moving");
  const std::vector<Moment> moments = move_through(simulation, experiment.pulls, experiment.hold_s, experiment.rate_hz);
  const std::vector<TrackedMarker> markers = tracked_markers(simulation);
  ExperimentResult result;
  result.title = "Spinebot tracked by two cameras through its table of contractions";
  result.table.columns = {{"sensor"},
                          {"frames"},
                          {"visible"},
                          {"hidden from one"},
                          {"seen"},
                          {"rms [mm]", 3},
                          {"worst [mm]", 3},
                          {"missed [%]", 3},
                          {"false [%]", 3},
                          {"swaps"},
                          {"interpolated [mm]", 3},
                          {"cores", 2}};
  double cpu_cores = 0;
  for (std::size_t i = 0; i < experiment.runs.size(); ++i) {
    const TrackingRun& run = experiment.runs[i];
    CameraSetup rig = experiment.rig;
    for (RigCamera& camera : rig.cameras) camera.sensor = run.sensor;
    TrackerSettings settings = experiment.tracker;
    settings.readout_s = run.sensor.readout_time_s;
    settings.depth = run.depth;
    const auto progress = [&](double fraction) {
      context.report((double(i) + fraction) / double(experiment.runs.size()), run.name);
    };
    const auto end = moments.begin() + static_cast<std::ptrdiff_t>(run.fraction * double(moments.size()));
    const TrackingScore score = track({moments.begin(), end}, simulation, rig, settings, progress);
    add_run(run, score, markers, experiment.rate_hz, result);
    cpu_cores = std::max(cpu_cores, score.cpu_cores(experiment.rate_hz));
  }
  result.numbers["cpu_cores"] = cpu_cores;
  result.plots = {error_plot(result, markers)};
  result.we_find =
      "A marker counts as visible where a camera sees its middle and half its area, as missed where it is visible and "
      "the tracker did not see it, as false where it says seen and is more than 5 mm off. Cores: CPU-seconds of "
      "tracking a second of film.";
  return result;
}

}  // namespace soft_robot_lab
