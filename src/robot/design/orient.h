// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace soft_robot_lab {

// Turns triangles so that neighbours agree, the largest shell faces out and those inside it face in, as for a body in
// one piece. A geometry kernel's faces have orientations of their own. What is not closed stays so.
void orient(const Eigen::Matrix3Xd& vertices_m, Eigen::Matrix3Xi& triangles);

}  // namespace soft_robot_lab
