// SPDX-License-Identifier: BSD-3-Clause
// What a design is worth: where it reaches, and what that takes.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

struct AssessmentSettings {
  std::string marker;          // empty: `tip`, else the last
  int steps = 5;               // of each command, from rest to the end that is pulled or filled [2, 100]
  bool one_at_a_time = false;  // the others rest meanwhile; then there is no workspace
  double max_tension_n = std::numeric_limits<double>::infinity();  // rest states beyond do not count
  std::vector<Eigen::Vector3d> targets_m;                          // robot_base; may be empty
};

// reach_m                    the farthest that the marker rests from where it hangs
// reach_commands             by actuator, there
// workspace_m, _m2 or _m3    what the marker goes over, by the mean size of its Jacobian; of one, two, or more
// actuators.
//                            A place that is reached twice counts twice; null where commands change one at a time
// largest_tension_n          over the states that count
// mass_kg
// stiffness_sensitivity_m    how far the marker moves there per relative change of the stiffness
// mean_distance_m            of the best policies from the targets; null without targets
// without_rest, too_tense    states that do not count
// Throws std::invalid_argument: unknown marker, settings out of range; std::runtime_error where the robot does not
// rest.
nlohmann::ordered_json assess(const std::string& robot_file, Simulation& robot, const AssessmentSettings& settings);

}  // namespace soft_robot_lab
