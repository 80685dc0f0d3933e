// SPDX-License-Identifier: BSD-3-Clause
// The file of a learning task (config/README.md, "Learning task"), and the robots that it draws, for environment.py.
#include <filesystem>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "bindings.h"
#include "python_overrides.h"
#include "robot/scene/parameters.h"
#include "settings/limits.h"
#include "settings/named_file.h"
#ifdef SOFT_ROBOT_LAB_ROBUST
#include "study/robust/random_robots.h"
#endif

namespace soft_robot_lab {
namespace py = pybind11;
namespace {

namespace fs = std::filesystem;

constexpr double kMostRate_hz = 10000.0;
constexpr int kMostTargets = 10000;
constexpr int kLargestSeed = 1000000;

AllowedRange up_to(double most) { return {0.0, most, true, false}; }

py::array_t<double> point_array(const Eigen::Vector3d& point_m) { return points_array(point_m).attr("reshape")(3); }

Eigen::Vector3d point_of(const YamlNode& list) {
  const Eigen::VectorXd numbers = list.as_numbers();
  if (numbers.size() != 3) list.fail("has " + std::to_string(numbers.size()) + " numbers, must be [x, y, z]");
  return numbers;
}

py::dict read_targets(const YamlNode& targets) {
  py::dict all;
  if (targets.has("points_m") + targets.has("min_m") + targets.has("reachable") != 1)
    targets.fail("must have one of points_m, min_m with max_m, and reachable");
  if (targets.has("points_m")) {
    const std::vector<YamlNode> points = targets.sequence("points_m");
    if (points.empty()) targets.fail("points_m: is empty; must have at least one point");
    Eigen::Matrix3Xd points_m(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) points_m.col(static_cast<Eigen::Index>(i)) = point_of(points[i]);
    all["points_m"] = points_array(points_m);
  } else if (targets.has("min_m")) {
    const Eigen::Vector3d min_m = targets.vector3("min_m"), max_m = targets.vector3("max_m");
    if ((min_m.array() > max_m.array()).any()) targets.fail("min_m must not be above max_m");
    all["min_m"] = point_array(min_m);
    all["max_m"] = point_array(max_m);
  } else {
    all["reachable"] = targets.integer("reachable", 1, kMostTargets);
  }
  return all;
}

py::dict read_path(const std::vector<YamlNode>& points) {
  std::vector<double> times_s;
  Eigen::Matrix3Xd points_m(3, static_cast<Eigen::Index>(points.size()));
  for (const YamlNode& point : points) {
    const double time_s = point.number("time_s", {0.0, limits::kTime_s});
    if (!times_s.empty() && !(time_s > times_s.back())) point.fail("time_s: must be after the point before");
    points_m.col(static_cast<Eigen::Index>(times_s.size())) = point.vector3("position_m");
    times_s.push_back(time_s);
  }
  py::dict all;
  all["time_s"] = numbers_array(times_s);
  all["position_m"] = points_array(points_m);
  return all;
}

void read_goal(const YamlNode& file, py::dict& task) {
  const std::string kind = file.text("task");
  if (kind == "grasp" || kind == "push")
    file.child("task").fail("'" + kind + "' is not there yet; must be one of reach, track");
  task["task"] = file.choice("task", {"reach", "track"});
  if (kind == "reach") {
    task["targets"] = read_targets(file.child("targets"));
    return;
  }
  const std::vector<YamlNode> path = file.sequence("path");
  if (path.empty()) file.child("path").fail("is empty; must have at least one point");
  task["path"] = read_path(path);
}

void read_action(const YamlNode& file, py::dict& task) {
  const auto action = file.optional_child("action");
  const std::string kind = action ? action->choice_or("kind", "change", {"change", "command"}) : "change";
  task["action"] = kind;
  task["largest_change"] = action && kind == "change" ? action->number_or("largest_change", 0.1, up_to(1.0)) : 1.0;
  if (!action) task["largest_change"] = 0.1;
  py::dict ranges;
  if (const auto limits = action ? action->optional_child("limits") : std::nullopt)
    for (const std::string& name : limits->keys()) {
      const YamlNode list = limits->child(name);
      const Eigen::VectorXd range = list.as_numbers();
      if (range.size() != 2 || !(range[0] < range[1])) list.fail("must be [least, largest]");
      ranges[py::str(name)] = py::make_tuple(range[0], range[1]);
    }
  task["limits"] = ranges;
}

void read_observation(const YamlNode& file, py::dict& task) {
  const auto observation = file.optional_child("observation");
  const std::vector<std::string> kinds = {"markers", "markers_and_tensions"};
  task["observation"] = observation ? observation->choice_or("kind", kinds[0], kinds) : kinds[0];
  task["noise_m"] = observation ? observation->number_or("noise_m", 0.0, {0.0, 1.0}) : 0.0;
}

void read_reward(const YamlNode& file, py::dict& task) {
  const auto reward = file.optional_child("reward");
  const AllowedRange range{0.0, limits::kWeight};
  const auto weight = [&](const std::string& key, double otherwise) {
    return reward ? reward->number_or(key, otherwise, range) : otherwise;
  };
  task["distance_per_m"] = weight("distance_per_m", 100.0);
  task["change"] = weight("change", 0.0);
  task["within"] = weight("within", 0.0);
}

void read_random(const YamlNode& file, py::dict& task) {
  const auto random = file.optional_child("randomisation");
  task["randomisation"] = py::none();
  if (!random) return;
  py::dict all;
  all["file"] = named_file(random->child("file"));
  all["samples"] = random->integer_or("samples", 0, 1, kMostTargets);
  all["seed"] = random->integer_or("seed", 0, 1, kLargestSeed);
  task["randomisation"] = all;
}

py::dict read_learning_task(const fs::path& path, const std::optional<py::dict>& overrides) {
  YamlNode file = load_settings(path.string());
  if (overrides) file = python_overrides(path.string(), *overrides).over(file);
  py::dict task;
  task["robot"] = named_file(file.child("robot"));
  task["method"] = py::none();
  if (file.has("method")) task["method"] = file.choice("method", {"newton", "xpbd", "reduced"});
  task["marker"] = file.text("marker");
  read_goal(file, task);
  task["control_rate_hz"] = file.number("control_rate_hz", up_to(kMostRate_hz));
  task["steps"] = file.integer_or("steps", 2, 1, 1000);
  task["episode_s"] = file.number("episode_s", up_to(limits::kTime_s));
  task["within_m"] = file.number_or("within_m", 1e-3, up_to(limits::kPlace_m));
  task["seed"] = file.integer_or("seed", 1, 1, kLargestSeed);
  read_action(file, task);
  read_observation(file, task);
  read_reward(file, task);
  read_random(file, task);
  file.require_all_read();
  return task;
}

#ifdef SOFT_ROBOT_LAB_ROBUST
// For each robot a dict by parameter.
py::list draw_robots_of(const fs::path& path, const fs::path& robot, int samples, int seed) {
  Randomisation random = read_randomisation(path.string(), robot.string());
  if (samples > 0) random.study.samples = samples;
  if (seed > 0) random.study.seed = seed;
  const std::vector<std::string> names = names_of(random);
  py::list robots;
  for (const std::vector<double>& values : values_of(random)) {
    py::dict one;
    for (std::size_t i = 0; i < names.size(); ++i) one[py::str(names[i])] = values[i];
    robots.append(one);
  }
  return robots;
}
#else
py::list draw_robots_of(const fs::path&, const fs::path&, int, int) {
  throw std::invalid_argument("randomisation: this build has no studies (SOFT_ROBOT_LAB_STUDY)");
}
#endif

}  // namespace

void bind_learning_task(py::module_& module) {
  module.def("_read_learning_task", &read_learning_task, py::arg("path"), py::arg("overrides") = py::none(),
             "_read_learning_task(path, overrides=None)\n--\n\nA dict of what the file says, with its defaults.");
  module.def("_draw_robots", &draw_robots_of, py::arg("path"), py::arg("robot"), py::arg("samples"), py::arg("seed"),
             "_draw_robots(path, robot, samples, seed)\n--\n\n"
             "Of each robot that a randomisation draws a dict of its values by parameter; 0 is the file's own.");
}

}  // namespace soft_robot_lab
