// SPDX-License-Identifier: BSD-3-Clause
// Messages of markers as the session's rest detection takes them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "messages.h"
#include "session/marker_frame.h"

namespace soft_robot_lab {

// What cameras saw. Throws std::invalid_argument for a place that is not finite, as from_message does, and
// std::out_of_range where names, positions and sources are not as many (see require_whole).
MarkerFrame seen_frame(const MarkerObservations& markers);

// As they are: also what is not finite.
std::vector<Eigen::Vector3d> raw_positions_m(const MarkerObservations& markers);

}  // namespace soft_robot_lab
