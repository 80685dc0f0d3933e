// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "bindings.h"
#include "python_overrides.h"
#include "python_simulation.h"

namespace soft_robot_lab {
namespace py = pybind11;
namespace {

using FilePath = std::filesystem::path;

std::shared_ptr<PythonSimulation> load(const FilePath& path, const std::optional<py::dict>& overrides,
                                       const std::optional<std::string>& method) {
  Guarded loading;
  return std::make_shared<PythonSimulation>(load_for_python(loading, path, overrides, method));
}

NamedCommands commands_of(const py::handle& given) {
  if (!py::isinstance<py::dict>(given)) throw py::type_error("commands must be a dict of actuators and numbers");
  NamedCommands commands;
  for (const auto& [name, value] : given.cast<py::dict>())
    commands.emplace_back(py::cast<std::string>(py::str(name)), python_number(value));
  return commands;
}

void set(PythonSimulation& simulation, const py::object& commands, const py::kwargs& named) {
  NamedCommands all = commands.is_none() ? NamedCommands() : commands_of(commands);
  for (auto& one : commands_of(named)) all.push_back(std::move(one));
  simulation.set(all);
}

void set_all(PythonSimulation& simulation, const py::object& given) {
  const auto& actuators = simulation.model().actuators();
  const std::vector<double> numbers = numbers_of(given, actuators.size(), "commands");
  NamedCommands all;
  for (std::size_t i = 0; i < actuators.size(); ++i) all.emplace_back(actuators[i]->name(), numbers[i]);
  simulation.set(all);
}

py::array_t<double> commands_array(PythonSimulation& simulation, double DriveState::*which) {
  std::vector<double> all;
  for (const DriveState& drive : simulation.drives()) all.push_back(drive.*which);
  return numbers_array(all);
}

py::dict markers(PythonSimulation& simulation) {
  const Eigen::Matrix3Xd markers_m = simulation.markers_m();
  py::dict all;
  for (Eigen::Index i = 0; i < markers_m.cols(); ++i)
    all[py::str(simulation.model().markers()[static_cast<std::size_t>(i)].name())] =
        points_array(markers_m.col(i)).attr("reshape")(3);
  return all;
}

py::dict of_each(PythonSimulation& simulation, std::optional<double> ActuatorReading::*number) {
  py::dict all;
  for (const ActuatorReading& reading : simulation.readings())
    if (reading.*number) all[py::str(reading.name)] = *(reading.*number);
  return all;
}

py::array_t<double> nodes_view(PythonSimulation& simulation) {
  auto* kept = new std::shared_ptr<const ShownNodes>(simulation.nodes());
  const py::capsule owner(kept, [](void* memory) { delete static_cast<std::shared_ptr<const ShownNodes>*>(memory); });
  const Eigen::Matrix3Xd& nodes_m = (*kept)->positions_m;
  return array_view<double>({nodes_m.cols(), 3}, nodes_m.data(), owner);
}

py::array_t<int> indices_view(const py::object& self, const Eigen::MatrixXi& columns) {
  return array_view<int>({columns.cols(), columns.rows()}, columns.data(), self);
}

using SimulationClass = py::class_<PythonSimulation, std::shared_ptr<PythonSimulation>>;

void bind_moves(SimulationClass& simulation) {
  simulation
      .def("set", &set, py::arg("commands") = py::none(),
           "set($self, commands=None, **named)\n--\n\n"
           "Commands actuators by name: set(left=0.9), or set({'left': 0.9}). All of them are taken, or none. "
           "ValueError: an\n"
           "unknown name, with those there are; a value that is not finite or beyond its limits, with the range.")
      .def(
          "step", &PythonSimulation::step,
          "step($self)\n--\n\nOne time step of time_step_s. Returns a SolveReport; one that did not converge says why.")
      .def("settle", &PythonSimulation::settle,
           "settle($self)\n--\n\nThe rest state for the present commands, from the present state. Returns a "
           "SolveReport.\n"
           "ValueError where an actuator has no rest state.")
      .def("reset", &PythonSimulation::reset, "reset($self)\n--\n\nThe rest shape, rest commands, time zero.")
      .def("clone", &PythonSimulation::clone,
           "clone($self)\n--\n\nA Simulation of the same model in the same state; they share nothing that changes.")
      .def("run", &PythonSimulation::run,
           "run($self)\n--\n\nThe scene's own `run`, from the rest shape, as the program simulate does it. Returns a "
           "RunResult;\n"
           "this simulation stays where it is.")
      .def(
          "sensitivities", [](PythonSimulation& self) { return matrix_array(self.sensitivities()); },
          "sensitivities($self)\n--\n\n"
          "(3 * markers, actuators): d marker [m] / d command [its unit] at the present equilibrium. RuntimeError "
          "where the\n"
          "present state is none: settle() first.")
      .def_property("state", &PythonSimulation::state, &PythonSimulation::set_state,
                    "A State, a copy. Setting one that does not fit raises ValueError, and changes nothing.");
}

void bind_readings(SimulationClass& simulation) {
  simulation.def("markers", &markers, "markers($self)\n--\n\ndict of (3,) arrays, metres in robot_base, by marker.")
      .def_property_readonly(
          "markers_m", [](PythonSimulation& self) { return points_array(self.markers_m()); },
          "(markers, 3) metres in robot_base, in the order of marker_names.")
      .def_property(
          "commands", [](PythonSimulation& self) { return commands_array(self, &DriveState::command); }, &set_all,
          "(actuators,) as last commanded; may be set, all or none. ValueError for a wrong shape or value.")
      .def_property_readonly(
          "reached", [](PythonSimulation& self) { return commands_array(self, &DriveState::actuated_command); },
          "(actuators,) commands as the drives have reached them.")
      .def_property_readonly("time_s", &PythonSimulation::time_s, "Seconds since the rest shape.")
      .def_property_readonly("reduced", &PythonSimulation::reduced, "Whether a reduced model moves it.")
      .def(
          "readings", [](PythonSimulation& self) { return readings_dict(self.readings()); },
          "readings($self)\n--\n\ndict by actuator of dicts, with the keys of result.json: tension_n, "
          "gauge_pressure_pa, ...")
      .def(
          "tensions_n", [](PythonSimulation& self) { return of_each(self, &ActuatorReading::tension_n); },
          "tensions_n($self)\n--\n\ndict by cable: newtons.")
      .def(
          "pressures_pa", [](PythonSimulation& self) { return of_each(self, &ActuatorReading::gauge_pressure_pa); },
          "pressures_pa($self)\n--\n\ndict by chamber: pascals above the surrounding air.")
      .def(
          "contacts", [](PythonSimulation& self) { return contacts_list(self.contacts()); },
          "contacts($self)\n--\n\nList of dicts, one for each pair that touches: between, force_n, ...");
}

void bind_skin(SimulationClass& simulation) {
  simulation
      .def_property_readonly(
          "nodes_m", &nodes_view,
          "(nodes, 3) metres in robot_base: positions of all nodes of the mesh, read-only and without a copy. The\n"
          "array follows the simulation as long as it is kept; copy it to keep what it shows.")
      .def_property_readonly(
          "rest_nodes_m",
          [](const py::object& self) {
            const Eigen::Matrix3Xd& at_m = self.cast<PythonSimulation&>().model().body().mesh().nodes_m;
            return array_view<double>({at_m.cols(), 3}, at_m.data(), self);
          },
          "(nodes, 3) metres: the rest shape, read-only and without a copy.")
      .def_property_readonly(
          "skin_faces",
          [](const py::object& self) {
            return indices_view(self, self.cast<PythonSimulation&>().model().body().mesh().faces);
          },
          "(faces, 3 or 6) node indices of the skin's triangles, outward: corners, then mid-edges 01, 12, 20.")
      .def_property_readonly(
          "elements",
          [](const py::object& self) {
            return indices_view(self, self.cast<PythonSimulation&>().model().body().mesh().tets);
          },
          "(elements, 4 or 10) node indices of the tetrahedra, in Gmsh's order.");
}

void bind_names(SimulationClass& simulation) {
  simulation
      .def_property_readonly(
          "actuator_names", [](const PythonSimulation& self) { return actuator_names(self.model()); },
          "List of str, in the order of commands.")
      .def_property_readonly(
          "marker_names", [](const PythonSimulation& self) { return marker_names(self.model()); },
          "List of str, in the order of markers_m.")
      .def_property_readonly(
          "limits", [](const PythonSimulation& self) { return command_limits(self.model()); },
          "dict by actuator of tuples (rest, least, largest, unit) of its command.")
      .def_property_readonly(
          "time_step_s", [](const PythonSimulation& self) { return self.model().options().time_step_s; },
          "Seconds of one step().")
      .def_property_readonly(
          "warnings", [](const PythonSimulation& self) { return warning_list(self.scene().warnings); },
          "List of dicts: what is odd about the scene, as SolveReport.warnings.");
}

}  // namespace

SceneOptions options_for_python(Guarded& guard, const FilePath& path, const std::optional<py::dict>& overrides) {
  SceneOptions options = python_scene_options();
  if (overrides) options.overrides = python_overrides(path, *overrides);
  options.interrupt = [&guard] { return guard.watch().asked(); };
  return options;
}

SceneOptions options_for_python(Guarded& guard, const FilePath& path, const std::optional<py::dict>& overrides,
                                const std::optional<std::string>& method) {
  SceneOptions options = options_for_python(guard, path, overrides);
  options.method = method.value_or("");
  // Training asks nothing but this.
  options.progress = [&guard](double, const std::string&) {
    if (guard.watch().asked()) throw std::runtime_error("interrupted");
  };
  return options;
}

Scene load_for_python(Guarded& guard, const FilePath& path, const std::optional<py::dict>& overrides,
                      const std::optional<std::string>& method) {
  const SceneOptions options = options_for_python(guard, path, overrides, method);
  return guard.beside([&] { return load_scene(path.string(), options); });
}

void bind_simulation(py::module_& module) {
  SimulationClass simulation(
      module, "Simulation",
      "A scene or robot file that is moved through time or to rest. One thread at a time may use it: another one gets\n"
      "a RuntimeError. After a fork the child makes its own. Ctrl-C ends every solve with KeyboardInterrupt, and the\n"
      "state is as before the call.");
  simulation.def(
      py::init(&load), py::arg("path"), py::arg("overrides") = py::none(), py::arg("method") = py::none(),
      "__init__($self, path, overrides=None, method=None)\n--\n\n"
      "`overrides` is laid over the file by path, {'body.material.youngs_modulus_pa': 1e5}, or by a name of its\n"
      "`parameters`. `method` is newton, xpbd or reduced, in place of the file's; a reduced model is trained where "
      "none\n"
      "is kept. SettingsError (a ValueError): file, line, key, value and allowed range.");
  bind_moves(simulation);
  bind_readings(simulation);
  bind_skin(simulation);
  bind_names(simulation);
}

}  // namespace soft_robot_lab
