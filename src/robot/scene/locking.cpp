// SPDX-License-Identifier: BSD-3-Clause
#include "locking.h"

#include <algorithm>
#include <sstream>

#include "scene_warning.h"

namespace soft_robot_lab {
namespace {

constexpr double kLocks = 0.4;  // Poisson's ratio from which on

double largest_poissons_ratio(const Body& body) {
  double largest = body.material_of(0).poissons_ratio;
  for (int tet = 1; tet < body.mesh().tet_count(); ++tet)
    largest = std::max(largest, body.material_of(tet).poissons_ratio);
  return largest;
}

}  // namespace

std::vector<SolveWarning> locking_warnings(const Body& body) {
  if (body.mesh().quadratic() || body.linear_volume() != LinearVolume::element) return {};
  const double ratio = largest_poissons_ratio(body);
  if (ratio < kLocks) return {};
  std::ostringstream text;
  text << "linear elements are too stiff at a Poisson's ratio of " << ratio << ": from " << kLocks
       << " on they lock; set body.element to quadratic";
  return {scene_warning("locking_elements", text.str(), ratio)};
}

}  // namespace soft_robot_lab
