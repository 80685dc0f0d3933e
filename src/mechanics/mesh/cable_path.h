// SPDX-License-Identifier: BSD-3-Clause
// The way of a cable at rest, as its settings have it.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

struct CablePath {
  std::string key;                        // points_m, path_m or spline_m
  std::vector<Eigen::Vector3d> points_m;  // straight between them; of spline_m points on the curve

  bool routes_itself() const { return key != "points_m"; }
};

// Exactly one of the keys stands there. Throws SettingsError.
CablePath read_cable_path(const YamlNode& cable);

// Where point i of such a path stands in the file, for a message about it.
YamlNode place_of(std::size_t i, const CablePath& path, const YamlNode& cable);

// Points on the cubic B-spline (of lower degree below four points) with these control points and even knots, from the
// first control point to the last (Piegl and Tiller, The NURBS Book, algorithm A3.1). Between two neighbours the curve
// bulges by `sagitta_m` at most.
std::vector<Eigen::Vector3d> points_on_spline(const std::vector<Eigen::Vector3d>& control_m, double sagitta_m);

}  // namespace soft_robot_lab
