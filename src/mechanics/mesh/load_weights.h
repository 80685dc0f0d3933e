// SPDX-License-Identifier: BSD-3-Clause
// How loads on a face are shared among its nodes: by the integrals of the nodes' shape functions, so that their work is
// that of the load on the material. Of a straight quadratic face a corner then has nothing, a mid-edge a third.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

double rest_volume_m3(const TetMesh& mesh, int element);

// Of each node of a face over the part of its rest area that lies in the box [m^2]. A corner that is no further than
// `on_side_m` from one of the box's sides counts as on it: boxes are a little larger than the skin that they are meant
// for. Curved faces are cut along 64 flat triangles.
Eigen::VectorXd face_weights_m2(const TetMesh& mesh, Eigen::Index face, const Eigen::AlignedBox3d& box,
                                double on_side_m);

}  // namespace soft_robot_lab
