// SPDX-License-Identifier: BSD-3-Clause
// A recorded session as a film: the simulated robot, its markers and the tracked ones, seen from one place.
#pragma once

#include <optional>
#include <string>

#include "ros/recording/recorded_session.h"

namespace soft_robot_lab {

struct SessionFilm {
  std::string file;    // MP4 (H.264)
  double speed = 1.0;  // seconds of the session in a second of the film
  std::string middle;  // PNG: the frame at half time
};

// Writes FOLDER/session.mp4 and session_film.png. Nothing where the recording has no skin of the robot, or OpenCV here
// cannot write such a film. A session of more than two minutes is shown faster, so that its film has two.
std::optional<SessionFilm> film_session(const std::string& bag, const RecordedSession& recording,
                                        const std::string& folder);

}  // namespace soft_robot_lab
