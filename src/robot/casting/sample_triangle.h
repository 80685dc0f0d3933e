// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "surface.h"

namespace soft_robot_lab {

// Calls visit(point, area) for points inside a triangle, no farther apart than about `edge_m` (infinite: its centre),
// with the area that each stands for.
template <typename Visit>
void sample_triangle(const Surface& surface, int triangle, double edge_m, const Visit& visit) {
  constexpr double kMost = 2000;  // in a row, and of rows
  const auto count = [&](double length) {
    return static_cast<int>(std::clamp(std::ceil(length / edge_m), 1.0, kMost));
  };
  int base = 0;
  double longest = 0;
  for (int i = 0; i < 3; ++i) {
    const double length = (surface.corner(triangle, (i + 1) % 3) - surface.corner(triangle, i)).norm();
    if (length > longest) longest = length, base = i;
  }
  if (longest == 0) return;
  const double area = surface.areas_m2[triangle];
  const int rows = count(2 * area / longest);
  const Eigen::Vector3d a = surface.corner(triangle, base), along = surface.corner(triangle, (base + 1) % 3) - a,
                        up = surface.corner(triangle, (base + 2) % 3) - a;
  for (int row = 0; row < rows; ++row) {
    const double from = static_cast<double>(row) / rows, to = (row + 1.0) / rows;
    const double v = rows == 1 ? 1.0 / 3 : (from + to) / 2;  // a single row: through the centre
    const int columns = count((1 - v) * longest);
    const double share = area * ((1 - from) * (1 - from) - (1 - to) * (1 - to)) / columns;
    for (int i = 0; i < columns; ++i) visit(Eigen::Vector3d(a + v * up + (i + 0.5) / columns * (1 - v) * along), share);
  }
}

}  // namespace soft_robot_lab
