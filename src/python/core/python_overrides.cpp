// SPDX-License-Identifier: BSD-3-Clause
#include "python_overrides.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "robot/scene/parameters.h"

namespace soft_robot_lab {
namespace py = pybind11;
namespace {

std::string text_of(const py::handle& name) {
  if (!py::isinstance<py::str>(name))
    throw py::type_error("a name must be a str, not " + py::str(py::type::of(name)).cast<std::string>());
  return name.cast<std::string>();
}

double finite_number(const py::handle& value) {
  const double number = python_number(value);
  if (!std::isfinite(number)) throw std::invalid_argument("the value is not a finite number");
  return number;
}

constexpr int kDeepest = 20;

OverrideValue value_of(const py::handle& value, int depth) {
  if (depth > kDeepest) throw std::invalid_argument("lists and dictionaries lie more than 20 deep");
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::isinstance<py::dict>(value)) {
    Overrides keys;
    for (const auto& [name, item] : value.cast<py::dict>()) keys.set({text_of(name)}, value_of(item, depth + 1));
    return keys;
  }
  if (!PyNumber_Check(value.ptr()) || PySequence_Check(value.ptr())) {
    if (!py::isinstance<py::iterable>(value)) throw py::type_error("a value must be a number, str, bool, list or dict");
    std::vector<OverrideValue> items;
    for (const py::handle& item : value.cast<py::iterable>()) items.push_back(value_of(item, depth + 1));
    return items;
  }
  return finite_number(value);
}

}  // namespace

double python_number(const py::handle& value) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (number == -1.0 && PyErr_Occurred()) throw py::error_already_set();
  return number;
}

Overrides python_overrides(const std::string& scene_file, const py::dict& values) {
  Overrides all;
  if (values.empty()) return all;
  const YamlNode scene = load_settings(scene_file);
  const std::vector<NamedParameter> named = read_parameters(scene);
  ParameterValues parameters;
  for (const auto& [key, value] : values) {
    const std::string name = text_of(key);
    if (std::any_of(named.begin(), named.end(), [&](const auto& one) { return one.name == name; })) {
      parameters.emplace_back(name, python_number(value));
      continue;
    }
    try {
      all.set(path_steps(name), value_of(value, 0));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("overrides['" + name + "']: " + error.what());
    }
  }
  return parameters.empty() ? all : parameter_overrides(scene, parameters).lay(all);
}

}  // namespace soft_robot_lab
