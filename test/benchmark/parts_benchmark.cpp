// SPDX-License-Identifier: BSD-3-Clause
// What each optional part of a scene costs where it is listed; a scene that does not list it runs the first row. A bar
// of 100 x 20 x 20 mm swings for half a second at 60 Hz, or settles. CPU time of one thread.
#include <algorithm>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "smallest.h"
#include "settings/overrides_from.h"

namespace soft_robot_lab {
namespace {

const std::string kBar = std::string(SOFT_ROBOT_LAB_SOURCE) + "/config/scenes/cantilever.yaml";
const std::string kHollowBar = std::string(SOFT_ROBOT_LAB_SOURCE) + "/test/data/scenes/hollow_bar.yaml";
const std::string kSwing = "run: {mode: dynamic, duration_s: 0.5, record_every_s: 0.5}\n";
const std::string kSettle = "run: {mode: equilibrium}\n";
const std::string kSlackCable =
    "cables: [{name: c, points_m: [[0, -0.007, 0], [0.1, -0.007, 0]], compliance_m_n: 1.0e-5}]\n";

void run(benchmark::State& state, const std::string& file, const std::string& overrides) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.cache_folder = SOFT_ROBOT_LAB_CACHE;
  options.actuator_factory = make_actuator;
  options.overrides =
      overrides_from((overrides.find("markers") == std::string::npos ? "markers: []\n" : "") + overrides);
  Scene scene = load_scene(file, options);
  RunReport report = run_scene(scene);  // warm up
  for (auto _ : state) {
    scene.simulation->reset();
    report = run_scene(scene);
    if (!report.solve.converged) state.SkipWithError(report.solve.message.c_str());
  }
  state.counters["iterations"] = report.solve.iterations;
}

void measured(const std::string& name, const std::string& overrides, const std::string& file = kBar) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) { run(state, file, overrides); })
      ->Unit(benchmark::kMillisecond)
      ->MinTime(0.2)
      ->Repetitions(5)
      ->ComputeStatistics("min", smallest)
      ->DisplayAggregatesOnly();
}

const bool registered = [] {
  std::string markers = "markers:\n";
  for (int i = 1; i <= 10; ++i)
    markers += "- {name: m" + std::to_string(i) + ", position_m: [" + std::to_string(0.01 * i) + ", -0.01, 0]}\n";
  measured("swing/nothing_listed", kSwing);
  measured("swing/10_markers", kSwing + markers);
  measured("swing/10_markers_recorded_every_step", markers + "run: {mode: dynamic, duration_s: 0.5}\n");
  measured("swing/surface_load",
           kSwing + "loads: [{box: {min_m: [0.09999, -1, -1], max_m: [1, 1, 1]}, force_n: [0, 0, 0.001]}]\n");
  measured("swing/slack_cable", kSwing + kSlackCable);
  measured("swing/bdf2", kSwing + "solver: {integrator: bdf2}\n");
  measured("swing/hollow_nothing_listed", kSwing, kHollowBar);
  measured("swing/hollow_chamber", kSwing + "chambers: [{name: air, surface: cavity}]\n", kHollowBar);
  measured("settle/nothing_listed", kSettle);
  measured("settle/slack_cable", kSettle + kSlackCable);
  measured("settle/pulled_cable", kSlackCable + "run: {mode: equilibrium, commands: [{time_s: 0, c: 0.95}]}\n");
  measured("settle/pulled_cable_with_sensitivity",
           kSlackCable + "run: {mode: equilibrium, sensitivity: true, commands: [{time_s: 0, c: 0.95}]}\n" +
               "markers: [{name: tip, position_m: [0.1, 0, 0]}]\n");
  return true;
}();

}  // namespace
}  // namespace soft_robot_lab
