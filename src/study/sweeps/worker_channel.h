// SPDX-License-Identifier: BSD-3-Clause
// A child process that holds one worker or several, and speaks in lines.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace soft_robot_lab {

// How to start it: a command here, through a remote shell, or a launcher of many.
struct WorkerCommand {
  std::string name;  // of the host, for messages
  std::vector<std::string> command;
};

class WorkerChannel {
 public:
  explicit WorkerChannel(const WorkerCommand& command);  // throws std::runtime_error where it cannot be started
  ~WorkerChannel();                                      // ends the process with all it runs
  WorkerChannel(const WorkerChannel&) = delete;
  WorkerChannel& operator=(const WorkerChannel&) = delete;

  int output() const { return output_; }  // to wait for
  bool send(const std::string& line);     // false: it is gone
  // Lines that came; call when there is something to read.
  std::vector<std::string> receive();
  bool ended() const { return ended_; }

 private:
  pid_t process_ = -1;
  int input_ = -1, output_ = -1;
  bool ended_ = false;
  std::string rest_;  // of a line
};

}  // namespace soft_robot_lab
