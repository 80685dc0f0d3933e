// SPDX-License-Identifier: BSD-3-Clause
#include "release_chart.h"

#include <algorithm>
#include <cmath>

#include "settings/reference_table.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "settings/cpu_time.h"

namespace soft_robot_lab {
namespace {

constexpr double kPoissonsRatio = 0.49;  // of the table
constexpr double kTopAfter_s = 0.15;     // the first return to the top is later, the first minimum earlier
constexpr double kSecondFall_s = 0.25;   // and before the second minimum

struct Curve {
  std::vector<double> time_s, height_m;
};

double height_at(const Curve& curve, double time_s) {
  const auto next = std::lower_bound(curve.time_s.begin(), curve.time_s.end(), time_s);
  if (next == curve.time_s.begin()) return curve.height_m.front();
  if (next == curve.time_s.end()) return curve.height_m.back();
  const auto i = static_cast<std::size_t>(next - curve.time_s.begin());
  const double fraction = (time_s - curve.time_s[i - 1]) / (curve.time_s[i] - curve.time_s[i - 1]);
  return curve.height_m[i - 1] + fraction * (curve.height_m[i] - curve.height_m[i - 1]);
}

// Time and height of an extremum between two times, by a parabola through its three samples; `sign` 1: maximum.
std::pair<double, double> extremum(const Curve& curve, double from_s, double to_s, double sign) {
  std::size_t best = 0;
  double highest = -1.0e9;
  for (std::size_t i = 1; i + 1 < curve.time_s.size(); ++i) {
    if (curve.time_s[i] < from_s || curve.time_s[i] > to_s || sign * curve.height_m[i] < highest) continue;
    highest = sign * curve.height_m[i];
    best = i;
  }
  if (best == 0) return {0.0, 0.0};
  const double before = curve.height_m[best - 1], here = curve.height_m[best], after = curve.height_m[best + 1];
  const double curvature = before - 2.0 * here + after, slope = 0.5 * (after - before);
  const double shift = curvature == 0.0 ? 0.0 : -slope / curvature;
  return {curve.time_s[best] + shift * (curve.time_s[best + 1] - curve.time_s[best]), here + 0.5 * slope * shift};
}

Curve read_curve(const ExperimentContext& context, double until_s) {
  Curve curve;
  for (const ReferenceRow& row : read_reference(context.config_folder + "/reference", "r6_release")) {
    if (row.number("t_s") > until_s + 1e-9) break;
    curve.time_s.push_back(row.number("t_s"));
    curve.height_m.push_back(row.number("tip_uy_m"));
  }
  return curve;
}

Curve run(const ExperimentContext& context, const ReleaseProblem& release, const std::string& integrator,
          ReleaseRun& result) {
  const Overrides overrides = Overrides()
                                  .set({"body", "element_size_m"}, release.element_size_m)
                                  .set({"body", "material", "poissons_ratio"}, kPoissonsRatio)
                                  .set({"solver", "integrator"}, integrator)
                                  .set({"solver", "time_step_s"}, result.step_s);
  const Scene scene = load_scene(release.scene, context.scene_options(overrides));
  Simulation& simulation = *scene.simulation;
  const double rest_m = simulation.markers().at(0).rest_position_m().y();
  Curve curve{{0.0}, {0.0}};
  const double start_s = cpu_time_s();
  const long steps = std::lround(release.duration_s / result.step_s);
  for (long i = 0; i < steps; ++i) {
    result.converged = simulation.step().converged && result.converged;
    curve.time_s.push_back(simulation.state().time_s);
    curve.height_m.push_back(simulation.marker_position(0).y() - rest_m);
  }
  result.cost = (cpu_time_s() - start_s) / release.duration_s;
  return curve;
}

}  // namespace

std::vector<ReleaseRun> run_releases(const ExperimentContext& context, const ReleaseProblem& release) {
  const Curve reference = read_curve(context, release.duration_s);
  const auto lowest = extremum(reference, 0.0, kTopAfter_s, -1.0);
  const auto top = extremum(reference, kTopAfter_s, kSecondFall_s, 1.0);
  std::vector<ReleaseRun> runs;
  for (const ReleaseRung& rung : release.rungs) {
    for (const double step_s : rung.steps_s) {
      ReleaseRun result{rung.name, step_s};
      const Curve curve = run(context, release, rung.integrator, result);
      for (std::size_t i = 0; i < reference.time_s.size(); ++i) {
        const double difference_m = std::abs(height_at(curve, reference.time_s[i]) - reference.height_m[i]);
        result.error = std::max(result.error, difference_m / std::abs(lowest.second));
      }
      result.minimum_error = std::abs(extremum(curve, 0.0, kTopAfter_s, -1.0).second / lowest.second - 1.0);
      result.period_error = std::abs(extremum(curve, kTopAfter_s, kSecondFall_s, 1.0).first / top.first - 1.0);
      runs.push_back(result);
    }
  }
  return runs;
}

Plot plot_releases(const std::vector<ReleaseRun>& runs) {
  Plot plot{"release_time_step", "Release of a bar (R6): error of the tip's first minimum over time step", {}, {}};
  plot.x = {"time step [ms]", true};
  plot.y = {"error of the first minimum [%]", true};
  for (const ReleaseRun& run : runs) {
    if (plot.series.empty() || plot.series.back().label != run.rung) plot.series.push_back({run.rung, {}, {}});
    plot.series.back().x.push_back(1.0e3 * run.step_s);
    plot.series.back().y.push_back(std::max(1.0e2 * run.minimum_error, 1.0e-3));
  }
  return plot;
}

}  // namespace soft_robot_lab
