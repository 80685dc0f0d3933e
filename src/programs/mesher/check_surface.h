// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace soft_robot_lab {

// Whether triangles bound one body, perhaps with hollows: every edge has two facets, none stands twice, none cuts
// another by more than a millionth of the size, hollows face inward and lie apart. Vertices are welded already. Throws
// std::invalid_argument with the first place; of cuts with that where most of them meet.
void check_surface(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& facets);

}  // namespace soft_robot_lab
