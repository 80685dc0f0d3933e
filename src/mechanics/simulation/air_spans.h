// SPDX-License-Identifier: BSD-3-Clause
// Cables that are in the air at rest, and may be in silicone once the body has moved: they are straight from point to
// point, and feel no skin.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/actuator.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

class AirSpans {
 public:
  // The spans of these actuators' paths that are not all in silicone at rest.
  AirSpans(const Body& body, const std::vector<std::unique_ptr<const Actuator>>& actuators);

  // A warning `cable_in_silicone` for each actuator of which a span is longer in silicone than at rest: by more than a
  // tenth of the span and a quarter of an element's edge, beyond what the span has stretched, and deeper below the skin
  // than a twentieth of that edge. Its size is that depth [m]. A path that has found another way around obstacles since
  // is not looked at. `present`: the mesh with its nodes where they are now; `paths_m`: of all actuators there.
  std::vector<SolveWarning> in_silicone(const TetMesh& mesh, const TetMesh& present,
                                        const std::vector<std::vector<Eigen::Vector3d>>& paths_m) const;

 private:
  struct Span {
    std::size_t first = 0;  // of the path's points
    double length_m = 0.0, inside_m = 0.0;
  };
  struct Route {
    std::string name;
    std::size_t point_count = 0;
    std::vector<Span> spans;
  };

  std::vector<Route> routes_;  // of all actuators
};

}  // namespace soft_robot_lab
