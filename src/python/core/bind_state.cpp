// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/pybind11.h>

#include "arrays.h"
#include "bindings.h"
#include "python_state.h"

namespace soft_robot_lab {
namespace py = pybind11;
namespace {

py::tuple pickled(const PythonState& state) { return py::make_tuple(kStateVersion, py::bytes(state_bytes(state))); }

PythonState unpickled(const py::tuple& parts) {
  if (parts.size() != 2 || !py::isinstance<py::int_>(parts[0]) || !py::isinstance<py::bytes>(parts[1]))
    throw std::invalid_argument("state: not what State.__getstate__ gives");
  if (!py::object(parts[0]).equal(py::int_(kStateVersion)))
    throw std::invalid_argument("state: of format " + py::str(parts[0]).cast<std::string>() +
                                "; this module reads format " + std::to_string(kStateVersion) + " alone");
  return state_of(parts[1].cast<std::string>());
}

bool same(const PythonState& a, const PythonState& b) { return state_bytes(a) == state_bytes(b); }

}  // namespace

void bind_state(py::module_& module) {
  py::class_<PythonState>(module, "State",
                          "All of a simulation that changes, to come back to. It can be compared to the last bit, "
                          "copied and pickled. Restored\n"
                          "within a process it goes on to the last bit as if it had never stopped. From a pickle, and "
                          "with xpbd and reduced\n"
                          "models, it goes on to within the solver's tolerance.")
      .def(
          "copy", [](const PythonState& state) { return state; }, "copy($self)\n--\n\nA State of its own.")
      .def_property_readonly(
          "time_s", [](const PythonState& state) { return state.place.full.time_s; }, "Seconds.")
      .def_property_readonly(
          "positions_m", [](const PythonState& state) { return points_array(state.place.full.positions_m); },
          "(nodes, 3) metres in robot_base, a copy.")
      .def_property_readonly(
          "velocities_m_s", [](const PythonState& state) { return points_array(state.place.full.velocities_m_s); },
          "(nodes, 3) metres per second, a copy.")
      .def_property_readonly(
          "commands", [](const PythonState& state) { return numbers_array(state.place.full.commands()); },
          "(actuators,) as last commanded, a copy.")
      .def("__copy__", [](const PythonState& state) { return state; })
      .def("__deepcopy__", [](const PythonState& state, const py::dict&) { return state; })
      .def(
          "__eq__", [](const PythonState& a, const PythonState& b) { return same(a, b); }, py::is_operator())
      .def(
          "__ne__", [](const PythonState& a, const PythonState& b) { return !same(a, b); }, py::is_operator())
      .def(py::pickle(&pickled, &unpickled));
}

}  // namespace soft_robot_lab
