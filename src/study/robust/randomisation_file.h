// SPDX-License-Identifier: BSD-3-Clause
// In what a real robot may differ from its model: numbers of its file, the play of its drives, and where cameras
// believe it to be, each by a distribution.
#pragma once

#include <string>
#include <vector>

#include "study/sweeps/study_file.h"

namespace soft_robot_lab {

// samples: 30                    # robots
// seed: 1
// parameters:                    # as of a study
//   body.material.youngs_modulus_pa: {normal: {mean: 264200, deviation: 20000}}
//   backlash_m.left: {range: [0, 5.0e-4]}                     # of a cable's drive
//   camera_to_base.x_m: {normal: {mean: 0, deviation: 1.0e-3}}    # y_m, z_m, rx_rad, ry_rad, rz_rad
struct Randomisation {
  StudySettings study;  // of numbers of the robot's file; the others follow
  std::vector<StudyParameter> drives, cameras;
};

// Throws SettingsError: file, line, key, value and allowed range.
Randomisation read_randomisation(const std::string& file, const std::string& robot);

}  // namespace soft_robot_lab
