// SPDX-License-Identifier: BSD-3-Clause
// What the programs check_casting, make_mould, optimise and fit_model do, as functions.
#include <map>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "bindings.h"
#include "python_overrides.h"
#include "robot/casting/make_mould.h"
#include "robot/casting/mould_plan.h"
#include "robot/scene/reduction.h"
#include "soft_robot_lab/control/find_policy.h"
#include "soft_robot_lab/control/identification/fit_model.h"
#include "soft_robot_lab/robot/scene/scene_file.h"

namespace soft_robot_lab {
namespace py = pybind11;
namespace {

using File = std::filesystem::path;
using OptionalDict = std::optional<py::dict>;

py::object from_json(const std::string& text) { return py::module_::import("json").attr("loads")(text); }

py::object check_casting_of(const File& path, const OptionalDict& overrides, bool surface_alone) {
  Guarded guard;
  const SceneOptions options = options_for_python(guard, path, overrides);
  return from_json(guard.beside([&] {
    const auto load = surface_alone ? load_cast_surface : load_cast_robot_in_use;
    const CastRobotFile file = load(path, options);
    return verdict_json(with_allowed_moulds(file, check_casting(file)));
  }));
}

std::string made_mould(const File& path, const SceneOptions& options, const File& output,
                       const std::vector<std::string>& allow) {
  require_mould_folder(output);
  CastRobotFile file = load_cast_surface(path, options);
  for (const std::string& what : allow) {
    if (what != "lid" && what != "two_part")
      throw std::invalid_argument("allow: '" + what + "' is not one of two_part, lid");
    (what == "lid" ? file.settings.mould.allow_lid : file.settings.mould.allow_two_part) = true;
  }
  const Mould mould = make_mould(file);
  std::string faults;
  for (const std::string& fault : mould.faults) faults += (faults.empty() ? "" : " ") + fault;
  if (!faults.empty()) throw std::runtime_error(faults);
  write_mould(mould, robot_name(path), output);
  return mould_json(mould);
}

py::object make_mould_of(const File& path, const File& output, const std::vector<std::string>& allow,
                         const OptionalDict& overrides) {
  Guarded guard;
  const SceneOptions options = options_for_python(guard, path, overrides);
  return from_json(guard.beside([&] { return made_mould(path, options, output, allow); }));
}

Eigen::Vector3d point_of(const py::handle& given, const std::string& what) {
  const std::vector<double> numbers = numbers_of(given, 3, what);
  return {numbers[0], numbers[1], numbers[2]};
}

Pose pose_of(const py::dict& targets, double duration_s) {
  Pose pose;
  pose.duration_s = duration_s;
  for (const auto& [name, target] : targets) {
    const std::string marker = py::str(name).cast<std::string>();
    pose.goals.push_back({marker, point_of(target, "targets['" + marker + "']"), 1.0});
  }
  return pose;
}

PolicyTask task_of(const py::object& targets, double duration_s, double effort_m) {
  PolicyTask task;
  task.effort_m = effort_m;
  if (py::isinstance<py::dict>(targets)) {
    task.poses.push_back(pose_of(targets, duration_s));
    return task;
  }
  for (const py::handle& pose : targets.cast<py::iterable>()) {
    if (!py::isinstance<py::dict>(pose)) throw py::type_error("targets: must be a dict of markers, or a list of them");
    task.poses.push_back(pose_of(pose.cast<py::dict>(), duration_s));
  }
  return task;
}

py::array_t<double> vector_array(const Eigen::VectorXd& vector) {
  return numbers_array(std::vector<double>(vector.data(), vector.data() + vector.size()));
}

py::dict summary_dict(const OptimisationSummary& summary, const Pose& pose) {
  py::dict all;
  all["usable"] = summary.usable;
  all["stop_reason"] = summary.stop_reason;
  all["target_reached"] = summary.target_reached;
  all["initial_distance_m"] = summary.initial_distance_m;
  all["final_distance_m"] = summary.final_distance_m;
  py::dict nearest_m;
  for (Eigen::Index k = 0; k < summary.markers_m.cols(); ++k)
    nearest_m[py::str(pose.goals[static_cast<std::size_t>(k)].marker)] = vector_array(summary.markers_m.col(k));
  all["nearest_m"] = nearest_m;
  all["commands"] = vector_array(summary.commands);
  all["active_limits"] = summary.active_limits;
  all["iterations"] = summary.iterations;
  all["evaluations"] = summary.evaluations;
  return all;
}

py::dict answer_dict(const PolicyAnswer& answer, const PolicyTask& task) {
  py::dict all;
  all["success"] = answer.success;
  py::list poses, times_s, values;
  for (std::size_t i = 0; i < answer.summaries.size(); ++i)
    poses.append(summary_dict(answer.summaries[i], task.poses[i]));
  for (const TimedCommandValues& step : answer.policy.steps) {
    times_s.append(step.time_s);
    values.append(numbers_array(step.values));
  }
  all["poses"] = poses;
  all["names"] = answer.policy.names;
  all["time_s"] = times_s;
  all["values"] = values;
  all["policy_yaml"] = answer.policy.steps.empty() ? std::string() : policy_yaml(answer.policy);
  return all;
}

py::dict optimise_on(const File& path, const py::object& targets, const OptimiserOptions& options, double duration_s,
                     double effort_m, const OptionalDict& overrides) {
  Guarded guard;
  options.validate();
  const PolicyTask task = task_of(targets, duration_s, effort_m);
  const Scene scene = load_for_python(guard, path, overrides, std::nullopt);
  scene.simulation->set_interrupt([&guard] { return guard.watch().asked(); });
  PolicyAnswer answer = guard.beside([&] {
    return find_policy(
        *scene.simulation, task, options, [&](std::size_t, const auto&, const auto&) { return !guard.watch().asked(); },
        scene.reduction ? &scene.reduction->choice : nullptr);
  });
  answer.policy.robot = name_of_robot(path);
  return answer_dict(answer, task);
}

void bind_optimise(py::module_& module) {
  module.def(
      "optimise",
      [](const File& path, const py::object& targets, const std::string& method, double tolerance_m, int max_iterations,
         unsigned seed, double duration_s, double effort_m, const OptionalDict& overrides) {
        OptimiserOptions options;
        options.method = method;
        options.tolerance_m = tolerance_m;
        options.max_iterations = max_iterations;
        options.seed = seed;
        return optimise_on(path, targets, options, duration_s, effort_m, overrides);
      },
      py::arg("path"), py::arg("targets"), py::arg("method") = "gauss_newton", py::arg("tolerance_m") = 1e-5,
      py::arg("max_iterations") = 0, py::arg("seed") = 1, py::arg("duration_s") = 2.0, py::arg("effort_m") = 0.0,
      py::arg("overrides") = py::none(),
      "optimise(path, targets, method='gauss_newton', tolerance_m=1e-05, max_iterations=0, seed=1, duration_s=2.0, "
      "effort_m=0.0, "
      "overrides=None)\n--\n\n"
      "Commands that bring markers to targets, as the program optimise finds them. `targets` is {'tip': (x, y, z)} in "
      "metres, or\n"
      "a list of such dicts: a path. Returns a dict: success, poses (commands (actuators,), nearest_m, "
      "final_distance_m,\n"
      "stop_reason, ...), and the policy as names, time_s, values and policy_yaml. ValueError for a bad task.");
}

MeasuredPose measured_pose(const py::handle& given, double sigma_m) {
  if (!py::isinstance<py::tuple>(given) || py::len(given) != 2)
    throw py::type_error("poses: each must be a tuple of two dicts, commands and markers");
  const auto parts = given.cast<py::tuple>();
  MeasuredPose pose;
  for (const auto& [name, value] : parts[0].cast<py::dict>())
    pose.commands[py::str(name).cast<std::string>()] = python_number(value);
  for (const auto& [name, value] : parts[1].cast<py::dict>()) {
    const std::string marker = py::str(name).cast<std::string>();
    pose.markers.push_back({marker, point_of(value, "marker '" + marker + "'"),
                            Eigen::Matrix3d(sigma_m * sigma_m * Eigen::Matrix3d::Identity())});
  }
  return pose;
}

py::dict fit_dict(const FitResult& result) {
  py::dict all, values;
  for (const FittedValue& one : result.values) {
    py::dict value;
    value["start"] = one.start;
    value["value"] = one.value;
    value["deviation"] = one.deviation;
    value["low"] = one.low;
    value["high"] = one.high;
    value["identifiable"] = one.identifiable;
    values[py::str(one.name)] = value;
  }
  all["converged"] = result.converged;
  all["message"] = result.message;
  all["values"] = values;
  all["correlations"] = matrix_array(result.correlations);
  all["warnings"] = result.warnings;
  all["before_rms_m"] = result.before.rms_m;
  all["after_rms_m"] = result.after.rms_m;
  all["iterations"] = result.iterations;
  all["summary"] = summary(result);
  return all;
}

py::dict fit(const File& path, const py::iterable& poses, const std::vector<std::string>& parameters, double sigma_m,
             double model_error_m, const std::optional<File>& output, const OptionalDict& overrides) {
  Guarded guard;
  if (!(sigma_m > 0.0) || !(sigma_m < 1.0))
    throw std::invalid_argument("sigma_m: " + std::to_string(sigma_m) + " is out of range (0, 1)");
  if (output) {
    require_writable(*output);
    require_not_read(*output, path);
  }
  const SceneOptions options = options_for_python(guard, path, overrides);
  std::vector<MeasuredPose> measured;
  for (const py::handle& pose : poses) measured.push_back(measured_pose(pose, sigma_m));
  FitRequest request;
  for (const std::string& name : parameters) request.parameters.push_back({name, {}, {}, {}});
  request.model_error_m = model_error_m;
  request.progress = [&](int, double) { return !guard.watch().asked(); };
  const FitResult result = guard.beside([&] { return fit_model(path, options, measured, request); });
  if (output) write_fitted_scene(result, path, *output);
  return fit_dict(result);
}

void bind_casting(py::module_& module) {
  module.def("check_casting", &check_casting_of, py::arg("path"), py::arg("overrides") = py::none(),
             py::arg("surface_alone") = false,
             "check_casting(path, overrides=None, surface_alone=False)\n--\n\n"
             "Whether a robot can be cast in silicone: the dict that `check_casting --result` writes. `surface_alone` "
             "makes no mesh\n"
             "for simulations. Ctrl-C is heeded while it is meshed.");
  module.def("make_mould", &make_mould_of, py::arg("path"), py::arg("output"),
             py::arg("allow") = std::vector<std::string>(), py::arg("overrides") = py::none(),
             "make_mould(path, output, allow=[], overrides=None)\n--\n\n"
             "The mould of a robot, as STL, 3MF and STEP with instructions in the folder `output`; the dict of its "
             "mould.json.\n"
             "`allow` names two_part and lid. RuntimeError where there is no mould, with the reasons.");
}

}  // namespace

void bind_functions(py::module_& module) {
  bind_casting(module);
  bind_optimise(module);
  module.def(
      "fit", &fit, py::arg("path"), py::arg("poses"), py::arg("parameters"), py::arg("sigma_m") = 1e-4,
      py::arg("model_error_m") = 1e-4, py::arg("output") = py::none(), py::arg("overrides") = py::none(),
      "fit(path, poses, parameters, sigma_m=0.0001, model_error_m=0.0001, output=None, overrides=None)\n--\n\n"
      "Numbers of a scene that suit measured rest states. `poses` is a list of tuples of two dicts, commands by "
      "actuator and\n"
      "positions (3,) by marker, in the order of the measurement; `parameters` are names such as youngs_modulus_pa. "
      "Returns\n"
      "a dict: values (by name start, value, deviation, low, high, identifiable), after_rms_m, warnings, summary.\n"
      "`output` is a file for the fitted scene. ValueError: an unknown name, or too few data.");
}

}  // namespace soft_robot_lab
