// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "arrays.h"
#include "bindings.h"
#include "python_simulation.h"

namespace soft_robot_lab {
namespace py = pybind11;
namespace {

py::list path_list(const SolveReport& report) {
  py::list all;
  for (const SolvePathStage& stage : report.path) all.append(py::make_tuple(name_of(stage.stage), stage.count));
  return all;
}

std::string report_text(const SolveReport& report) {
  std::string text = report.converged ? "<SolveReport converged" : "<SolveReport not converged";
  text += ", " + std::to_string(report.iterations) + " iterations";
  if (!report.message.empty()) text += ": " + report.message;
  return text + ">";
}

void bind_solve_report(py::module_& module) {
  py::class_<SolveReport>(module, "SolveReport", "What a solve did; see `result.solver` of a scene's result.")
      .def_readonly("converged", &SolveReport::converged, "Whether it did; otherwise `message` says why not.")
      .def_readonly("interrupted", &SolveReport::interrupted,
                    "By the scene's solver.time_limit_s; the state is as before.")
      .def_readonly("iterations", &SolveReport::iterations, "Newton iterations, or sweeps of xpbd.")
      .def_readonly("steps", &SolveReport::steps, "In time, or of a continuation.")
      .def_readonly("residual", &SolveReport::residual, "Force residual over the largest force in the body.")
      .def_readonly("wall_s", &SolveReport::wall_s, "Seconds of wall time.")
      .def_readonly("inverted_elements", &SolveReport::inverted_elements, "Elements that are turned inside out.")
      .def_readonly("message", &SolveReport::message, "Empty, or why it stopped short.")
      .def_property_readonly("path", &path_list, "List of (stage, count): the way that the solve went.")
      .def_property_readonly(
          "warnings", [](const SolveReport& report) { return warning_list(report.warnings); },
          "List of dicts: kind, size, unit, text, and where they apply actuator, commanded, reached, rest_position_m.")
      .def("__repr__", &report_text);
}

py::array_t<double> trajectory_markers(const Trajectory& trajectory) {
  const py::ssize_t times = static_cast<py::ssize_t>(trajectory.markers_m.size());
  const py::ssize_t markers = times > 0 ? trajectory.markers_m.front().cols() : 0;
  py::array_t<double> all(std::vector<py::ssize_t>{times, markers, 3});
  for (py::ssize_t i = 0; i < times; ++i)
    Eigen::Map<Eigen::Matrix3Xd>(all.mutable_data() + i * markers * 3, 3, markers) =
        trajectory.markers_m[static_cast<std::size_t>(i)];
  return all;
}

// Row 0 of each is as commanded, row 1 as reached.
py::array_t<double> trajectory_commands(const Trajectory& trajectory, Eigen::Index row) {
  const py::ssize_t times = static_cast<py::ssize_t>(trajectory.commands.size());
  const py::ssize_t actuators = times > 0 ? trajectory.commands.front().cols() : 0;
  py::array_t<double> all(std::vector<py::ssize_t>{times, actuators});
  for (py::ssize_t i = 0; i < times; ++i)
    Eigen::Map<Eigen::RowVectorXd>(all.mutable_data() + i * actuators, actuators) =
        trajectory.commands[static_cast<std::size_t>(i)].row(row);
  return all;
}

}  // namespace

void bind_reports(py::module_& module) {
  bind_solve_report(module);
  using Run = PythonSimulation::Run;
  py::class_<Run>(module, "RunResult", "What a scene's own run did.")
      .def_property_readonly(
          "report", [](const Run& run) { return run.report.solve; }, "SolveReport of the whole run.")
      .def_property_readonly(
          "time_s", [](const Run& run) { return numbers_array(run.report.trajectory.time_s); },
          "(times,) seconds; empty but for a dynamic run.")
      .def_property_readonly(
          "markers_m", [](const Run& run) { return trajectory_markers(run.report.trajectory); },
          "(times, markers, 3) metres in robot_base; empty but for a dynamic run.")
      .def_property_readonly(
          "commands", [](const Run& run) { return trajectory_commands(run.report.trajectory, 0); },
          "(times, actuators) as commanded; empty but for a dynamic run.")
      .def_property_readonly(
          "reached", [](const Run& run) { return trajectory_commands(run.report.trajectory, 1); },
          "(times, actuators) as the drives reached them; empty but for a dynamic run.")
      .def_property_readonly(
          "sensitivity", [](const Run& run) { return matrix_array(run.report.sensitivity); },
          "(3 * markers, actuators) d marker / d command, where the run asks for it and converged; else (0, 0).")
      .def_property_readonly(
          "frequencies_hz",
          [](const Run& run) {
            const Eigen::VectorXd& all = run.report.frequencies_hz;
            return numbers_array(std::vector<double>(all.data(), all.data() + all.size()));
          },
          "(modes,) of a modal run, ascending; else empty.")
      .def_readonly("result_json", &Run::result_json, "str: the file that `simulate --result` writes.");
}

}  // namespace soft_robot_lab
