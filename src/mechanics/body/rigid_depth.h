// SPDX-License-Identifier: BSD-3-Clause
// How deep two rigid shapes are in one another, by what they are and not by the places where contact looks: it says
// whether contact has kept them apart.
//   plane           by how far the other reaches
//   convex shapes   by planes between them, and where none of a few is near enough as exactly as apart_m
//   meshes          by such planes too, else by corners, edges and rims of either that are in the other, and by a place
//                   that is in both
#pragma once

#include "rigid_places.h"

namespace soft_robot_lab {

// A tenth of half the lesser of their least extents; of meshes half the rounding of their edges more.
double allowed_overlap_m(const ObstacleShape& one, const ObstacleShape& other);

// 0: no deeper than that. The first is no plane.
double depth_beyond_m(const PlacedShape& one, const PlacedShape& other, double allowed_m);

}  // namespace soft_robot_lab
