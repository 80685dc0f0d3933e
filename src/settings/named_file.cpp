// SPDX-License-Identifier: BSD-3-Clause
#include "named_file.h"

#include <filesystem>

namespace soft_robot_lab {

std::string named_file(const YamlNode& node) {
  namespace fs = std::filesystem;
  const std::string file = node.as_text();
  if (file.empty()) node.fail("is empty, must name a file");
  return fs::absolute(fs::path(node.source()).parent_path() / file).lexically_normal().string();
}

}  // namespace soft_robot_lab
