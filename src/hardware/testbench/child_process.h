// SPDX-License-Identifier: BSD-3-Clause
// A program that answers lines of text with lines of text.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

#include "line_socket.h"

namespace soft_robot_lab {

class ChildProcess {
 public:
  explicit ChildProcess(const std::vector<std::string>& command);  // throws std::runtime_error
  ~ChildProcess();                                                 // closes its input and waits for its end
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  std::string ask(const std::string& line) { return lines_->ask(line); }

 private:
  pid_t id_ = -1;
  std::unique_ptr<LineSocket> lines_;
};

}  // namespace soft_robot_lab
