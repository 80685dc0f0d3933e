// A program that answers lines of text with lines of text.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace soft_robot_lab {

class ChildProcess {
 public:
  explicit ChildProcess(const std::vector<std::string>& command);  // throws std::runtime_error
  ~ChildProcess();                                                 // closes its input and waits for its end
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  std::string ask(const std::string& line);  // throws std::runtime_error when it has ended

 private:
  std::string read_line();

  pid_t id_ = -1;
  int socket_ = -1;
  std::string received_;
};

}  // namespace soft_robot_lab
