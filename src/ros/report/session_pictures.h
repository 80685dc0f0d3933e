// SPDX-License-Identifier: BSD-3-Clause
// What a camera saw of the robot in a recorded session, with the simulated robot drawn over it.
#pragma once

#include <string>
#include <vector>

#include "ros/recording/recorded_session.h"

namespace soft_robot_lab {

struct SessionPicture {
  std::string file;  // JPEG
  std::string camera;
  size_t asked = 0;     // which of the times
  double time_s = 0.0;  // of the image
};

// For each of the times, in rising order, of each camera the first image taken from then on, and before the next of the
// times, that has lens and pose in the bag; in this order. Empty where the bag has no such images.
std::vector<SessionPicture> draw_session(const std::string& bag, const std::vector<RealityGap>& gaps,
                                         const std::vector<double>& times_s, const std::string& folder);

}  // namespace soft_robot_lab
