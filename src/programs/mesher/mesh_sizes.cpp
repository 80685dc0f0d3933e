// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_sizes.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <gmsh.h>

#include "mechanics/linear_algebra/block_cholesky.h"
#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

namespace field = gmsh::model::mesh::field;

constexpr double kGrowth = 0.4;     // of element size per distance, around refinements
constexpr double kMostCurved = 10;  // curvature makes elements this much smaller at most: the tip of a cone has no end
constexpr double kMostElements = limits::kElements;
constexpr double kLargestRobot_m3 = 1.0;  // whoever exceeds it by far has written millimetres
// What an element takes until it is known what its factorisation will, measured: its share of nodes, and of a matrix.
constexpr double kQuadraticElement_kb = 6.5, kLinearElement_kb = 2.0;
constexpr double kElementsPerCube = 8.5;  // of a cube with the edge of an element; regular ones fill it 1 / 0.118 times
constexpr double kSamples = 200;          // along a curve, and along both ways of a surface

// A ball of small elements that grow outside of it with the distance.
int add_ball(const MeshRefinement& refinement, double units_per_metre, double element_size_m) {
  const int ball = field::add("Ball");
  const auto set = [&](const char* key, double value_m) { field::setNumber(ball, key, value_m * units_per_metre); };
  set("XCenter", refinement.center_m.x());
  set("YCenter", refinement.center_m.y());
  set("ZCenter", refinement.center_m.z());
  set("Radius", refinement.radius_m);
  set("VIn", refinement.size_m);
  set("VOut", element_size_m);
  set("Thickness", (element_size_m - refinement.size_m) / kGrowth);
  return ball;
}

const std::vector<int>& entities_of(const std::string& name, const std::vector<NamedEntities>& surfaces) {
  std::string known;
  for (const NamedEntities& surface : surfaces) {
    if (surface.name == name) return surface.entities;
    known += (known.empty() ? "" : ", ") + surface.name;
  }
  throw std::invalid_argument("refinements: the solid has no surface '" + name +
                              "'; known: " + (known.empty() ? "none" : known));
}

std::vector<double> edges_of(const std::vector<int>& surfaces) {
  gmsh::vectorpair sides, edges;
  for (const int surface : surfaces) sides.emplace_back(2, surface);
  gmsh::model::getBoundary(sides, edges, false, false, false);
  std::vector<double> tags;
  for (const auto& edge : edges) tags.push_back(edge.second);
  return tags;
}

// Small elements on surfaces, or on their edges, that grow with the distance from them. Gmsh carries the size on an
// edge into the faces beside it, so these stay fine too.
int add_distance(const MeshRefinement& refinement, const std::vector<int>& surfaces, double units_per_metre,
                 double element_size_m) {
  const int distance = field::add("Distance");
  if (refinement.edges_only) {
    field::setNumbers(distance, "EdgesList", edges_of(surfaces));
  } else {
    field::setNumbers(distance, "FacesList", {surfaces.begin(), surfaces.end()});
  }
  field::setNumber(distance, "NNodesByEdge", kSamples);
  const int size = field::add("Threshold");
  field::setNumber(size, "IField", distance);
  field::setNumber(size, "LcMin", refinement.size_m * units_per_metre);
  field::setNumber(size, "LcMax", element_size_m * units_per_metre);
  field::setNumber(size, "DistMin", 0);
  field::setNumber(size, "DistMax", (element_size_m - refinement.size_m) / kGrowth * units_per_metre);
  return size;
}

}  // namespace

bool MeshSizes::name_surfaces() const {
  return std::any_of(refinements.begin(), refinements.end(), [](const auto& r) { return !r.surface.empty(); });
}

void check_count(double volume_m3, const MeshSizes& sizes, bool of_file) {
  double count = kElementsPerCube * volume_m3 / std::pow(sizes.element_size_m, 3);
  for (const MeshRefinement& r : sizes.refinements) {
    const double ball_m3 = 4.0 / 3.0 * M_PI * std::pow(r.radius_m, 3);
    count += kElementsPerCube * std::min(ball_m3, volume_m3) / std::pow(r.size_m, 3);
  }
  const double needed_gb = 1e-6 * count * (sizes.quadratic ? kQuadraticElement_kb : kLinearElement_kb);
  if (count <= kMostElements && needed_gb <= kMostMemory_gb) return;
  std::ostringstream message;
  message << "element_size_m " << sizes.element_size_m << " and refinements ask for about " << count
          << " elements, which take " << needed_gb << " GB; at most " << kMostElements << " elements and "
          << kMostMemory_gb << " GB are taken; choose larger ones" << (sizes.quadratic ? ", or element: linear" : "");
  if (volume_m3 > kLargestRobot_m3)
    message << "; or are the numbers of a " << (of_file ? "file" : "solid") << " of " << volume_m3
            << " m3 millimetres? "
            << (of_file ? "`scale: 0.001` of the body makes them metres"
                        : "write metres, or put it into `scale: {factor: 0.001, solid: ...}`");
  throw std::invalid_argument(message.str());
}

void set_sizes(const MeshSizes& sizes, double units_per_metre, const std::vector<NamedEntities>& surfaces) {
  gmsh::option::setNumber("Mesh.MeshSizeMax", sizes.element_size_m * units_per_metre);
  gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
  // Elements around a full circle: curved ones keep its area to 0.1 %, straight ones to 5 %.
  gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", sizes.quadratic ? 6 : 12);
  double smallest_m = sizes.element_size_m / kMostCurved;
  std::vector<double> fields;
  for (const MeshRefinement& refinement : sizes.refinements) {
    smallest_m = std::min(smallest_m, refinement.size_m);
    std::vector<int> entities;
    if (!refinement.surface.empty()) entities = entities_of(refinement.surface, surfaces);
    if (refinement.size_m >= sizes.element_size_m) continue;
    fields.push_back(refinement.surface.empty()
                         ? add_ball(refinement, units_per_metre, sizes.element_size_m)
                         : add_distance(refinement, entities, units_per_metre, sizes.element_size_m));
  }
  gmsh::option::setNumber("Mesh.MeshSizeMin", smallest_m * units_per_metre);
  if (fields.empty()) return;
  const int smallest = field::add("Min");
  field::setNumbers(smallest, "FieldsList", fields);
  field::setAsBackgroundMesh(smallest);
}

}  // namespace soft_robot_lab
