// SPDX-License-Identifier: BSD-3-Clause
#include "named_file.h"

#include <filesystem>

#include "kept_files.h"

namespace soft_robot_lab {

std::string named_file(const YamlNode& node) {
  namespace fs = std::filesystem;
  const std::string file = node.as_text();
  if (file.empty()) node.fail("is empty, must name a file");
  const std::string path = fs::absolute(fs::path(node.source()).parent_path() / file).lexically_normal().string();
  if (const std::string option = output_over(path); !option.empty())
    node.fail("'" + file + "' would be written over by " + option + "; give that a file of its own");
  keep_file(path);
  return path;
}

}  // namespace soft_robot_lab
