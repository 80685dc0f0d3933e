// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <exception>
#include <future>
#include <thread>
#include <variant>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "bindings.h"
#include "python_batch.h"
#include "settings/limits.h"
#include "settings/require.h"

namespace soft_robot_lab {
namespace py = pybind11;
namespace {

struct Reports {
  std::vector<SolveReport> of;
};

// None, changes of the one model, or changes of each.
using Changes = std::optional<std::variant<py::dict, std::vector<py::dict>>>;

std::vector<std::optional<py::dict>> changes_of_each(const Changes& overrides) {
  if (!overrides) return {std::nullopt};
  if (const auto* one = std::get_if<py::dict>(&*overrides)) return {*one};
  const auto& each = std::get<std::vector<py::dict>>(*overrides);
  if (each.empty()) throw std::invalid_argument("overrides: must have at least one dict");
  return {each.begin(), each.end()};
}

// In several threads, in which scenes are meshed and reduced models trained. Throws what the first of the scenes threw.
std::vector<Scene> load_all(const std::string& path, const std::vector<SceneOptions>& options, int threads) {
  std::vector<Scene> scenes(options.size());
  std::vector<std::exception_ptr> thrown(options.size());
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  const auto take = [&] {
    for (std::size_t i = next++; i < options.size() && !failed; i = next++) try {
        scenes[i] = load_scene(path, options[i]);
      } catch (...) {
        thrown[i] = std::current_exception();
        failed = true;
      }
  };
  std::vector<std::future<void>> others;
  for (std::size_t i = 1; i < std::min(static_cast<std::size_t>(threads), options.size()); ++i)
    others.push_back(std::async(std::launch::async, take));
  take();
  for (std::future<void>& other : others) other.wait();
  for (const std::exception_ptr& one : thrown)
    if (one) std::rethrow_exception(one);
  return scenes;
}

std::shared_ptr<PythonBatch> load_batch(const std::filesystem::path& path, int worlds, std::optional<int> threads,
                                        const Changes& overrides, const std::optional<std::string>& method) {
  Guarded loading;
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  require(threads.value_or(1) >= 1 && threads.value_or(1) <= limits::kThreads, "threads", threads.value_or(1),
          "[1, 1000]");
  std::vector<SceneOptions> options;
  for (const auto& changes : changes_of_each(overrides))
    options.push_back(options_for_python(loading, path, changes, method));
  std::vector<Scene> scenes = loading.beside([&] { return load_all(path.string(), options, threads.value_or(cores)); });
  return std::make_shared<PythonBatch>(std::move(scenes), worlds, threads.value_or(cores));
}

template <class Number, class Member>
py::array_t<Number> of_each(const Reports& reports, Member member) {
  py::array_t<Number> all(static_cast<py::ssize_t>(reports.of.size()));
  for (std::size_t i = 0; i < reports.of.size(); ++i) all.mutable_data()[i] = reports.of[i].*member;
  return all;
}

py::array_t<int> whole_numbers(const std::vector<int>& numbers) {
  return py::array_t<int>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

// worlds x rows x columns, from a matrix of each world, whose columns lie one after the other in memory.
template <class Matrix>
py::array_t<double> stacked(const std::vector<Matrix>& of_worlds) {
  const Eigen::Index rows = of_worlds.front().rows(), columns = of_worlds.front().cols();
  py::array_t<double> all(std::vector<py::ssize_t>{static_cast<py::ssize_t>(of_worlds.size()), columns, rows});
  double* next = all.mutable_data();
  for (const Matrix& one : of_worlds) next = std::copy(one.data(), one.data() + one.size(), next);
  return all;
}

std::vector<int> worlds_of(const PythonBatch& batch, const py::object& given) {
  std::vector<int> all;
  if (given.is_none()) {
    for (int world = 0; world < batch.worlds(); ++world) all.push_back(world);
    return all;
  }
  const py::array array = py::array::ensure(given);
  if (!array || array.ndim() != 1)
    throw py::type_error("worlds: must be a list of numbers, or of a truth value for each world");
  if (array.dtype().kind() != 'b') return py::cast<std::vector<int>>(array.attr("tolist")());
  if (array.shape(0) != batch.worlds()) throw std::invalid_argument("worlds: must have a truth value for each world");
  for (int world = 0; world < batch.worlds(); ++world)
    if (array[py::int_(world)].cast<bool>()) all.push_back(world);
  return all;
}

void bind_batch_report(py::module_& module) {
  py::class_<Reports>(module, "BatchReport", "What the solves of a batch did, world by world.")
      .def_property_readonly(
          "converged", [](const Reports& self) { return of_each<bool>(self, &SolveReport::converged); },
          "(worlds,) bool: whether every solve of the world did.")
      .def_property_readonly(
          "iterations", [](const Reports& self) { return of_each<int>(self, &SolveReport::iterations); },
          "(worlds,) int.")
      .def_property_readonly(
          "residual", [](const Reports& self) { return of_each<double>(self, &SolveReport::residual); },
          "(worlds,) the largest, as SolveReport.residual.")
      .def_property_readonly(
          "reports", [](const Reports& self) { return self.of; }, "List of a SolveReport for each world.");
}

using BatchClass = py::class_<PythonBatch, std::shared_ptr<PythonBatch>>;

void bind_batch_moves(BatchClass& batch) {
  batch
      .def(
          "step", [](PythonBatch& self, int steps) { return Reports{self.step(steps)}; }, py::arg("steps") = 1,
          "step($self, steps=1)\n--\n\nSo many time steps of each world. Returns a BatchReport.")
      .def(
          "settle",
          [](PythonBatch& self, const py::object& worlds) { return Reports{self.settle(worlds_of(self, worlds))}; },
          py::arg("worlds") = py::none(),
          "settle($self, worlds=None)\n--\n\n"
          "Each world to its rest state, or each of these as of reset(). Returns a BatchReport of them.")
      .def(
          "reset",
          [](PythonBatch& self, const py::object& worlds, const std::optional<std::vector<int>>& models) {
            const std::vector<int> of = worlds_of(self, worlds);
            self.reset(of, models.value_or(std::vector<int>()));
          },
          py::arg("worlds") = py::none(), py::arg("models") = py::none(),
          "reset($self, worlds=None, models=None)\n--\n\n"
          "Worlds to the rest shape: all, those whose numbers are given, or those whose truth value is. `models` has "
          "a\n"
          "number for each of them: of which of `overrides` it is from now on. IndexError for a number out of range.")
      .def("get_state", &PythonBatch::state, py::arg("world"),
           "get_state($self, world)\n--\n\nA State of one world, as Simulation.state.")
      .def("set_state", &PythonBatch::set_state, py::arg("world"), py::arg("state"),
           "set_state($self, world, state)\n--\n\nSets one world to a State. ValueError where it does not fit.")
      .def(
          "sensitivities",
          [](PythonBatch& self) {
            std::vector<Eigen::MatrixXd> all = self.sensitivities();
            for (Eigen::MatrixXd& one : all) one.transposeInPlace();
            return stacked(all);
          },
          "sensitivities($self)\n--\n\n(worlds, 3 * markers, actuators), as Simulation.sensitivities.")
      .def(
          "readings", [](PythonBatch& self, int world) { return readings_dict(self.readings(world)); },
          py::arg("world"), "readings($self, world)\n--\n\nOf one world, as Simulation.readings.")
      .def(
          "contacts", [](PythonBatch& self, int world) { return contacts_list(self.contacts(world)); },
          py::arg("world"), "contacts($self, world)\n--\n\nOf one world, as Simulation.contacts.");
}

void bind_batch_readings(BatchClass& batch) {
  batch
      .def_property(
          "commands", [](PythonBatch& self) { return matrix_array(self.commands(&DriveState::command)); },
          [](PythonBatch& self, const py::object& given) {
            const auto actuators = static_cast<Eigen::Index>(self.model().actuators().size());
            self.set(matrix_of(given, self.worlds(), actuators, "commands"));
          },
          "(worlds, actuators) as last commanded; may be set, all or none. ValueError names the world.")
      .def_property_readonly(
          "reached", [](PythonBatch& self) { return matrix_array(self.commands(&DriveState::actuated_command)); },
          "(worlds, actuators) as the drives have reached them.")
      .def_property_readonly(
          "markers_m", [](PythonBatch& self) { return stacked(self.markers_m()); },
          "(worlds, markers, 3) metres in robot_base.")
      .def_property_readonly(
          "time_s", [](PythonBatch& self) { return numbers_array(self.time_s()); }, "(worlds,) seconds.")
      .def_property_readonly(
          "models", [](PythonBatch& self) { return whole_numbers(self.scene_numbers()); },
          "(worlds,) int: of which of `overrides` each world is.")
      .def_property_readonly("worlds", &PythonBatch::worlds, "int")
      .def_property_readonly("threads", &PythonBatch::threads, "int")
      .def_property_readonly(
          "actuator_names", [](const PythonBatch& self) { return actuator_names(self.model()); },
          "List of str, in the order of commands.")
      .def_property_readonly(
          "marker_names", [](const PythonBatch& self) { return marker_names(self.model()); },
          "List of str, in the order of markers_m.")
      .def_property_readonly(
          "limits", [](const PythonBatch& self) { return command_limits(self.model()); },
          "dict by actuator of tuples (rest, least, largest, unit) of its command.")
      .def_property_readonly(
          "time_step_s", [](const PythonBatch& self) { return self.model().options().time_step_s; },
          "Seconds of one step.");
}

}  // namespace

void bind_batch(py::module_& module) {
  bind_batch_report(module);
  BatchClass batch(
      module, "Batch",
      "Many worlds of one scene, moved by several threads while Python's lock is free. Their numbers are those of one\n"
      "thread to the last bit. Where Ctrl-C ends a call, each world stands before its last solve or after it.");
  batch.def(
      py::init(&load_batch), py::arg("path"), py::arg("worlds"), py::arg("threads") = py::none(),
      py::arg("overrides") = py::none(), py::arg("method") = py::none(),
      "__init__($self, path, worlds, threads=None, overrides=None, method=None)\n--\n\n"
      "`threads` is the number of cores where it is not given; the rest is as of Simulation. `overrides` may be a\n"
      "list of dicts: then world i begins as number i of them, and after the last comes the first again. They\n"
      "have to agree in actuators, markers and time step.");
  bind_batch_moves(batch);
  bind_batch_readings(batch);
}

}  // namespace soft_robot_lab
