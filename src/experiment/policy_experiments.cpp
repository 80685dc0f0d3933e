// 7.3.1: all methods on random targets. 7.3.2: how they converge on a near and a far one.
#include "experiment/policy_experiments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "experiment/policy_run.h"
#include "soft_robot_lab/actuators/factory.h"
#include "soft_robot_lab/scene/scene.h"

namespace soft_robot_lab {
namespace {

struct Target {
  std::string name;
  Eigen::Vector3d place_m;
};

struct PolicySettings {
  std::string robot, marker;
  std::vector<Target> targets;
  MethodIterations iterations;
};

struct TargetRuns {
  Target target;
  std::vector<PolicyRun> runs;  // in the order of the settings
};

// Evenly in the box, at least so far from the vertical through the origin. The engine's numbers are those of the C++
// standard, so that every machine draws the same.
std::vector<Target> draw_targets(const SettingsNode& node) {
  const int count = node.integer("count", 1, 1000);
  std::mt19937 engine(static_cast<unsigned int>(node.integer("seed", 0, std::numeric_limits<int>::max())));
  const Eigen::Vector3d min_m = node.vector3("min_m"), max_m = node.vector3("max_m");
  const double away_m = node.number("from_centre_line_m", AllowedRange::not_negative());
  if (away_m >= std::max(min_m.head<2>().cwiseAbs().maxCoeff(), max_m.head<2>().cwiseAbs().maxCoeff()))
    node.fail("from_centre_line_m: the box has no such places");
  std::vector<Target> targets;
  while (static_cast<int>(targets.size()) < count) {
    Eigen::Vector3d place_m;
    for (int axis = 0; axis < 3; ++axis)
      place_m[axis] = min_m[axis] + (max_m[axis] - min_m[axis]) * (engine() / 4294967296.0);
    if (place_m.head<2>().norm() >= away_m) targets.push_back({std::to_string(targets.size() + 1), place_m});
  }
  return targets;
}

std::vector<Target> named_targets(const SettingsNode& node) {
  std::vector<Target> targets;
  for (const std::string& name : node.keys()) targets.push_back({name, node.vector3(name)});
  return targets;
}

PolicySettings read_settings(const ExperimentContext& context, const std::string& name, bool random) {
  const SettingsNode node = SettingsNode::load_file(context.settings_file(name));
  PolicySettings settings;
  settings.robot = context.config_folder + "/" + node.text("robot");
  settings.marker = node.text("marker");
  settings.targets = random ? draw_targets(node.child("targets")) : named_targets(node.child("targets"));
  settings.iterations = read_iterations(node.child("iterations"));
  node.require_all_read();
  return settings;
}

std::vector<TargetRuns> run_all(const ExperimentContext& context, const PolicySettings& settings) {
  SceneOptions options;
  options.mesher = context.mesher;
  options.actuator_factory = make_actuator;
  const Scene scene = load_scene(settings.robot, options);
  scene.simulation->solve_equilibrium();
  const SimulationState hanging = scene.simulation->state();
  const double count = static_cast<double>(settings.targets.size() * settings.iterations.size());
  double done = 0.0;
  std::vector<TargetRuns> all;
  for (const Target& target : settings.targets) {
    all.push_back({target, {}});
    for (const auto& [method, iterations] : settings.iterations) {
      context.tell(done++ / count, "target " + target.name + ", " + method);
      const MarkerGoal goal{settings.marker, target.place_m, 1.0};
      all.back().runs.push_back(run_policy_method(*scene.simulation, hanging, goal, method, iterations));
    }
  }
  return all;
}

const PolicyRun* find(const TargetRuns& target, const std::string& method) {
  const auto found =
      std::find_if(target.runs.begin(), target.runs.end(), [&](const PolicyRun& run) { return run.method == method; });
  return found == target.runs.end() ? nullptr : &*found;
}

nlohmann::ordered_json json_of(const PolicyRun& run) {
  return {{"final_distance_m", run.summary.final_distance_m},
          {"iterations", run.summary.iterations},
          {"cpu_s", run.summary.cpu_s},
          {"evaluations", run.summary.evaluations},
          {"reversals", run.reversals},
          {"turns", run.turns()},
          {"largest_rise_m", run.largest_rise_m()},
          {"usable", run.summary.usable},
          {"stop_reason", run.summary.stop_reason}};
}

Plot convergence_plot(const std::string& name, const std::string& title, const TargetRuns& target) {
  Plot plot{name, title, {}, {}, {}};
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

ExperimentResult tables_and_plots(const std::string& name, const std::vector<TargetRuns>& all) {
  ExperimentResult result;
  result.table.columns = {{"target"},
                          {"method"},
                          {"distance [mm]"},
                          {"iterations"},
                          {"equilibria"},
                          {"CPU [s]", 3},
                          {"turns of the commands"},
                          {"turns of the distance"},
                          {"largest rise [mm]", 3},
                          {"why it stopped"}};
  for (const TargetRuns& target : all) {
    for (const PolicyRun& run : target.runs)
      result.table.rows.push_back({target.target.name, run.method, 1e3 * run.summary.final_distance_m,
                                   double(run.summary.iterations), double(run.summary.evaluations), run.summary.cpu_s,
                                   double(run.reversals), double(run.turns()), 1e3 * run.largest_rise_m(),
                                   run.summary.stop_reason});
    result.plots.push_back(
        convergence_plot(name + "_" + target.target.name, "Target " + target.target.name + ", all methods", target));
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

std::string tell_pid(const std::vector<TargetRuns>& all) {
  std::ostringstream text;
  text.precision(3);
  for (const TargetRuns& target : all) {
    const PolicyRun* pid = find(target, "pid");
    if (!pid || pid->distance_m.empty()) continue;
    text << (text.tellp() == 0 ? "With pid as published the distance to target " : ", to ") << target.target.name
         << ", " << 1e3 * pid->distance_m.front() << " mm at first, turns " << pid->turns()
         << " times and rises again by up to " << 1e3 * pid->largest_rise_m() << " mm";
  }
  return text.tellp() == 0 ? "" : text.str() + ".";
}

}  // namespace

ExperimentResult run_random_targets_experiment(const ExperimentContext& context) {
  const std::vector<TargetRuns> all = run_all(context, read_settings(context, "7.3.1", true));
  ExperimentResult result = tables_and_plots("7.3.1", all);
  result.title = "Random targets for Hammerbot's tip, all methods";
  for (const TargetRuns& target : all) {
    nlohmann::ordered_json methods;
    for (const PolicyRun& run : target.runs) methods[run.method] = json_of(run);
    result.numbers["targets"].push_back(methods);
    const Eigen::Vector3d& at_m = target.target.place_m;
    result.numbers["target_places_m"].push_back({at_m.x(), at_m.y(), at_m.z()});
  }
  result.source_reports =
      "The source reaches for ten random targets at least 25 mm from Hammerbot's centre, with RMSprop and PID; PID "
      "oscillates for far targets. Its draws are not known here.";
  result.we_find = compare_gauss_newton(all, result) + tell_pid(all);
  return result;
}

ExperimentResult run_convergence_experiment(const ExperimentContext& context) {
  const std::vector<TargetRuns> all = run_all(context, read_settings(context, "7.3.2", false));
  ExperimentResult result = tables_and_plots("7.3.2", all);
  result.title = "How the methods converge on a near and a far target";
  for (const TargetRuns& target : all)
    for (const PolicyRun& run : target.runs) result.numbers["targets"][target.target.name][run.method] = json_of(run);
  result.source_reports =
      "The source compares how its methods converge; what it varies is not known here. This is the comparison of all "
      "methods on one near and one far target, with their own settings.";
  result.we_find = compare_gauss_newton(all, result) + tell_pid(all);
  return result;
}

}  // namespace soft_robot_lab
