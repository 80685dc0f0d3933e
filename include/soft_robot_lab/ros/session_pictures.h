// What a camera saw in a recorded session, with the simulated robot drawn over it.
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/ros/recording.h"

namespace soft_robot_lab {

struct SessionPicture {
  std::string file;  // PNG
  std::string camera;
  double time_s = 0.0;
};

// For each of the times, of each camera the first image from then on that has lens and pose in the bag; at most
// `limit` pictures. Empty where the bag has no such images.
std::vector<SessionPicture> draw_session(const std::string& bag, const std::vector<RealityGap>& gaps,
                                         const std::vector<double>& times_s, const std::string& folder, int limit);

}  // namespace soft_robot_lab
