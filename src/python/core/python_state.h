// SPDX-License-Identifier: BSD-3-Clause
// All of a simulation that changes, as Python keeps it.
#pragma once

#include <memory>
#include <string>

#include "robot/scene/scene_motion.h"
#include "soft_robot_lab/mechanics/model.h"

namespace soft_robot_lab {

constexpr int kStateVersion = 1;  // raise it where state_bytes writes something else

struct PythonState {
  SceneMotion::Place place;
  std::shared_ptr<const Model> model;  // that it is a state of; null where it was read from bytes
};

// Every number, little-endian, to the last bit; not where the solver's factor was made. Throws std::invalid_argument
// for bytes that are no state.
std::string state_bytes(const PythonState& state);
PythonState state_of(const std::string& bytes);

// Throws std::invalid_argument for a state that does not fit, and leaves the motion where it was then.
void go_to_or_stay(SceneMotion& motion, const PythonState& state);

}  // namespace soft_robot_lab
