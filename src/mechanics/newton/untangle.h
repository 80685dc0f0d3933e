// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// What untangle() laid out anew.
struct Untangled {
  std::vector<int> elements;  // of the patches; empty where nothing was inverted
  std::vector<int> nodes;     // those that moved
};

// Elements rest inverted where the polynomial energy lets them, which silicone cannot. Lays them out anew with all that
// lies within `rings` elements of them: the free nodes inside such a patch go to where |F - R|^2 is least, R being the
// turn of the patch's rim. Of a patch that spans the body only held nodes are the rim: that is the rest shape.
Untangled untangle(const Body& body, int rings, Eigen::Matrix3Xd& positions_m);

}  // namespace soft_robot_lab
