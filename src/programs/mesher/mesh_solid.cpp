// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmsh.h>

#include "gmsh_model.h"
#include "solid_geometry.h"
#include "stl_body.h"
#include "surface_names.h"
#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {
namespace {

constexpr double kStlCorner = 40 * M_PI / 180;  // STL facets that meet at more than this angle are different surfaces

void generate(bool quadratic) {
  gmsh::option::setNumber("Mesh.Algorithm3D", 1);  // Delaunay: HXT (10) is faster, but differs from run to run
  gmsh::option::setNumber("Mesh.Optimize", 1);
  gmsh::model::mesh::generate(3);
  gmsh::model::mesh::optimize("Relocate3D");
  if (quadratic) gmsh::model::mesh::setOrder(2);
}

// Where a coarse element on a strongly curved surface folds, its mid-edge nodes move towards straight edges.
void untangle(TetMesh& mesh) {
  constexpr int kHalvings = 6;  // then straight at once
  for (int round = 0;; ++round) {
    const std::vector<int> folded = folded_elements(mesh);
    if (folded.empty() || round > kHalvings + mesh.tet_count()) return;
    std::vector<bool> done(static_cast<size_t>(mesh.node_count()), false);
    for (const int tet : folded) {
      for (int e = 0; e < 6; ++e) {
        const int node = mesh.tets(4 + e, tet);
        if (done[static_cast<size_t>(node)]) continue;
        done[static_cast<size_t>(node)] = true;
        const Eigen::Vector3d straight =
            (mesh.nodes_m.col(mesh.tets(kTetEdges[e][0], tet)) + mesh.nodes_m.col(mesh.tets(kTetEdges[e][1], tet))) / 2;
        mesh.nodes_m.col(node) = round < kHalvings ? (mesh.nodes_m.col(node) + straight).eval() / 2 : straight;
      }
    }
  }
}

// Gmsh looks for ever for curves that part a patch of a single triangle on a surface as small as a tetrahedron's. Cut
// into four, each triangle keeps its plane.
void cut_few_triangles() {
  constexpr size_t kFew = 100;
  std::vector<std::size_t> tags, nodes;
  gmsh::model::mesh::getElementsByType(2, tags, nodes);
  if (!tags.empty() && tags.size() < kFew) gmsh::model::mesh::refine();
}

enum class Facets { patches, as_they_are };

// Large ones are halved until they are no longer than elements.
void halve_facets(double element_size_m) {
  constexpr size_t kMost = 100000;
  for (;;) {
    std::vector<std::size_t> tags, nodes;
    gmsh::model::mesh::getElementsByType(2, tags, nodes);
    std::vector<double> edges_m;
    for (size_t i = 0; i + 2 < nodes.size(); i += 3) {
      std::vector<double> a, b, unused;
      gmsh::model::mesh::getNode(nodes[i], a, unused);
      gmsh::model::mesh::getNode(nodes[i + 1], b, unused);
      edges_m.push_back(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
    }
    if (edges_m.empty() || edges_m.size() > kMost) return;
    std::nth_element(edges_m.begin(), edges_m.begin() + static_cast<long>(edges_m.size() / 2), edges_m.end());
    if (edges_m[edges_m.size() / 2] <= 1.5 * element_size_m) return;
    gmsh::model::mesh::refine();
  }
}

// The triangles of the file are cut into patches, each meshed anew through its parametrisation; or they stay the
// skin's. One unit is a metre.
std::vector<NamedEntities> build_stl(const Solid& solid, const MeshSizes& sizes, Facets facets) {
  merge_stl(solid);
  if (facets == Facets::patches) {
    cut_few_triangles();
    gmsh::model::mesh::classifySurfaces(kStlCorner, true, true, M_PI);
    gmsh::model::mesh::createGeometry();
  } else {
    halve_facets(sizes.element_size_m);
  }
  gmsh::vectorpair surfaces;
  gmsh::model::getEntities(surfaces, 2);
  if (surfaces.empty()) throw std::invalid_argument(stl_file(solid) + ": holds no triangles");
  NamedEntities all{stl_name(solid), {}};
  for (const auto& surface : surfaces) all.entities.push_back(surface.second);
  gmsh::model::geo::addVolume({gmsh::model::geo::addSurfaceLoop(all.entities)});
  gmsh::model::geo::synchronize();
  const std::vector<NamedEntities> named(all.name.empty() ? 0 : 1, all);
  set_sizes(sizes, 1.0, named);
  return named;
}

TetMesh mesh_facets(const Solid& solid, const MeshSizes& sizes, Facets facets) {
  const std::vector<NamedEntities> surfaces = build_stl(solid, sizes, facets);
  double box[6];
  gmsh::model::getBoundingBox(-1, -1, box[0], box[1], box[2], box[3], box[4], box[5]);
  check_count((box[3] - box[0]) * (box[4] - box[1]) * (box[5] - box[2]) / 4, sizes, true);
  generate(sizes.quadratic);
  return extract_mesh(surfaces, {}, 1.0);
}

// A smooth surface with several holes has no parametrisation that Gmsh finds; its sound facets bound the body as well.
TetMesh mesh_stl(const Solid& solid, const MeshSizes& sizes) {
  try {
    return mesh_facets(solid, sizes, Facets::patches);
  } catch (const std::string&) {
    gmsh::clear();
    gmsh::model::add("body");
    return mesh_facets(solid, sizes, Facets::as_they_are);
  }
}

// Surfaces get their names from their triangles: where sizes depend on names, they are meshed before, at any size.
std::vector<NamedEntities> name_before_meshing(const gmsh::vectorpair& volumes, const Solid& solid,
                                               const MeshSizes& sizes) {
  if (!sizes.name_surfaces()) return {};
  gmsh::model::mesh::generate(2);
  std::vector<NamedEntities> surfaces = name_surfaces(volumes, solid);
  gmsh::model::mesh::clear();
  return surfaces;
}

TetMesh mesh_kernel_solid(const Solid& solid, const MeshSizes& sizes, const std::vector<std::string>& names) {
  const int body = build_body(solid);
  double volume = 0;
  gmsh::model::occ::getMass(3, body, volume);
  check_count(volume / std::pow(kKernelUnitsPerMetre, 3), sizes, names_file(solid));
  const std::vector<NamedEntities> regions = cut_body(body, solid, names);
  gmsh::vectorpair volumes;
  gmsh::model::getEntities(volumes, 3);
  set_sizes(sizes, kKernelUnitsPerMetre, name_before_meshing(volumes, solid, sizes));
  generate(false);
  const std::vector<NamedEntities> surfaces = name_surfaces(volumes, solid);
  if (sizes.quadratic) gmsh::model::mesh::setOrder(2);
  return extract_mesh(surfaces, regions, 1 / kKernelUnitsPerMetre);
}

}  // namespace

TetMesh mesh_solid(const Solid& solid, const MeshSizes& sizes, const std::vector<std::string>& regions) {
  const GmshSession session;
  gmsh::model::add("body");
  TetMesh mesh = is_stl_body(solid) ? mesh_stl(solid, sizes) : mesh_kernel_solid(solid, sizes, regions);
  if (mesh.quadratic()) untangle(mesh);
  return mesh;
}

}  // namespace soft_robot_lab
