// SPDX-License-Identifier: BSD-3-Clause
// A program that records while it runs, as the panel's Record starts and stops it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace soft_robot_lab {

class RecorderProcess {
 public:
  RecorderProcess() = default;
  ~RecorderProcess();  // stops it
  RecorderProcess(const RecorderProcess&) = delete;
  RecorderProcess& operator=(const RecorderProcess&) = delete;

  // It ends with this process, too. Throws std::runtime_error where one runs already or none can be started.
  void start(const std::vector<std::string>& command);

  // By SIGINT, so that it closes its file; sent again each second, as a shell that starts it may lose one. False where
  // it needs longer than `limit_s`, and goes on closing it.
  bool stop(double limit_s);

  std::optional<pid_t> process();  // nothing where none runs
  bool ended_by_itself();          // since it was started

 private:
  void look();

  pid_t process_ = -1;
  bool wanted_ = false;
};

}  // namespace soft_robot_lab
