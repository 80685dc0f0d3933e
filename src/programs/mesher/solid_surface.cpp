// SPDX-License-Identifier: BSD-3-Clause
#include "solid_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <gmsh.h>

#include "gmsh_model.h"
#include "solid_geometry.h"
#include "stl_body.h"
#include "settings/limits.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

constexpr double kSmallestShare = 1.0 / 200;  // of the largest edge: the tip of a cone has no end
constexpr double kMostTriangles = limits::kTriangles;

struct Triangle {
  std::array<std::size_t, 3> nodes;
  int face;
  std::array<double, 3> normal;  // of the geometry at its centre; 0 where that is not known or flat anyway
};

std::vector<double> centre_of(const std::size_t* nodes) {
  std::vector<double> centre(3, 0.0), at, unused;
  for (int corner = 0; corner < 3; ++corner) {
    gmsh::model::mesh::getNode(nodes[corner], at, unused);
    for (size_t axis = 0; axis < 3; ++axis) centre[axis] += at[axis] / 3;
  }
  return centre;
}

// Normals of a face at the centres of its triangles.
std::vector<double> normals_of(int face, const std::vector<std::size_t>& nodes) {
  std::vector<double> normals(nodes.size(), 0.0), centres, parameters;
  std::string type;
  gmsh::model::getType(2, face, type);
  if (type == "Plane" || type.rfind("Discrete", 0) == 0) return normals;
  for (size_t i = 0; i + 2 < nodes.size(); i += 3) {
    const std::vector<double> centre = centre_of(&nodes[i]);
    centres.insert(centres.end(), centre.begin(), centre.end());
  }
  gmsh::model::getParametrization(2, face, centres, parameters);
  gmsh::model::getNormal(face, parameters, normals);
  return normals;
}

std::vector<Triangle> triangles_of(const gmsh::vectorpair& faces) {
  std::vector<Triangle> all;
  for (const auto& face : faces) {
    std::vector<std::size_t> tags, nodes;
    gmsh::model::mesh::getElementsByType(2, tags, nodes, face.second);
    const std::vector<double> n = normals_of(face.second, nodes);
    for (size_t i = 0; i + 2 < nodes.size(); i += 3)
      all.push_back({{nodes[i], nodes[i + 1], nodes[i + 2]}, face.second, {n[i], n[i + 1], n[i + 2]}});
  }
  return all;
}

void write_off(const std::vector<Triangle>& all, double unit_m, const std::string& path) {
  std::vector<std::size_t> tags;
  std::vector<double> positions, unused;
  gmsh::model::mesh::getNodes(tags, positions, unused);
  std::map<std::size_t, size_t> index;
  for (size_t i = 0; i < tags.size(); ++i) index[tags[i]] = i;
  std::ostringstream out;
  out.precision(17);
  out << "OFF\n" << tags.size() << " " << all.size() << " 0\n";
  for (size_t i = 0; i < positions.size(); ++i) out << positions[i] * unit_m << (i % 3 == 2 ? "\n" : " ");
  for (const Triangle& triangle : all) {
    out << 3;
    for (const std::size_t node : triangle.nodes) out << " " << index.at(node);
    out << " " << triangle.face;
    for (const double value : triangle.normal) out << " " << (std::isfinite(value) ? value : 0);
    out << "\n";
  }
  write_file(path, out.str());
}

double largest_edge(const SurfaceSizes& sizes, double units_per_metre) {
  if (sizes.edges_across == 0) return sizes.largest_edge_m * units_per_metre;
  std::array<double, 6> box;
  gmsh::model::getBoundingBox(-1, -1, box[0], box[1], box[2], box[3], box[4], box[5]);
  return std::hypot(box[3] - box[0], box[4] - box[1], box[5] - box[2]) / sizes.edges_across;
}

void set_sizes(const SurfaceSizes& sizes, double units_per_metre) {
  const double largest = largest_edge(sizes, units_per_metre);
  gmsh::option::setNumber("Mesh.MeshSizeMax", largest);
  const double smallest = sizes.smallest_edge_m * units_per_metre;
  gmsh::option::setNumber("Mesh.MeshSizeMin", smallest > 0 ? std::min(smallest, largest) : largest * kSmallestShare);
  gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
  gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", sizes.circle_segments);
}

void check_count(const gmsh::vectorpair& faces, double largest) {
  double area = 0;
  for (const auto& face : faces) {
    double mass = 0;
    gmsh::model::occ::getMass(2, face.second, mass);
    area += mass;
  }
  const double count = 2.3 * area / (largest * largest);
  if (count <= kMostTriangles) return;
  throw std::invalid_argument("largest_edge_m asks for about " + std::to_string(static_cast<long>(count)) +
                              " triangles, at most 1000000 are made; choose a larger one");
}

}  // namespace

void write_surface(const Solid& solid, const SurfaceSizes& sizes, const std::string& path) {
  const GmshSession session;
  gmsh::model::add("surface");
  if (is_stl_body(solid)) {
    merge_stl(solid);
    gmsh::vectorpair faces;
    gmsh::model::getEntities(faces, 2);
    const std::vector<Triangle> all = triangles_of(faces);
    if (all.empty()) throw std::invalid_argument(stl_file(solid) + ": holds no triangles");
    return write_off(all, 1.0, path);
  }
  const int body = build_body(solid);
  gmsh::vectorpair faces;
  gmsh::model::getBoundary({{3, body}}, faces, false, false, false);
  check_count(faces, largest_edge(sizes, kKernelUnitsPerMetre));
  set_sizes(sizes, kKernelUnitsPerMetre);
  gmsh::model::mesh::generate(2);
  write_off(triangles_of(faces), 1 / kKernelUnitsPerMetre, path);
}

void write_step(const Solid& solid, const std::string& path) {
  if (is_stl_body(solid)) throw std::invalid_argument(stl_file(solid) + ": an STL body has no STEP");
  const GmshSession session;
  gmsh::model::add("step");
  build_body(solid);
  gmsh::write(path);
}

}  // namespace soft_robot_lab
