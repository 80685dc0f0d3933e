// SPDX-License-Identifier: BSD-3-Clause
// How sharp the edges of a surface are, at the scale of a radius: what is rounded by less counts as sharp.
#pragma once

#include "ray_tree.h"

namespace soft_robot_lab {

struct SharpEdge {
  double opening_deg = 180;  // of a notch: seen from outside; of a wedge: of the solid
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  double length_m = 0;  // of edges sharper than the limit
};

struct EdgeAngles {
  SharpEdge notch, wedge;
};

// The opening is 180 degrees less the largest angle between the normals of triangles that paths on the skin, no farther
// from the edge than the radius, lead to; so a notch that facets round is as sharp as its sides. `limit_deg`: [0, 180].
EdgeAngles measure_angles(const Surface& surface, double radius_m, double limit_deg);

}  // namespace soft_robot_lab
