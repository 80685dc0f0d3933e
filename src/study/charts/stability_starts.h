// SPDX-License-Identifier: BSD-3-Clause
// Bad meshes and bad starts. Held nodes stay where they are.
#pragma once

#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// Puts a node into every `every`th element, this share of its height above one of its faces: one flat element more, and
// three of common shape. The nodes lie on straight edges afterwards.
void add_slivers(TetMesh& mesh, double height, int every);

// Every node anywhere in the rest bounding box, from a fixed seed.
void scramble(const Body& body, Eigen::Matrix3Xd& positions_m);

// Onto the plane, line and point through the middle of the rest bounding box; the plane and the line hold its shortest
// and its longest direction apart: the plane is that of the two longer directions, the line that of the longest.
void collapse_to_plane(const Body& body, Eigen::Matrix3Xd& positions_m);
void collapse_to_line(const Body& body, Eigen::Matrix3Xd& positions_m);
void collapse_to_point(const Body& body, Eigen::Matrix3Xd& positions_m);

// Pressed together along its longest direction into slices of a fifth of it, so that via points in a slice coincide.
void collapse_spans(const Body& body, Eigen::Matrix3Xd& positions_m);

// Mirrored in that plane, so that every free element is inverted.
void mirror(const Body& body, Eigen::Matrix3Xd& positions_m);

}  // namespace soft_robot_lab
