// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"

#include <cmath>
#include <optional>
#include <stdexcept>

namespace soft_robot_lab {
namespace py = pybind11;
namespace {

py::object item_of(double value) { return py::float_(value); }
py::object item_of(const Eigen::Vector3d& value) { return points_array(value).attr("reshape")(3); }

template <class Value>
void add(py::dict& all, const char* key, const std::optional<Value>& value) {
  if (value) all[key] = item_of(*value);
}

std::string shape_text(const py::array& array) { return py::repr(array.attr("shape")).cast<std::string>(); }

// As an array of double, row by row.
py::array_t<double, py::array::c_style | py::array::forcecast> doubles_of(const py::handle& given,
                                                                          const std::string& what) {
  auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
  if (array) return array;
  PyErr_Clear();
  throw py::type_error(what + ": not an array of numbers");
}

}  // namespace

py::array_t<double> points_array(const Eigen::Matrix3Xd& columns) {
  return py::array_t<double>(std::vector<py::ssize_t>{columns.cols(), 3}, columns.data());
}

py::array_t<double> matrix_array(const Eigen::MatrixXd& matrix) {
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = matrix;
  return py::array_t<double>(std::vector<py::ssize_t>{rows.rows(), rows.cols()}, rows.data());
}

py::array_t<double> numbers_array(const std::vector<double>& numbers) {
  return py::array_t<double>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

Eigen::MatrixXd matrix_of(const py::handle& given, Eigen::Index rows, Eigen::Index columns, const std::string& what) {
  const auto array = doubles_of(given, what);
  if (array.ndim() != 2 || array.shape(0) != rows || array.shape(1) != columns)
    throw std::invalid_argument(what + ": of shape " + shape_text(array) + ", must be (" + std::to_string(rows) + ", " +
                                std::to_string(columns) + ")");
  Eigen::MatrixXd matrix(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < columns; ++j) matrix(i, j) = array.at(i, j);
  if (!matrix.allFinite()) throw std::invalid_argument(what + ": must be finite numbers");
  return matrix;
}

std::vector<double> numbers_of(const py::handle& given, std::size_t count, const std::string& what) {
  const auto array = doubles_of(given, what);
  if (array.ndim() != 1 || array.shape(0) != static_cast<py::ssize_t>(count))
    throw std::invalid_argument(what + ": of shape " + shape_text(array) + ", must be (" + std::to_string(count) +
                                ",)");
  std::vector<double> numbers(array.data(), array.data() + count);
  for (const double number : numbers)
    if (!std::isfinite(number)) throw std::invalid_argument(what + ": must be finite numbers");
  return numbers;
}

py::dict reading_dict(const ActuatorReading& reading) {
  py::dict all;
  all["command"] = reading.command;
  all["actuated_command"] = reading.actuated_command;
  add(all, "length_m", reading.length_m);
  add(all, "rest_length_m", reading.rest_length_m);
  add(all, "tension_n", reading.tension_n);
  if (!reading.span_tensions_n.empty()) all["span_tensions_n"] = numbers_array(reading.span_tensions_n);
  add(all, "stretch_m", reading.stretch_m);
  add(all, "slack_m", reading.slack_m);
  add(all, "pretension_n", reading.pretension_n);
  add(all, "volume_m3", reading.volume_m3);
  add(all, "initial_volume_m3", reading.initial_volume_m3);
  add(all, "gauge_pressure_pa", reading.gauge_pressure_pa);
  add(all, "gas_residual", reading.gas_residual);
  return all;
}

py::dict contact_dict(const ContactReading& reading) {
  py::dict all;
  all["between"] = py::make_tuple(reading.on, reading.surface);
  all["force_n"] = item_of(reading.force_n);
  all["normal_force_n"] = reading.normal_force_n;
  all["area_m2"] = reading.area_m2;
  all["largest_penetration_m"] = reading.largest_penetration_m;
  all["sticking_area_m2"] = reading.sticking_area_m2;
  all["slipping_area_m2"] = reading.slipping_area_m2;
  all["center_m"] = item_of(reading.center_m);
  all["normal"] = item_of(reading.normal);
  all["largest_pressure_pa"] = reading.largest_pressure_pa;
  return all;
}

py::dict readings_dict(const std::vector<ActuatorReading>& readings) {
  py::dict all;
  for (const ActuatorReading& reading : readings) all[py::str(reading.name)] = reading_dict(reading);
  return all;
}

py::list contacts_list(const std::vector<ContactReading>& contacts) {
  py::list all;
  for (const ContactReading& reading : contacts)
    if (reading.normal_force_n != 0.0) all.append(contact_dict(reading));
  return all;
}

py::list actuator_names(const Model& model) {
  py::list all;
  for (const auto& actuator : model.actuators()) all.append(actuator->name());
  return all;
}

py::list marker_names(const Model& model) {
  py::list all;
  for (const Marker& marker : model.markers()) all.append(marker.name());
  return all;
}

py::dict command_limits(const Model& model) {
  py::dict all;
  for (const auto& actuator : model.actuators()) {
    const CommandLimits& limits = actuator->limits();
    all[py::str(actuator->name())] = py::make_tuple(limits.rest, limits.min, limits.max, limits.unit);
  }
  return all;
}

py::list warning_list(const std::vector<SolveWarning>& warnings) {
  py::list all;
  for (const SolveWarning& warning : warnings) {
    py::dict one;
    one["kind"] = warning.kind;
    one["size"] = warning.size;
    one["unit"] = warning.unit;
    if (!warning.actuator.empty()) one["actuator"] = warning.actuator;
    add(one, "commanded", warning.commanded);
    add(one, "reached", warning.reached);
    add(one, "rest_position_m", warning.rest_position_m);
    one["text"] = warning.text;
    all.append(one);
  }
  return all;
}

}  // namespace soft_robot_lab
