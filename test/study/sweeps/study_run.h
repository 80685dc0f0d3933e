// SPDX-License-Identifier: BSD-3-Clause
// Studies of a short bar that takes a few hundredths of a second.
#pragma once

#include <string>

#include "run_program.h"

namespace soft_robot_lab {

inline std::string short_scene(const SceneFolder& folder) {
  return folder.write("short.yaml",
                      "include: bar.yaml\nbody: {element: linear}\ncables: []\n"
                      "parameters:\n"
                      "  height: {range: [0.01, 0.03], factors: {\"body.solid.box.size_m[2]\": 1}}\n");
}

// Runs or goes on with FOLDER/NAME of a study that stands in FOLDER/study.yaml.
inline Outcome run_study(const SceneFolder& folder, const std::string& text, const std::string& name,
                         const std::string& arguments) {
  const std::string file = folder.write("study.yaml", text);
  return run_program(SOFT_ROBOT_LAB_STUDY_PROGRAM, folder, file + " --output " + folder.path(name) + " " + arguments);
}

// `count` values of the stiffness.
inline std::string short_study(const std::string& count) {
  return "program: simulate\nscene: short.yaml\nmethod: latin_hypercube\nsamples: " + count +
         "\nparameters:\n  body.material.youngs_modulus_pa: {range: [1.0e+5, 1.0e+6]}\n"
         "  markers.tip.position_m[0]: {range: [0.08, 0.1]}\nshow: [markers.tip.position_m.y]\n";
}

}  // namespace soft_robot_lab
