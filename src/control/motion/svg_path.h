// SPDX-License-Identifier: BSD-3-Clause
// The path data of SVG (W3C, SVG 2, 9.3): what stands in the attribute `d` of a path.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// As a chain of points in SVG's own unit, y down: straight pieces, and curves cut into as many. One stroke of M, L, H,
// V, C, S, Q, T and Z, large or small. Throws std::invalid_argument, which says what is wrong and at which character: a
// second M, as a marker cannot be lifted; arcs; more than 500 pieces; what is no path data.
std::vector<Eigen::Vector2d> svg_points(const std::string& d);

}  // namespace soft_robot_lab
