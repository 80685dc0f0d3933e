// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "progress_bar.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

inline void print_warning(const std::string& program, const SolveWarning& warning) {
  std::cerr << program << ": warning: " << warning.text << "\n";
}

// What is known of a scene before it runs is said before it runs.
inline void print_warnings(const std::string& program, const Scene& scene) {
  for (const SolveWarning& warning : scene.warnings) print_warning(program, warning);
}

// Those that were not said of the scene.
inline void print_new_warnings(const std::string& program, const Scene& scene,
                               const std::vector<SolveWarning>& warnings) {
  for (const SolveWarning& warning : warnings)
    if (std::none_of(scene.warnings.begin(), scene.warnings.end(),
                     [&](const SolveWarning& said) { return said.text == warning.text; }))
      print_warning(program, warning);
}

// With a bar where a reduced model is trained, or a mesh is judged. Warnings of the scene are printed, as far as they
// are known before that.
inline Scene load_with_bar(const std::string& program, const std::string& file, SceneOptions options) {
  std::optional<ProgressBar> bar;
  Scene said;
  options.reduced = ReducedUse::trained;
  options.progress = [&](double fraction, const std::string& what) {
    if (!bar) bar.emplace(program);
    bar->show(fraction, what);
  };
  options.on_warnings = [&](const std::vector<SolveWarning>& warnings) {
    bar.reset();
    print_new_warnings(program, said, warnings);
    said.warnings.insert(said.warnings.end(), warnings.begin(), warnings.end());
  };
  Scene scene = load_scene(file, options);
  bar.reset();
  print_new_warnings(program, said, scene.warnings);
  return scene;
}

}  // namespace soft_robot_lab
