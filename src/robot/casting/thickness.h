// SPDX-License-Identifier: BSD-3-Clause
// How thick a solid is, in two ways that fail in different places.
#pragma once

#include <limits>
#include <vector>

#include "ray_tree.h"

namespace soft_robot_lab {

struct ThinPlace {
  double worst_m = std::numeric_limits<double>::infinity();  // infinite: nothing found
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d opposite_m = Eigen::Vector3d::Zero();
  double area_m2 = 0;  // of the skin that is thinner than the limit
};

struct Thickness {
  ThinPlace ball;                 // largest balls that touch the skin from inside at two sides
  ThinPlace cone;                 // the source's: see measure_thickness
  std::vector<double> of_facets;  // by balls, the least of each triangle's samples; infinite where no ball fits
};

// The ball: tangent at p inside, through q where the angle between both from its centre is above 120 degrees, so that
// right-angled edges are not thin and knife edges below 60 degrees are; t = min |q - p|^2 / (m . (q - p)) over a cone
// of rays of 30 degrees. Exact for plates, rods and the walls of tubes. `limit_m` > 0.
// The cone: skin within the limit that no path on the skin inside that ball leads to. As in the source, surfaces that
// meet p's at an edge make no back side; but here they do where their normals differ by more than 120 degrees.
Thickness measure_thickness(const RayTree& tree, double limit_m);

// By balls alone, from samples half the limit apart: for parts of a mould, which are stiff.
ThinPlace measure_balls(const RayTree& tree, double limit_m);

}  // namespace soft_robot_lab
