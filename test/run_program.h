// SPDX-License-Identifier: BSD-3-Clause
// A program of ours as a user runs it in a shell.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "robot/scene/scene_files.h"

namespace soft_robot_lab {

inline std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

struct Outcome {
  int exit_status;  // -1: ended by a signal
  std::string out, err;
};

inline Outcome run_program(const std::string& program, const SceneFolder& folder, const std::string& arguments) {
  const std::string out = folder.path("out"), err = folder.path("err");
  const int status = std::system((program + " " + arguments + " >" + out + " 2>" + err).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(out), contents(err)};
}

}  // namespace soft_robot_lab
