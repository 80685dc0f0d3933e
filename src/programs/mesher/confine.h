// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace soft_robot_lab {

// What this process can do no more, whatever a file makes Gmsh do: start programs or processes, open connections, write
// or make files outside of the folder, or take more than limits::kMemory_gb. Each is done as far as the kernel lets it
// be done: seccomp needs Linux 3.17, and some containers refuse it; Landlock needs Linux 5.13.
void confine_to(const std::string& folder);

}  // namespace soft_robot_lab
