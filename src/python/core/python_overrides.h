// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <pybind11/pybind11.h>

#include "soft_robot_lab/settings/overrides.h"

namespace soft_robot_lab {

// {"body.material.youngs_modulus_pa": 1e5, "cables.left.points_m[3][0]": 0.01}: by path, or by a name of the file's
// `parameters`. Values are numbers, words, truth values, lists and dictionaries of them. Throws std::invalid_argument,
// and pybind11::type_error for other types.
Overrides python_overrides(const std::string& scene_file, const pybind11::dict& values);

// A number of Python's; throws its TypeError.
double python_number(const pybind11::handle& value);

}  // namespace soft_robot_lab
