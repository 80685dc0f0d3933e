// SPDX-License-Identifier: BSD-3-Clause
// optimise ROBOT.yaml --marker NAME --target X Y Z: finds a policy from the shell, without a ROS master.
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "settings/command_line.h"
#include "progress_bar.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/control/find_policy.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace {

using namespace soft_robot_lab;

constexpr const char* kUsage =
    "usage: optimise ROBOT.yaml (--marker NAME --target X Y Z [--weight W])... [--then (--marker ...)...]...\n"
    "                [--method METHOD] [--max-tension N] [--max-rate R] [--duration S] [--effort M]\n"
    "                [--tolerance M] [--iterations N] [--seed N] [--result FILE] [--policy FILE]\n"
    "       optimise ROBOT.yaml --replay POLICY.yaml --marker NAME [--target X Y Z] [--result FILE]\n"
    "Finds the commands that bring markers to targets [m, robot_base]; --then begins the next pose of a path. Writes "
    "the\n"
    "answer as JSON to --result and the policy as YAML to --policy; --replay shows where a policy takes the markers.\n"
    "Methods: gauss_newton (default), rmsprop, pid, pid_projected, cma_es, differential_evolution.\n"
    "Limits, of every actuator: --max-tension [N], --max-rate [command per second]; --duration [s] of a pose (2).\n"
    "Ctrl-C keeps the best so far. Exit status: 0 an answer was found, 1 it stopped early, 2 bad robot or arguments.\n";

volatile std::sig_atomic_t interrupted = 0;
void interrupt(int) { interrupted = 1; }

struct Arguments {
  std::string robot, result, policy, replay;
  PolicyTask task;
  OptimiserOptions options;
  double duration_s = 2.0;
  double max_tension_n = std::numeric_limits<double>::infinity();
  double max_rate_per_s = std::numeric_limits<double>::infinity();
  bool help = false;
};

double number(const std::string& option, const std::string& text) {
  size_t used = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
  }
  if (used == 0 || used != text.size()) throw std::invalid_argument(option + ": '" + text + "' is not a number");
  return value;
}

int whole_number(const std::string& option, const std::string& text) {
  const double value = number(option, text);
  if (value != static_cast<int>(value)) throw std::invalid_argument(option + ": '" + text + "' is not a whole number");
  return static_cast<int>(value);
}

MarkerGoal& last_goal(Arguments& arguments, const std::string& option) {
  if (arguments.task.poses.back().goals.empty()) throw std::invalid_argument(option + " comes after its --marker");
  return arguments.task.poses.back().goals.back();
}

Arguments parse(int count, char** values) {
  Arguments arguments;
  arguments.task.poses.resize(1);
  for (Words words(count, values); words.next();) {
    const std::string word = words.word();
    const auto next_number = [&] { return number(word, words.value()); };
    if (word == "-h" || word == "--help") {
      arguments.help = true;
    } else if (word == "--marker") {
      arguments.task.poses.back().goals.push_back({words.value(), Eigen::Vector3d::Constant(std::nan("")), 1.0});
    } else if (word == "--target") {
      MarkerGoal& goal = last_goal(arguments, word);
      for (int axis = 0; axis < 3; ++axis) goal.target_m[axis] = next_number();
    } else if (word == "--weight") {
      last_goal(arguments, word).weight = next_number();
    } else if (word == "--then") {
      arguments.task.poses.emplace_back();
    } else if (word == "--method") {
      arguments.options.method = words.value();
    } else if (word == "--max-tension") {
      arguments.max_tension_n = next_number();
    } else if (word == "--max-rate") {
      arguments.max_rate_per_s = next_number();
    } else if (word == "--duration") {
      arguments.duration_s = next_number();
    } else if (word == "--effort") {
      arguments.task.effort_m = next_number();
    } else if (word == "--tolerance") {
      arguments.options.tolerance_m = next_number();
    } else if (word == "--iterations") {
      arguments.options.max_iterations = whole_number(word, words.value());
    } else if (word == "--seed") {
      arguments.options.seed = static_cast<unsigned int>(whole_number(word, words.value()));
    } else if (word == "--result") {
      arguments.result = words.value();
    } else if (word == "--policy") {
      arguments.policy = words.value();
    } else if (word == "--replay") {
      arguments.replay = words.value();
    } else if (!word.empty() && word[0] == '-') {
      throw std::invalid_argument("unknown option " + word);
    } else if (arguments.robot.empty()) {
      arguments.robot = word;
    } else {
      throw std::invalid_argument("more than one robot: " + word);
    }
  }
  if (arguments.help) return arguments;
  if (arguments.robot.empty()) throw std::invalid_argument("no robot given");
  if (arguments.task.poses.front().goals.empty()) throw std::invalid_argument("no --marker given");
  arguments.options.validate();
  return arguments;
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

PolicyTask complete(const Arguments& arguments, const Simulation& simulation) {
  PolicyTask task = arguments.task;
  for (Pose& pose : task.poses) pose.duration_s = arguments.duration_s;
  if (std::isinf(arguments.max_tension_n) && std::isinf(arguments.max_rate_per_s)) return task;
  for (const auto& actuator : simulation.actuators())
    task.bounds.push_back({actuator->name(), actuator->limits().min, actuator->limits().max, arguments.max_tension_n,
                           arguments.max_rate_per_s});
  return task;
}

int optimise_robot(const Arguments& arguments) {
  SceneOptions scene_options;
  scene_options.actuator_factory = make_actuator;
  const Scene scene = load_scene(arguments.robot, scene_options);
  if (!arguments.replay.empty()) return replay_policy(arguments, *scene.simulation);
  const PolicyTask task = complete(arguments, *scene.simulation);
  std::signal(SIGINT, interrupt);
  PolicyAnswer answer;
  {
    ProgressBar bar("optimise");
    double first_m = 0.0;
    answer = find_policy(
        *scene.simulation, task, arguments.options, [&](size_t pose, const auto&, const OptimisationProgress& now) {
          first_m = now.iteration == 1 ? now.distance_m : first_m;
          const double come = first_m > 0.0 ? 1.0 - now.distance_m / first_m : 1.0;
          std::ostringstream text;
          text.precision(3);
          text << "pose " << pose + 1 << ", iteration " << now.iteration << ", " << 1e3 * now.distance_m << " mm";
          bar.show(come, text.str());
          return interrupted == 0;
        });
  }
  nlohmann::ordered_json result;
  for (size_t i = 0; i < answer.summaries.size(); ++i) {
    print(answer.summaries[i], task.poses[i]);
    result["poses"].push_back(json_of(answer.summaries[i], task.poses[i]));
  }
  result["policy"]["names"] = answer.policy.names;
  for (const TimedCommandValues& step : answer.policy.steps)
    result["policy"]["steps"].push_back({{"time_s", step.time_s}, {"values", step.values}});
  if (!arguments.result.empty()) write_file(arguments.result, result.dump(2) + "\n");
  if (!arguments.policy.empty() && !answer.policy.steps.empty())
    write_file(arguments.policy, policy_yaml(answer.policy));
  return answer.success && interrupted == 0 ? kGood : kNotGood;
}

}  // namespace

int main(int argc, char** argv) { return run_program("optimise", kUsage, argc, argv, parse, optimise_robot); }
