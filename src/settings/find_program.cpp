// SPDX-License-Identifier: BSD-3-Clause
#include "find_program.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

namespace soft_robot_lab {
namespace fs = std::filesystem;

std::string program_folder() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored).parent_path();
}

bool is_program(const std::string& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && access(path.c_str(), X_OK) == 0;
}

std::string find_program(const std::string& name) {
  const fs::path here = program_folder();
  std::vector<fs::path> folders = {here, here / ".." / "lib" / "soft_robot_lab"};
  std::istringstream path(std::getenv("PATH") ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(path, folder, ':');) folders.push_back(folder);
  for (const fs::path& folder : folders) {
    if (is_program(folder / name)) return folder / name;
  }
  return "";
}

}  // namespace soft_robot_lab
