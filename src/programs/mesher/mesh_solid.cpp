#include "programs/mesher/mesh_solid.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include <gmsh.h>

#include "programs/mesher/gmsh_model.h"
#include "programs/mesher/solid_geometry.h"
#include "programs/mesher/surface_names.h"
#include "sim/tet_faces.h"

namespace soft_robot_lab {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kGrowth = 0.4;     // of element size per distance, around refinements
constexpr double kMostCurved = 10;  // curvature makes elements this much smaller at most: the tip of a cone has no end
constexpr double kMostElements = 2e6;     // beyond, memory and time are not those of a robot
constexpr double kElementsPerCube = 8.5;  // of a cube with the edge of an element; regular ones fill it 1 / 0.118 times
constexpr double kStlCorner = 40 * kPi / 180;  // STL facets that meet at more than this angle are different surfaces

void check_count(double volume_m3, const MeshSizes& sizes) {
  double count = kElementsPerCube * volume_m3 / std::pow(sizes.element_size_m, 3);
  for (const MeshRefinement& r : sizes.refinements) {
    const double ball_m3 = 4.0 / 3.0 * kPi * std::pow(r.radius_m, 3);
    count += kElementsPerCube * std::min(ball_m3, volume_m3) / std::pow(r.size_m, 3);
  }
  if (count <= kMostElements) return;
  std::ostringstream message;
  message << "element_size_m " << sizes.element_size_m << " and refinements ask for about " << count
          << " elements, at most " << kMostElements << " are made; choose larger ones";
  throw std::invalid_argument(message.str());
}

// A ball of small elements that grow outside of it with the distance.
int add_ball(const MeshRefinement& refinement, double units_per_metre, double element_size_m) {
  namespace field = gmsh::model::mesh::field;
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

void set_sizes(const MeshSizes& sizes, double units_per_metre) {
  gmsh::option::setNumber("Mesh.MeshSizeMax", sizes.element_size_m * units_per_metre);
  gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
  // Elements around a full circle: curved ones keep its area to 0.1 %, straight ones to 5 %.
  gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", sizes.quadratic ? 6 : 12);
  double smallest_m = sizes.element_size_m / kMostCurved;
  std::vector<double> balls;
  for (const MeshRefinement& refinement : sizes.refinements) {
    smallest_m = std::min(smallest_m, refinement.size_m);
    if (refinement.size_m >= sizes.element_size_m) continue;
    balls.push_back(add_ball(refinement, units_per_metre, sizes.element_size_m));
  }
  gmsh::option::setNumber("Mesh.MeshSizeMin", smallest_m * units_per_metre);
  if (balls.empty()) return;
  const int smallest = gmsh::model::mesh::field::add("Min");
  gmsh::model::mesh::field::setNumbers(smallest, "FieldsList", balls);
  gmsh::model::mesh::field::setAsBackgroundMesh(smallest);
}

void generate(bool quadratic) {
  gmsh::option::setNumber("Mesh.Algorithm3D", 1);  // Delaunay: HXT (10) is faster, but differs from run to run
  gmsh::option::setNumber("Mesh.Optimize", 1);
  gmsh::model::mesh::generate(3);
  gmsh::model::mesh::optimize("Relocate3D");
  if (quadratic) gmsh::model::mesh::setOrder(2);
}

// Where a coarse element on a strongly curved surface folds, its mid-edge nodes move towards straight edges.
void unfold(TetMesh& mesh) {
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

// The triangles of the file are cut into patches, each meshed anew through its parametrisation. One unit is a metre.
std::vector<NamedSurface> build_stl(const Solid& solid, const MeshSizes& sizes) {
  gmsh::merge(solid.file);
  gmsh::model::mesh::classifySurfaces(kStlCorner, true, true, kPi);
  gmsh::model::mesh::createGeometry();
  gmsh::vectorpair surfaces;
  gmsh::model::getEntities(surfaces, 2);
  if (surfaces.empty()) throw std::invalid_argument(solid.file + ": holds no triangles");
  NamedSurface all{solid.name, {}};
  for (const auto& surface : surfaces) all.entities.push_back(surface.second);
  gmsh::model::geo::addVolume({gmsh::model::geo::addSurfaceLoop(all.entities)});
  gmsh::model::geo::synchronize();
  set_sizes(sizes, 1.0);
  return solid.name.empty() ? std::vector<NamedSurface>{} : std::vector<NamedSurface>{all};
}

TetMesh mesh_stl(const Solid& solid, const MeshSizes& sizes) {
  const std::vector<NamedSurface> surfaces = build_stl(solid, sizes);
  double box[6];
  gmsh::model::getBoundingBox(-1, -1, box[0], box[1], box[2], box[3], box[4], box[5]);
  check_count((box[3] - box[0]) * (box[4] - box[1]) * (box[5] - box[2]) / 4, sizes);
  generate(sizes.quadratic);
  return extract_mesh(surfaces, 1.0);
}

TetMesh mesh_kernel_solid(const Solid& solid, const MeshSizes& sizes) {
  const int body = build_body(solid);
  double volume = 0;
  gmsh::model::occ::getMass(3, body, volume);
  check_count(volume / std::pow(kKernelUnitsPerMetre, 3), sizes);
  set_sizes(sizes, kKernelUnitsPerMetre);
  generate(false);
  const std::vector<NamedSurface> surfaces = name_surfaces(body, solid);
  if (sizes.quadratic) gmsh::model::mesh::setOrder(2);
  return extract_mesh(surfaces, 1 / kKernelUnitsPerMetre);
}

}  // namespace

TetMesh mesh_solid(const Solid& solid, const MeshSizes& sizes) {
  const GmshSession session;
  gmsh::model::add("body");
  TetMesh mesh = solid.kind == Solid::Kind::stl_file ? mesh_stl(solid, sizes) : mesh_kernel_solid(solid, sizes);
  if (mesh.quadratic()) unfold(mesh);
  return mesh;
}

}  // namespace soft_robot_lab
