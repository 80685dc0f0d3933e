// SPDX-License-Identifier: BSD-3-Clause
// Whether a rigid robot leaves an open mould by one translation, and in which direction best.
// Bose, Halperin, Shamai 2017; two parts: Khardekar, Burton, McMains 2006.
#pragma once

#include <optional>
#include <vector>

#include "ray_tree.h"

namespace soft_robot_lab {

// A plane of the convex hull that triangles lie in: silicone can be open to air there.
struct HullPlane {
  Eigen::Vector3d normal;
  double offset_m = 0;  // normal . x
  double area_m2 = 0;
  std::vector<int> triangles;
};

// The largest first, those that no direction could use left out: a top must be as large as the robot's shadow.
std::vector<HullPlane> find_tops(const Surface& surface);

// A surface with what the rules ask of it again and again, made once.
struct CastShape {
  explicit CastShape(const Surface& surface) : tree(surface), tops(find_tops(surface)) {}  // keeps a reference

  const Surface& surface() const { return tree.surface(); }

  RayTree tree;
  std::vector<HullPlane> tops;
};

struct Extraction {
  bool passed = false;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // unit
  double draft_deg = 0;                                 // the least of all sides: negative where one is in the way
  double top_area_m2 = 0;                               // open to air; 0 where no face can be
  Eigen::Vector3d top_normal = Eigen::Vector3d::Zero();
  double blocked_area_m2 = 0;
  double undercut_volume_m3 = 0;                   // of the mould above those facets
  double trap_depth_m = 0;                         // the deepest
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();  // there
  std::vector<int> blocked;                        // triangles in the way
};

// A direction is given, the top that leaves the least in the way is chosen. Facets of closed cavities do not count.
Extraction verify_extraction(const CastShape& shape, const Eigen::Vector3d& direction);

// The direction with most draft of all sides. Nothing where none lets the robot out.
std::optional<Eigen::Vector3d> best_direction(const Surface& surface, const std::vector<HullPlane>& tops);

// Where none does: the direction with the least area in the way among the tops' normals, the axes and a sphere's
// points.
Eigen::Vector3d least_blocked_direction(const Surface& surface, const std::vector<HullPlane>& tops);

// Two halves drawn along +direction and -direction: what neither reaches.
struct TwoPart {
  bool passed = false;
  double blocked_area_m2 = 0;
  double undercut_volume_m3 = 0;
};
TwoPart verify_two_parts(const RayTree& tree, const Eigen::Vector3d& direction);

}  // namespace soft_robot_lab
