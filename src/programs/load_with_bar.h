// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "progress_bar.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

// With a bar where a reduced model is trained, or a mesh is judged.
inline Scene load_with_bar(const std::string& program, const std::string& file, SceneOptions options) {
  std::optional<ProgressBar> bar;
  options.knows_reduced = true;
  options.progress = [&](double fraction, const std::string& what) {
    if (!bar) bar.emplace(program);
    bar->show(fraction, what);
  };
  return load_scene(file, options);
}

}  // namespace soft_robot_lab
