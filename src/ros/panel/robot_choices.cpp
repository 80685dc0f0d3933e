// SPDX-License-Identifier: BSD-3-Clause
#include "robot_choices.h"

#include <filesystem>
#include <set>

#include "soft_robot_lab/robot/scene/scene_file.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

std::set<fs::path> entries_of(const fs::path& folder) {
  std::set<fs::path> entries;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) entries.insert(entry.path());
  return entries;
}

}  // namespace

std::string label_of(const std::string& scene) {
  const std::string name = name_of_robot(scene);
  const bool robot = fs::absolute(scene).lexically_normal() == robot_file(scene);
  return robot ? name : name + ": " + fs::path(scene).stem().string();
}

std::vector<RobotChoice> robot_choices(const std::string& folder) {
  std::vector<RobotChoice> choices;
  for (const fs::path& of : entries_of(fs::absolute(folder).lexically_normal())) {
    const std::string robot = of / "robot.yaml";
    if (!fs::exists(robot)) continue;
    choices.push_back({label_of(robot), robot});
    for (const fs::path& file : entries_of(of))
      if (file != robot && file.extension() == ".yaml" && robot_file(file) == robot && is_scene_file(file))
        choices.push_back({label_of(file), file});
  }
  return choices;
}

}  // namespace soft_robot_lab
