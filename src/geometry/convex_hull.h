// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// The corners of the convex hull in single precision, counter-clockwise, as indices; of points on a line its ends.
std::vector<std::size_t> convex_hull(const std::vector<Eigen::Vector2d>& points);

}  // namespace soft_robot_lab
