// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/embedding.h"

namespace soft_robot_lab {

// All nodes that carry the point are held along all axes.
inline bool held(const EmbeddedPoint& point, const FixedAxes& fixed) {
  for (std::size_t k = 0; k < point.nodes.size(); ++k)
    if (std::abs(point.weights[k]) > 1e-9 && !fixed.col(point.nodes[k]).all()) return false;
  return true;
}

}  // namespace soft_robot_lab
