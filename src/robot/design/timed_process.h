// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace soft_robot_lab {

struct ProcessEnd {
  enum class Kind { exited, signalled, timed_out, interrupted };
  Kind kind;
  int value;  // exit status, or signal
};

// Runs a program with its arguments and waits for its end. Its standard error goes to a file, its standard output
// nowhere. After the limit, in which waiting for a core does not count, the program is killed with all it started, and
// it is killed when the caller dies, and when `ends`, which is asked every few milliseconds, answers true. Throws
// std::runtime_error when it cannot be started.
ProcessEnd run_with_limit(const std::vector<std::string>& command, const std::string& error_file, double limit_s,
                          const std::function<bool()>& ends = {});

}  // namespace soft_robot_lab
