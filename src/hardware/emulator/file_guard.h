// SPDX-License-Identifier: BSD-3-Clause
// Removes files of this program that it could not remove itself, as it was killed.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace soft_robot_lab {

// A process beside this one, which waits for its end. To be made before there are threads, or files that must be closed
// with this program.
class FileGuard {
 public:
  explicit FileGuard(std::vector<std::string> paths);  // throws std::runtime_error
  ~FileGuard();
  FileGuard(const FileGuard&) = delete;
  FileGuard& operator=(const FileGuard&) = delete;

  // From now on paths[i], as it is, is to be removed; what takes its place later is somebody else's.
  void made(std::size_t i);

 private:
  std::vector<std::string> paths_;
  int line_ = -1;
  pid_t guard_ = -1;
};

}  // namespace soft_robot_lab
