// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>

#include "sections.h"

namespace soft_robot_lab {
namespace {

// `open_files`: those that led here, to find circles.
YamlNode resolve(const YamlNode& settings, std::vector<std::string> open_files) {
  const std::optional<YamlNode> include = settings.optional_child("include");
  if (!include) return settings;
  open_files.push_back(std::filesystem::weakly_canonical(settings.source()).string());
  const std::string base = beside(*include, include->as_text());
  if (std::find(open_files.begin(), open_files.end(), std::filesystem::weakly_canonical(base)) != open_files.end()) {
    include->fail("'" + include->as_text() + "' includes itself");
  }
  if (!std::filesystem::is_regular_file(base)) include->fail("there is no file " + base);
  return merge_settings(resolve(YamlNode::load_file(base), open_files), settings);
}

}  // namespace

YamlNode with_includes(const YamlNode& settings) { return resolve(settings, {}); }

std::string beside(const YamlNode& node, const std::string& file) {
  return std::filesystem::absolute(std::filesystem::path(node.source()).parent_path() / file)
      .lexically_normal()
      .string();
}

}  // namespace soft_robot_lab
