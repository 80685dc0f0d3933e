// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace soft_robot_lab {

// The folder that the running program lies in.
std::string program_folder();

// Another program of this package: beside the running one, in the lib folder beside its own, or on PATH; empty where
// there is none.
std::string find_program(const std::string& name);

bool is_program(const std::string& path);  // a file that may be run

}  // namespace soft_robot_lab
