// SPDX-License-Identifier: BSD-3-Clause
// Names of frames. Those of a session in a namespace begin with it, so that several robots stand in one tree.
#pragma once

#include <string>

namespace soft_robot_lab {

constexpr char room_frame[] = "world";  // of all sessions under one master

// Of this process's session: "left/" in the namespace /left; empty in none.
std::string frame_prefix();

std::string world_frame(const std::string& prefix = frame_prefix());  // the room itself where there is no prefix
std::string robot_frame(const std::string& prefix = frame_prefix());
// As the tracker believes it stands; a rendered one as it stands has "truth/" before its name.
std::string optical_frame(const std::string& camera, const std::string& prefix = frame_prefix());

// "left/" of "left/robot_base". Throws std::invalid_argument for a frame that is no robot's.
std::string prefix_of_robot(const std::string& frame);

}  // namespace soft_robot_lab
