// SPDX-License-Identifier: BSD-3-Clause
#include "marker_frames.h"

#include "conversions.h"

namespace soft_robot_lab {

MarkerFrame seen_frame(const MarkerObservations& markers) {
  MarkerFrame frame{markers.header.stamp.toSec(), {}};
  for (size_t i = 0; i < markers.names.size(); ++i)
    if (markers.sources.at(i) == MarkerObservations::SEEN)
      frame.seen.push_back({markers.names[i], from_message(markers.positions.at(i), "positions")});
  return frame;
}

std::vector<Eigen::Vector3d> raw_positions_m(const MarkerObservations& markers) {
  std::vector<Eigen::Vector3d> positions_m;
  for (const geometry_msgs::Point& position : markers.positions)
    positions_m.emplace_back(position.x, position.y, position.z);
  return positions_m;
}

}  // namespace soft_robot_lab
