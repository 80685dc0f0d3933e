// SPDX-License-Identifier: BSD-3-Clause
// The Python module soft_robot_lab._core: simulations without ROS.
#include <pybind11/pybind11.h>

#include "bindings.h"
#include "soft_robot_lab/settings/yaml_node.h"

PYBIND11_MODULE(_core, module) {
  namespace py = pybind11;
  using namespace soft_robot_lab;
  py::options options;
  options.disable_function_signatures();
  module.doc() = "Simulations of soft robots, without ROS. Lengths in metres, in the frame robot_base; SI units.";
  py::register_exception<SettingsError>(module, "SettingsError", PyExc_ValueError).attr("__doc__") =
      "What a file got wrong: file, line, key, value and allowed range.";
  bind_reports(module);
  bind_state(module);
  bind_simulation(module);
  bind_batch(module);
  bind_functions(module);
  bind_learning_task(module);
}
