// SPDX-License-Identifier: BSD-3-Clause
#include "moved_bends.h"

#include <cmath>
#include <vector>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr double kStep = 6;  // of a sheath's radius: paths have kinks where they pass from element to element

double length_m(const std::vector<Eigen::Vector3d>& points_m) {
  double length = 0;
  for (size_t i = 0; i + 1 < points_m.size(); ++i) length += (points_m[i + 1] - points_m[i]).norm();
  return length;
}

// Where the spans of a cable's path run in the solid, as ranges of points.
struct Embedded {
  std::string cable;
  int actuator;
  size_t first, last;
  double radius_m;
};

std::vector<Embedded> embedded_pieces(const Simulation& simulation, const RayTree& solid,
                                      const std::vector<SheathPath>& sheaths) {
  std::vector<Embedded> pieces;
  for (const SheathPath& sheath : sheaths) {
    const int actuator = simulation.model()->actuator_index(sheath.name);
    const std::vector<Eigen::Vector3d> path_m = simulation.actuator_state(actuator).path_m;
    bool inside = false;
    for (size_t i = 0; i + 1 < path_m.size(); ++i) {
      const bool next = is_inside(solid, 0.5 * (path_m[i] + path_m[i + 1]));
      if (next && !inside) pieces.push_back({sheath.name, actuator, i, i, sheath.radius_m});
      if (next) pieces.back().last = i + 1;
      inside = next;
    }
  }
  return pieces;
}

WorstAlong tightest_now(const Simulation& simulation, const std::vector<Embedded>& pieces) {
  WorstAlong worst;
  for (const Embedded& piece : pieces) {
    const std::vector<Eigen::Vector3d> path_m = simulation.actuator_state(piece.actuator).path_m;
    const auto at = [&](size_t i) { return path_m.begin() + static_cast<std::ptrdiff_t>(i); };
    const WorstAlong arc =
        tightest_arc({piece.cable, {at(piece.first), at(piece.last + 1)}, piece.radius_m}, kStep * piece.radius_m);
    if (arc.worst_m < worst.worst_m) worst = arc;
  }
  return worst;
}

bool is_pulled(const Actuator& actuator) { return actuator.limits().unit == "1" && actuator.limits().rest == 1.0; }

}  // namespace

WorstAlong tightest_arc(const SheathPath& path, double step_m) {
  WorstAlong worst;
  const double length = length_m(path.points_m);
  const int steps = static_cast<int>(std::floor(4 * (length - 2 * step_m) / step_m));
  for (int i = 0; i <= steps; ++i) {
    const double from_m = i * step_m / 4;
    const Eigen::Vector3d a = point_along(path.points_m, from_m), b = point_along(path.points_m, from_m + step_m),
                          c = point_along(path.points_m, from_m + 2 * step_m);
    const double twice_area = (b - a).cross(c - a).norm();
    if (twice_area < 1e-9 * step_m * step_m) continue;
    const double radius = (b - a).norm() * (c - b).norm() * (c - a).norm() / (2 * twice_area);
    if (radius < worst.worst_m) worst = {radius, b, path.name, ""};
  }
  return worst;
}

WorstAlong tightest_moved_bend(Simulation& simulation, const RayTree& solid, const std::vector<SheathPath>& sheaths) {
  WorstAlong worst;
  for (const auto& actuator : simulation.actuators())
    if (!actuator->why_no_equilibrium().empty()) return worst;
  simulation.reset();
  const std::vector<Embedded> pieces = embedded_pieces(simulation, solid, sheaths);
  for (const auto& actuator : simulation.actuators()) {
    if (!is_pulled(*actuator)) continue;
    simulation.reset();
    simulation.set_command(actuator->name(), actuator->limits().min);
    if (!simulation.solve_equilibrium().converged) continue;
    WorstAlong now = tightest_now(simulation, pieces);
    now.other = actuator->name();
    if (now.worst_m < worst.worst_m) worst = now;
  }
  simulation.reset();
  return worst;
}

}  // namespace soft_robot_lab
