// SPDX-License-Identifier: BSD-3-Clause
#include "convex_hull.h"

#include <opencv2/imgproc.hpp>

namespace soft_robot_lab {

std::vector<std::size_t> convex_hull(const std::vector<Eigen::Vector2d>& points) {
  std::vector<cv::Point2f> all;
  for (const Eigen::Vector2d& point : points)
    all.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()));
  std::vector<int> hull;
  if (!all.empty()) cv::convexHull(all, hull, false, false);
  return {hull.begin(), hull.end()};
}

}  // namespace soft_robot_lab
