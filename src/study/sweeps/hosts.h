// SPDX-License-Identifier: BSD-3-Clause
// Where workers run.
#pragma once

#include <string>
#include <vector>

#include "worker_channel.h"

namespace soft_robot_lab {

// `count` workers here.
std::vector<WorkerCommand> local_workers(const std::string& program, int count);

// A line a host: its name, then how many workers it gets (1); # begins a comment. `shell` starts a command on a host,
// as "ssh -o BatchMode=yes" does. This package must lie at the same place there, and so must the scene. Throws
// std::invalid_argument: file, line and what is wrong.
std::vector<WorkerCommand> remote_workers(const std::string& program, const std::string& hosts_file,
                                          const std::string& shell);

// The ranks that `launcher` starts, as "mpirun -n 8" does. Where one ends, Open MPI ends all, and all start again.
// Throws std::invalid_argument where this build has no MPI.
std::vector<WorkerCommand> mpi_workers(const std::string& program, const std::string& launcher);

}  // namespace soft_robot_lab
