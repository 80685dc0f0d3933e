// SPDX-License-Identifier: BSD-3-Clause
// optimise ROBOT.yaml --marker NAME --target X Y Z: finds a policy from the shell, without a ROS master.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "robot/scene/parameters.h"
#include "robot/scene/reduction.h"
#include "settings/command_line.h"
#include "settings/interrupted.h"
#include "settings/words.h"
#include "load_with_bar.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/control/find_policy.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "soft_robot_lab/robot/scene/scene_file.h"
#ifdef SOFT_ROBOT_LAB_ROBUST
#include "study/robust/robust_policy.h"
#include "study/robust/robust_report.h"
#endif

namespace {

using namespace soft_robot_lab;

struct Arguments {
  std::string robot, result, policy, replay, robust, output;
  std::optional<double> quantile, tolerance_m;
  std::vector<std::string> set;
  PolicyTask task;
  OptimiserOptions options;
  double duration_s = 2.0;
  double max_tension_n = std::numeric_limits<double>::infinity();
  double max_rate_per_s = std::numeric_limits<double>::infinity();
};

MarkerGoal& last_goal(Arguments& arguments, const std::string& option) {
  if (arguments.task.poses.back().goals.empty()) throw WrongArgument(option, "comes after its --marker");
  return arguments.task.poses.back().goals.back();
}

// What may be repeated, in order.
void declare_task(CommandLine& app, Arguments& arguments) {
  arguments.task.poses.resize(1);
  const auto add_marker = [&arguments](const std::string& name) {
    arguments.task.poses.back().goals.push_back({name, Eigen::Vector3d::Constant(std::nan("")), 1.0});
  };
  const auto set_target = [&arguments](const std::vector<double>& target_m) {
    last_goal(arguments, "--target").target_m = Eigen::Vector3d(target_m[0], target_m[1], target_m[2]);
  };
  const auto set_weight = [&arguments](const double& weight) { last_goal(arguments, "--weight").weight = weight; };
  const std::string group = "Task, in this order; can be repeated";
  app.add_option_function<std::string>("--marker", add_marker, "what to bring to a target")
      .type_name("NAME")
      .required()
      .in_order()
      .group(group);
  app.add_option_function<std::vector<double>>("--target", set_target, "where to bring it [m, robot_base]")
      .type_name("X Y Z")
      .expected(3)
      .in_order()
      .group(group);
  app.add_option_function<double>("--weight", set_weight, "of this marker among several (1)")
      .type_name("W")
      .in_order()
      .group(group);
  app.add_flag_callback(
         "--then", [&arguments] { arguments.task.poses.emplace_back(); }, "begins the next pose of a path")
      .in_order()
      .group(group);
}

void declare(CommandLine& app, Arguments& arguments) {
  OptimiserOptions& options = arguments.options;
  app.add_option("ROBOT", arguments.robot, "a scene's or robot's file").type_name("FILE").required();
  declare_task(app, arguments);
  app.add_option("--duration", arguments.duration_s, "of the way to a pose").type_name("S").show_default();
  app.add_option("--max-tension", arguments.max_tension_n, "limit of every actuator").type_name("N");
  app.add_option("--max-rate", arguments.max_rate_per_s, "limit of every actuator's command per second").type_name("R");
  app.add_option("--effort", arguments.task.effort_m, "what distance a unit of command away from rest is worth")
      .type_name("M");
  app.add_option("--method", options.method, join(optimiser_methods())).type_name("METHOD").show_default();
  app.add_option("--tolerance", arguments.tolerance_m,
                 "distance within which a target counts as reached, and the search ends (0.0005, and on to 0.00001)")
      .type_name("M");
  app.add_option("--iterations", options.max_iterations, "of the method, at most").type_name("N");
  app.add_option("--seed", options.seed, "of methods with random numbers").type_name("N").show_default();
  app.add_option("--robust", arguments.robust, "do well on the robots that this file draws, or replay on them")
      .type_name("FILE");
  app.add_option("--quantile", arguments.quantile,
                 "of their distances, which is to be small; otherwise their mean square (--robust)")
      .type_name("Q");
  app.add_option("--output", arguments.output, "the folder of robots.csv and report.html (--robust)")
      .type_name("FOLDER");
  app.add_set_option(arguments.set);
  app.add_option("--result", arguments.result, "where the answer goes as JSON").type_name("FILE");
  app.add_option("--policy", arguments.policy, "where the policy goes as YAML").type_name("FILE");
  app.add_option("--replay", arguments.replay, "show where this policy takes the markers, and search nothing")
      .type_name("FILE");
  app.footer(
      "Ctrl-C keeps the best so far. Exit status: 0 an answer was found, 1 it stopped early, 2 bad robot or "
      "arguments.");
}

nlohmann::ordered_json array_of(const Eigen::VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

nlohmann::ordered_json json_of(const OptimisationSummary& summary, const Pose& pose) {
  nlohmann::ordered_json result;
  result["usable"] = summary.usable;
  result["stop_reason"] = summary.stop_reason;
  result["target_reached"] = summary.target_reached;
  result["initial_distance_m"] = summary.initial_distance_m;
  result["final_distance_m"] = summary.final_distance_m;
  for (Eigen::Index k = 0; k < summary.markers_m.cols(); ++k)
    result["nearest_m"][pose.goals[static_cast<size_t>(k)].marker] = array_of(summary.markers_m.col(k));
  result["active_limits"] = summary.active_limits;
  result["iterations"] = summary.iterations;
  result["evaluations"] = summary.evaluations;
  result["cpu_s"] = summary.cpu_s;
  return result;
}

void print(const OptimisationSummary& summary, const Pose& pose) {
  std::printf("%s: %.3f mm before, %.3f mm after %d iterations, %d equilibria, %.2f s CPU\n",
              summary.stop_reason.c_str(), 1e3 * summary.initial_distance_m, 1e3 * summary.final_distance_m,
              summary.iterations, summary.evaluations, summary.cpu_s);
  for (Eigen::Index k = 0; k < summary.markers_m.cols(); ++k) {
    const Eigen::Vector3d at_mm = 1e3 * summary.markers_m.col(k);
    std::printf("  %s rests at (%.2f, %.2f, %.2f) mm\n", pose.goals[static_cast<size_t>(k)].marker.c_str(), at_mm.x(),
                at_mm.y(), at_mm.z());
  }
  if (!summary.target_reached && summary.usable)
    std::printf("  the target was not reached: that is the nearest found\n");
  for (const std::string& limit : summary.active_limits) std::printf("  limit: %s\n", limit.c_str());
}

int replay_policy(const Arguments& arguments, Simulation& simulation) {
  const CommandPolicy policy = load_policy(arguments.replay);
  validate(policy, limits_of(simulation));
  const std::vector<MarkerGoal>& goals = arguments.task.poses.front().goals;
  std::vector<std::string> markers;
  for (const MarkerGoal& goal : goals) markers.push_back(goal.marker);
  simulation.solve_equilibrium();
  const std::vector<Eigen::Matrix3Xd> places = replay(simulation, policy, markers);
  nlohmann::ordered_json result;
  for (size_t step = 0; step < places.size(); ++step) {
    for (size_t k = 0; k < goals.size(); ++k) {
      const Eigen::Vector3d at_m = places[step].col(static_cast<Eigen::Index>(k));
      std::printf("%g s: %s rests at (%.2f, %.2f, %.2f) mm", policy.steps[step].time_s, markers[k].c_str(),
                  1e3 * at_m.x(), 1e3 * at_m.y(), 1e3 * at_m.z());
      if (goals[k].target_m.allFinite())
        std::printf(", %.3f mm from its target", 1e3 * (at_m - goals[k].target_m).norm());
      std::printf("\n");
      result["steps"][step][markers[k]] = array_of(at_m);
    }
  }
  if (!arguments.result.empty()) write_file(arguments.result, result.dump(2) + "\n");
  return kGood;
}

void require_targets(const PolicyTask& task) {
  for (const Pose& pose : task.poses)
    for (const MarkerGoal& goal : pose.goals)
      if (!goal.target_m.allFinite())
        throw std::invalid_argument("--target: marker " + goal.marker +
                                    " has none; give `--target X Y Z` [m] after its --marker");
}

PolicyTask complete(const Arguments& arguments, const Simulation& simulation) {
  PolicyTask task = arguments.task;
  for (Pose& pose : task.poses) pose.duration_s = arguments.duration_s;
  if (std::isinf(arguments.max_tension_n) && std::isinf(arguments.max_rate_per_s)) return task;
  for (const auto& actuator : simulation.actuators())
    task.bounds.push_back({actuator->name(), actuator->limits().min, actuator->limits().max, arguments.max_tension_n,
                           arguments.max_rate_per_s});
  return task;
}

#ifdef SOFT_ROBOT_LAB_ROBUST
CommandPolicy policy_for(const Arguments& arguments, std::vector<RandomRobot>& robots, const PolicyTask& task) {
  if (!arguments.replay.empty()) {
    const CommandPolicy policy = load_policy(arguments.replay);
    validate(policy, limits_of(*robots.front().simulation));
    return policy;
  }
  RobustOptions options;
  options.quantile = arguments.quantile;
  options.optimiser = arguments.options;
  ProgressBar bar("optimise");
  const PolicyAnswer answer = find_robust_policy(robots, task, options, [&](const OptimisationProgress& now) {
    bar.show(0.5, "iteration " + std::to_string(now.iteration));
    return !interrupted();
  });
  if (!answer.success) throw std::runtime_error(answer.summaries.front().stop_reason);
  return answer.policy;
}

int optimise_on_random_robots(const Arguments& arguments, const SceneOptions& options, const PolicyTask& task) {
  const Randomisation randomisation = read_randomisation(arguments.robust, arguments.robot);
  std::vector<RandomRobot> robots = draw_robots(randomisation, options);
  for (const RandomRobot& robot : robots) robot.simulation->set_interrupt(interrupted);
  CommandPolicy policy = policy_for(arguments, robots, task);
  policy.robot = name_of_robot(arguments.robot);
  const std::vector<double> distances = distances_m(robots, policy, task.poses.back());
  std::cout << robust_summary(distances);
  if (!arguments.output.empty()) write_robust_report(randomisation, robots, distances, arguments.output);
  if (!arguments.policy.empty()) write_file(arguments.policy, policy_yaml(policy));
  if (!arguments.result.empty())
    write_file(arguments.result, nlohmann::ordered_json({{"distances_m", distances}}).dump(2) + "\n");
  return kGood;
}
#else
int optimise_on_random_robots(const Arguments&, const SceneOptions&, const PolicyTask&) {
  throw std::invalid_argument("--robust: this build has no studies (SOFT_ROBOT_LAB_STUDY)");
}
#endif

// With the scene's reduced model where it has one.
PolicyAnswer find_with_bar(const Arguments& arguments, const Scene& scene, const PolicyTask& task) {
  ProgressBar bar("optimise");
  double first_m = 0.0;
  return find_policy(
      *scene.simulation, task, arguments.options,
      [&](size_t pose, const auto&, const OptimisationProgress& now) {
        first_m = now.iteration == 1 ? now.distance_m : first_m;
        const double come = first_m > 0.0 ? 1.0 - now.distance_m / first_m : 1.0;
        std::ostringstream text;
        text.precision(3);
        text << "pose " << pose + 1 << ", iteration " << now.iteration << ", " << 1e3 * now.distance_m << " mm";
        bar.show(come, text.str());
        return !interrupted();
      },
      scene.reduction ? &scene.reduction->choice : nullptr);
}

// Prints each pose too.
nlohmann::ordered_json show_answer(const PolicyAnswer& answer, const PolicyTask& task) {
  nlohmann::ordered_json result;
  for (size_t i = 0; i < answer.summaries.size(); ++i) {
    print(answer.summaries[i], task.poses[i]);
    result["poses"].push_back(json_of(answer.summaries[i], task.poses[i]));
    if (answer.full_because.empty()) continue;
    result["poses"].back()["searched_on"] = answer.full_because[i].empty() ? "reduced" : "newton";
    if (answer.full_because[i].empty()) continue;
    result["poses"].back()["not_on_reduced"] = answer.full_because[i];
    std::cerr << "optimise: warning: newton searched, as " << answer.full_because[i] << "\n";
  }
  result["policy"]["names"] = answer.policy.names;
  for (const TimedCommandValues& step : answer.policy.steps)
    result["policy"]["steps"].push_back({{"time_s", step.time_s}, {"values", step.values}});
  return result;
}

Scene load_to_optimise(const Arguments& arguments, const SceneOptions& scene_options) {
  Scene scene = load_with_bar("optimise", arguments.robot, scene_options);
  if (arguments.robust.empty() && (arguments.quantile || !arguments.output.empty()))
    throw std::invalid_argument("--quantile and --output belong to --robust");
  for (const std::string& warning : far_targets(*scene.simulation, arguments.task))
    std::cerr << "optimise: warning: " << warning << ": targets are in metres; are these numbers millimetres?\n";
  heed_interrupts();
  scene.simulation->set_interrupt(interrupted);
  return scene;
}

int optimise_robot(Arguments& arguments) {
  if (arguments.tolerance_m) arguments.options.tolerance_m = *arguments.tolerance_m;
  arguments.options.validate();
  if (arguments.replay.empty()) require_targets(arguments.task);
  SceneOptions scene_options;
  scene_options.actuator_factory = make_actuator;
  scene_options.overrides = parameter_overrides(arguments.robot, arguments.set);
  const Scene scene = load_to_optimise(arguments, scene_options);
  if (!arguments.robust.empty())
    return optimise_on_random_robots(arguments, scene_options, complete(arguments, *scene.simulation));
  if (!arguments.replay.empty()) return replay_policy(arguments, *scene.simulation);
  const PolicyTask task = complete(arguments, *scene.simulation);
  PolicyAnswer answer = find_with_bar(arguments, scene, task);
  answer.policy.robot = name_of_robot(arguments.robot);
  if (!arguments.tolerance_m) count_as_reached(answer);
  const nlohmann::ordered_json result = show_answer(answer, task);
  if (!arguments.result.empty()) write_file(arguments.result, result.dump(2) + "\n");
  if (!arguments.policy.empty() && !answer.policy.steps.empty())
    write_file(arguments.policy, policy_yaml(answer.policy));
  return answer.success && !interrupted() ? kGood : kNotGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Finds the commands that bring markers to targets, or shows where a policy takes them, without a ROS master.",
      "optimise");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return optimise_robot(arguments); });
}
