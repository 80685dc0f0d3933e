// SPDX-License-Identifier: BSD-3-Clause
// What the module holds, a function for each class. Docstrings begin with the signature that inspect.signature reads.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <pybind11/pybind11.h>

#include "guard.h"
#include "made.h"
#include "python_batch.h"
#include "python_simulation.h"
#include "python_state.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

// With Ctrl-C heeded. Throws as python_overrides.
SceneOptions options_for_python(Guarded& guard, const std::filesystem::path& path,
                                const std::optional<pybind11::dict>& overrides);

// The same for a scene that is moved by `method`.
SceneOptions options_for_python(Guarded& guard, const std::filesystem::path& path,
                                const std::optional<pybind11::dict>& overrides,
                                const std::optional<std::string>& method);

// With Ctrl-C heeded. Throws as load_scene, and std::invalid_argument as python_overrides.
Scene load_for_python(Guarded& guard, const std::filesystem::path& path, const std::optional<pybind11::dict>& overrides,
                      const std::optional<std::string>& method);

void bind_reports(pybind11::module_& module);
void bind_state(pybind11::module_& module);
void bind_simulation(pybind11::module_& module);
void bind_batch(pybind11::module_& module);
void bind_functions(pybind11::module_& module);
void bind_learning_task(pybind11::module_& module);

}  // namespace soft_robot_lab

namespace pybind11::detail {

template <>
class type_caster<soft_robot_lab::SolveReport> : public soft_robot_lab::MadeCaster<soft_robot_lab::SolveReport> {};
template <>
class type_caster<soft_robot_lab::PythonSimulation::Run>
    : public soft_robot_lab::MadeCaster<soft_robot_lab::PythonSimulation::Run> {};
template <>
class type_caster<soft_robot_lab::PythonBatch> : public soft_robot_lab::MadeCaster<soft_robot_lab::PythonBatch> {};
template <>
class type_caster<soft_robot_lab::PythonState> : public soft_robot_lab::MadeCaster<soft_robot_lab::PythonState> {};
template <>
class type_caster<soft_robot_lab::PythonSimulation>
    : public soft_robot_lab::MadeCaster<soft_robot_lab::PythonSimulation> {};

}  // namespace pybind11::detail
