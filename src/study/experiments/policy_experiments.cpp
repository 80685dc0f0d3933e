// SPDX-License-Identifier: BSD-3-Clause
// 7.3.1: the source's descent on ten random targets, and all other methods beside it.
#include "policy_experiments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "policy_run.h"

namespace soft_robot_lab {
namespace {

nlohmann::ordered_json json_of(const PolicyRun& run) {
  return {{"start_distance_m", run.summary.initial_distance_m},
          {"final_distance_m", run.summary.final_distance_m},
          {"iterations", run.summary.iterations},
          {"cpu_s", run.summary.cpu_s},
          {"evaluations", run.summary.evaluations},
          {"reversals", run.reversals},
          {"turns", run.turns()},
          {"largest_rise_m", run.largest_rise_m()},
          {"usable", run.summary.usable},
          {"stop_reason", run.summary.stop_reason}};
}

double start_m(const TargetRuns& target) { return target.runs.front().summary.initial_distance_m; }

Plot convergence_plot(const TargetRuns& target) {
  std::ostringstream title;
  title.precision(3);
  title << "Target " << target.target.name << ", " << 1e3 * start_m(target) << " mm away at the start, all methods";
  Plot plot{"7.3.1_" + target.target.name, title.str(), {}, {}, {}};
  plot.x.label = "CPU time [s]";
  plot.x.logarithmic = true;
  plot.y.label = "distance [mm]";
  plot.y.logarithmic = true;
  for (const PolicyRun& run : target.runs) {
    Series series{run.method, {}, {}, SeriesStyle::lines};
    for (size_t i = 0; i < run.distance_m.size(); ++i) {
      series.x.push_back(std::max(run.cpu_s[i], 1.0e-3));
      series.y.push_back(1e3 * std::max(run.distance_m[i], 1.0e-7));
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

ExperimentResult tables_and_plots(const std::vector<TargetRuns>& all) {
  ExperimentResult result;
  result.table.columns = {
      {"target"},        {"method"},     {"start [mm]", 3},         {"distance [mm]"},         {"iterations"},
      {"equilibria"},    {"CPU [s]", 3}, {"turns of the commands"}, {"turns of the distance"}, {"largest rise [mm]", 3},
      {"why it stopped"}};
  for (const TargetRuns& target : all) {
    for (const PolicyRun& run : target.runs)
      result.table.rows.push_back({target.target.name, run.method, 1e3 * start_m(target),
                                   1e3 * run.summary.final_distance_m, double(run.summary.iterations),
                                   double(run.summary.evaluations), run.summary.cpu_s, double(run.reversals),
                                   double(run.turns()), 1e3 * run.largest_rise_m(), run.summary.stop_reason});
    result.plots.push_back(convergence_plot(target));
  }
  return result;
}

// CPU of rmsprop over that in which gauss_newton came as near as rmsprop's last iterate, within the methods' tolerance:
// of all its iterations, and of those until it was there itself. Nothing where gauss_newton never came as near. (What
// rmsprop found best may be a probe for a difference, where no iterate ever was.)
struct CpuRatios {
  double whole = 0.0, until_there = 0.0;
};

std::optional<CpuRatios> cpu_ratios(const PolicyRun& newton, const PolicyRun& rmsprop) {
  if (rmsprop.distance_m.empty()) return std::nullopt;
  const double near_m = rmsprop.distance_m.back() + OptimiserOptions{}.tolerance_m;
  const std::optional<double> newton_s = newton.cpu_until_s(near_m), rmsprop_s = rmsprop.cpu_until_s(near_m);
  if (!newton_s || !rmsprop_s) return std::nullopt;
  return CpuRatios{rmsprop.summary.cpu_s / *newton_s, *rmsprop_s / *newton_s};
}

std::string compare_gauss_newton(const std::vector<TargetRuns>& all, ExperimentResult& result) {
  constexpr double none = std::numeric_limits<double>::infinity();
  double worst_m = 0.0, slowest_s = 0.0;
  CpuRatios least{none, none};
  nlohmann::ordered_json of_targets;
  for (const TargetRuns& target : all) {
    const PolicyRun *newton = find(target, "gauss_newton"), *rmsprop = find(target, "rmsprop");
    if (!newton) return "";
    double best_m = newton->summary.final_distance_m;
    for (const PolicyRun& run : target.runs)
      if (run.summary.usable) best_m = std::min(best_m, run.summary.final_distance_m);
    worst_m = std::max(worst_m, newton->summary.final_distance_m - best_m);
    slowest_s = std::max(slowest_s, newton->summary.cpu_s);
    const std::optional<CpuRatios> ratios = rmsprop ? cpu_ratios(*newton, *rmsprop) : std::nullopt;
    of_targets.push_back(nullptr);
    if (!ratios) continue;
    of_targets.back() = {{"whole", ratios->whole}, {"until_there", ratios->until_there}};
    least = {std::min(least.whole, ratios->whole), std::min(least.until_there, ratios->until_there)};
  }
  result.numbers["rmsprop_over_gauss_newton_cpu"] = of_targets;
  std::ostringstream text;
  text.precision(3);
  text << "gauss_newton ends at most " << 1e3 * worst_m
       << " mm farther from a target than the best of all methods, and takes at most " << slowest_s << " s CPU. ";
  if (std::isfinite(least.whole))
    text << "rmsprop takes at least " << least.whole
         << " times the CPU in which gauss_newton was as near, and at least " << least.until_there
         << " times until it is there itself. ";
  return text.str();
}

// The source's picture: its descent alone, over iterations.
Plot descent_plot(const std::vector<TargetRuns>& all) {
  Plot plot{"7.3.1", "Descent as published (rmsprop), ten targets", {}, {}, {}};
  plot.x.label = "iterations";
  plot.y.label = "distance [mm]";
  plot.y.logarithmic = true;
  for (const TargetRuns& target : all) {
    const PolicyRun* run = find(target, "rmsprop");
    if (!run) continue;
    Series series{target.target.name, {0.0}, {1e3 * start_m(target)}, SeriesStyle::lines};
    for (size_t i = 0; i < run->distance_m.size(); ++i) {
      series.x.push_back(static_cast<double>(i) + 1.0);
      series.y.push_back(1e3 * run->distance_m[i]);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

std::string report_descent(const std::vector<TargetRuns>& all) {
  double least_m = std::numeric_limits<double>::infinity(), most_m = 0.0;
  int stopped = 0, near = 0;
  for (const TargetRuns& target : all) {
    const PolicyRun* run = find(target, "rmsprop");
    if (!run) return "";
    least_m = std::min(least_m, run->last_m());
    most_m = std::max(most_m, run->last_m());
    stopped += run->summary.stop_reason == "converged";
    near += run->last_m() < 0.002;
  }
  std::ostringstream text;
  text.precision(3);
  text << "The source's descent ends " << 1e3 * least_m << " to " << 1e3 * most_m
       << " mm from its targets, within 2 mm of " << near << " of " << all.size() << "; " << stopped
       << " times both derivatives were below its tolerance. ";
  return text.str();
}

}  // namespace

ExperimentResult run_random_targets_experiment(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("7.3.1"));
  const MethodSettings settings = read_method_settings(node, context.config_folder);
  node.require_all_read();
  const std::vector<TargetRuns> all = run_all(settings, hang(settings.reach, context), context);
  ExperimentResult result = tables_and_plots(all);
  result.plots.insert(result.plots.begin(), descent_plot(all));
  result.title = "Ten random targets for Hammerbot's tip: descent as published, and all other methods";
  for (const TargetRuns& target : all) {
    nlohmann::ordered_json methods;
    for (const PolicyRun& run : target.runs) methods[run.method] = json_of(run);
    result.numbers["targets"].push_back(methods);
    const Eigen::Vector3d& at_m = target.target.position_m;
    result.numbers["target_places_m"].push_back({at_m.x(), at_m.y(), at_m.z()});
  }
  result.source_reports =
      "Steepest descent with RMSprop (0.9, 1e-6, 0.001), stopped at derivatives below 1e-4 or at 1000 iterations, "
      "takes "
      "Hammerbot's end point to ten random places in the plane of its cables, at least 25 mm from its centre. It "
      "converges "
      "between sub-linearly and linearly, which the source puts down to differences in place of derivatives, and is "
      "called "
      "well suited. Distances are drawn, not printed.";
  result.we_differ =
      "Its ten places and most of Hammerbot's dimensions are not printed: places are drawn by a seed of ours in a box "
      "of "
      "the same reach, and dimensions other than the cables' length are chosen, so that targets beyond this robot's "
      "reach "
      "need not be those beyond the source's.";
  result.we_find = report_descent(all) + compare_gauss_newton(all, result);
  return result;
}

}  // namespace soft_robot_lab
