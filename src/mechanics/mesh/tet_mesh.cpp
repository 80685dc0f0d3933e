// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/tet_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <Eigen/Dense>

#include "settings/limits.h"
#include "settings/point_text.h"
#include "tet_faces.h"
#include "shape_functions.h"

namespace soft_robot_lab {
namespace {

// Part of the longest edge cubed; a regular element has 0.7.
constexpr double kFlat = 1e-9;
constexpr double kSmallest_m = 1e-9;  // of a body, and of what STL files and solids may hold
constexpr double kFarthest_m =
    limits::kFilePlace;  // millimetres without a scale are nearer; volumes of what lies far beyond overflow

using Barycentric = Eigen::Vector4d;  // weights of the corners, summing to one

Eigen::Matrix3Xd element_nodes(const TetMesh& mesh, int tet) {
  Eigen::Matrix3Xd nodes(3, mesh.tets.rows());
  for (Eigen::Index i = 0; i < nodes.cols(); ++i) nodes.col(i) = mesh.nodes_m.col(mesh.tets(i, tet));
  return nodes;
}

// Six times the volume at a place of the element: the Jacobian determinant of its map.
double jacobian(const Eigen::Matrix3Xd& nodes, const Barycentric& at) {
  const int count = static_cast<int>(nodes.cols());
  return (nodes * shape_functions(count, at.tail<3>()).gradients.transpose()).determinant();
}

// Five points, exact for cubic polynomials, which the Jacobian of a curved element is (Keast 1986, rule 2).
double element_volume(const Eigen::Matrix3Xd& nodes) {
  const Barycentric centre = Barycentric::Constant(0.25);
  if (nodes.cols() == 4) return jacobian(nodes, centre) / 6;
  double sum = -0.8 * jacobian(nodes, centre);
  for (int i = 0; i < 4; ++i) {
    Barycentric at = Barycentric::Constant(1.0 / 6.0);
    at[i] = 0.5;
    sum += 0.45 * jacobian(nodes, at);
  }
  return sum / 6;
}

// Corners, mid-edges, centre, side centres and the four quadrature points.
std::vector<Barycentric> places_to_check() {
  std::vector<Barycentric> places{Barycentric::Constant(0.25)};
  for (int i = 0; i < 4; ++i) {
    places.push_back(Barycentric::Unit(i));
    places.push_back((Barycentric::Ones() - Barycentric::Unit(i)) / 3);
    const double b = (5.0 - std::sqrt(5.0)) / 20.0;
    places.push_back(Barycentric::Constant(b) + (1 - 4 * b) * Barycentric::Unit(i));
  }
  for (const auto& [a, b] : kTetEdges) places.push_back((Barycentric::Unit(a) + Barycentric::Unit(b)) / 2);
  return places;
}

double smallest_jacobian(const Eigen::Matrix3Xd& nodes) {
  if (nodes.cols() == 4) return jacobian(nodes, Barycentric::Unit(0));
  static const std::vector<Barycentric> places = places_to_check();
  double smallest = std::numeric_limits<double>::infinity();
  for (const Barycentric& at : places) smallest = std::min(smallest, jacobian(nodes, at));
  return smallest;
}

double longest_edge(const Eigen::Matrix3Xd& nodes) {
  double longest = 0;
  for (const auto& [a, b] : kTetEdges) longest = std::max(longest, (nodes.col(a) - nodes.col(b)).norm());
  return longest;
}

std::string element_text(const TetMesh& mesh, int tet) {
  const Eigen::Matrix3Xd nodes = element_nodes(mesh, tet);
  std::ostringstream text;
  text << "element " << tet << " at " << point_text(nodes.leftCols<4>().rowwise().mean()) << " with signed volume "
       << element_volume(nodes) << " m^3";
  return text.str();
}

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("mesh: " + what); }

void check_sizes(const TetMesh& mesh) {
  if (mesh.tet_count() == 0) refuse("has no element");
  if (mesh.tets.rows() != 4 && mesh.tets.rows() != 10) {
    refuse("elements have " + std::to_string(mesh.tets.rows()) + " nodes, must have 4 or 10");
  }
  if (mesh.faces.cols() > 0 && mesh.faces.rows() != (mesh.quadratic() ? 6 : 3)) {
    refuse("faces have " + std::to_string(mesh.faces.rows()) + " nodes, which does not fit the elements");
  }
  if (static_cast<Eigen::Index>(mesh.face_surface.size()) != mesh.faces.cols()) {
    refuse("face_surface must have one entry for each face");
  }
  for (const int surface : mesh.face_surface) {
    if (surface < -1 || surface >= static_cast<int>(mesh.surface_names.size())) {
      refuse("face_surface " + std::to_string(surface) + " is out of range [-1, " +
             std::to_string(mesh.surface_names.size()) + ")");
    }
  }
}

void check_indices(const TetMesh& mesh) {
  const auto check = [&](const Eigen::MatrixXi& cells, const std::string& kind) {
    for (Eigen::Index cell = 0; cell < cells.cols(); ++cell) {
      for (Eigen::Index i = 0; i < cells.rows(); ++i) {
        const int node = cells(i, cell);
        if (node >= 0 && node < mesh.node_count()) continue;
        refuse(kind + " " + std::to_string(cell) + ": node " + std::to_string(node) + " is out of range [0, " +
               std::to_string(mesh.node_count()) + ")");
      }
    }
  };
  check(mesh.tets, "element");
  check(mesh.faces, "face");
}

void check_nodes(const TetMesh& mesh) {
  std::vector<bool> used(static_cast<size_t>(mesh.node_count()), false);
  for (Eigen::Index i = 0; i < mesh.tets.size(); ++i) used[static_cast<size_t>(mesh.tets.data()[i])] = true;
  for (int node = 0; node < mesh.node_count(); ++node) {
    const std::string name = "node " + std::to_string(node) + " at " + point_text(mesh.nodes_m.col(node));
    if (!mesh.nodes_m.col(node).allFinite()) refuse(name + " is not finite");
    if (mesh.nodes_m.col(node).cwiseAbs().maxCoeff() > kFarthest_m)
      refuse(name + " lies out of range [-1e+06, 1e+06] m");
    if (!used[static_cast<size_t>(node)]) refuse(name + " belongs to no element");
  }
}

// Before its elements are called flat, whose volumes round to nothing.
void check_size(const TetMesh& mesh) {
  const double size_m = (mesh.nodes_m.rowwise().maxCoeff() - mesh.nodes_m.rowwise().minCoeff()).maxCoeff();
  if (size_m >= kSmallest_m) return;
  std::ostringstream text;
  text << "it is " << size_m << " m large, out of range [" << kSmallest_m
       << ", 2e+06] m: its numbers are metres, unless a `scale` "
       << "beside it says how many metres one is";
  refuse(text.str());
}

// det(dx/dr) below this counts as flat.
double flat_jacobian(const Eigen::Matrix3Xd& nodes) { return kFlat * std::pow(longest_edge(nodes), 3); }

void check_elements(const TetMesh& mesh) {
  const std::vector<int> folded = folded_elements(mesh);
  if (folded.empty()) return;
  const Eigen::Matrix3Xd nodes = element_nodes(mesh, folded[0]);
  const double smallest = smallest_jacobian(nodes);
  std::ostringstream text;
  text << element_text(mesh, folded[0]) << " is " << (smallest < -flat_jacobian(nodes) ? "inverted" : "degenerate")
       << ": its smallest Jacobian determinant is " << smallest << " m^3";
  if (folded.size() > 1) text << "; " << folded.size() - 1 << " more elements are like that";
  refuse(text.str());
}

// Whether the corners of a side are an even permutation of its sorted key.
bool is_even(const TetMesh& mesh, const TetSide& side) {
  const auto corner = [&](int i) { return mesh.tets(kTetSides[side.side][i], side.tet); };
  const int a = corner(0), b = corner(1), c = corner(2);
  return (a < b) + (b < c) + (c < a) == 2;
}

// Two elements that share a face see it from either side; else one lies in the other.
void check_sides(const TetMesh& mesh, const TetSides& sides) {
  std::string first;
  int more = -1;
  sides.for_each_group([&](const TetSide* side, int count) {
    if (count != 2 || is_even(mesh, side[0]) != is_even(mesh, side[1])) return;
    if (++more == 0)
      first = element_text(mesh, side[0].tet) + " and " + element_text(mesh, side[1].tet) +
              " lie on the same side of the face that they share: one is folded over the other";
  });
  if (more < 0) return;
  refuse(first + (more > 0 ? "; " + std::to_string(more) + " more pairs are like that" : ""));
}

// Elements hang together through whole faces; an edge or a corner would be a hinge.
void check_connected(const TetMesh& mesh, const TetSides& sides) {
  std::vector<int> parent(static_cast<size_t>(mesh.tet_count()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int tet) {
    while (parent[static_cast<size_t>(tet)] != tet) {
      int& up = parent[static_cast<size_t>(tet)];
      tet = up = parent[static_cast<size_t>(up)];
    }
    return tet;
  };
  sides.for_each_group([&](const TetSide* side, int count) {
    if (count > 2) refuse("more than two elements share a face, among them " + element_text(mesh, side[2].tet));
    if (count == 2) parent[static_cast<size_t>(root(side[0].tet))] = root(side[1].tet);
  });
  std::map<int, int> first_of;  // per body, an element
  for (int tet = 0; tet < mesh.tet_count(); ++tet) {
    const int first = first_of.emplace(mesh.body_of(tet), tet).first->second;
    if (root(tet) == root(first)) continue;
    std::set<int> parts;
    for (int each = 0; each < mesh.tet_count(); ++each)
      if (mesh.body_of(each) == mesh.body_of(tet)) parts.insert(root(each));
    refuse("falls into " + std::to_string(parts.size()) + " parts without a common face: " + element_text(mesh, first) +
           " and " + element_text(mesh, tet) + " do not hang together");
  }
  if (first_of.size() != mesh.bodies.size()) refuse("has a body without an element");
}

void check_bodies_apart(const TetMesh& mesh) {
  const std::vector<int> bodies = bodies_of_nodes(mesh);
  for (int tet = 0; tet < mesh.tet_count(); ++tet)
    for (const int node : mesh.tets.col(tet))
      if (bodies[static_cast<size_t>(node)] != mesh.body_of(tet))
        refuse("two bodies share the node at " + point_text(mesh.nodes_m.col(node)));
}

void check_regions(const TetMesh& mesh) {
  if (mesh.regions.empty() || mesh.bodies.empty()) refuse("has no region, or no body");
  for (const MeshRegion& region : mesh.regions)
    if (region.body < 0 || region.body >= static_cast<int>(mesh.bodies.size()))
      refuse("region '" + region.name + "' belongs to no body");
  if (mesh.tet_region.empty()) return;
  if (static_cast<int>(mesh.tet_region.size()) != mesh.tet_count())
    refuse("tet_region must have one entry for each element");
  for (const int region : mesh.tet_region)
    if (region < 0 || region >= static_cast<int>(mesh.regions.size()))
      refuse("tet_region " + std::to_string(region) + " is out of range [0, " + std::to_string(mesh.regions.size()) +
             ")");
}

// Their faces meet two by two, so that no boundary is left.
void check_twice(const TetMesh& mesh) {
  std::map<std::array<int, 4>, int> first_of;
  for (int tet = 0; tet < mesh.tet_count(); ++tet) {
    std::array<int, 4> corners{};
    for (size_t i = 0; i < 4; ++i) corners[i] = mesh.tets(static_cast<Eigen::Index>(i), tet);
    std::sort(corners.begin(), corners.end());
    const auto [first, is_new] = first_of.emplace(corners, tet);
    if (!is_new) refuse(element_text(mesh, tet) + " has the corners of element " + std::to_string(first->second));
  }
}

bool same_but_for_the_first_corner(Eigen::VectorXi face, const Eigen::VectorXi& wanted) {
  for (int turn = 0; turn < 3; ++turn) {
    if (face == wanted) return true;
    for (Eigen::Index first = 0; first < face.size(); first += 3) {
      face.segment<3>(first) = Eigen::Vector3i(face[first + 1], face[first + 2], face[first]);
    }
  }
  return false;
}

void check_faces(const TetMesh& mesh, const TetSides& sides) {
  std::set<FaceKey> seen;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    const auto nodes = mesh.faces.col(face);
    const FaceKey key = face_key(nodes[0], nodes[1], nodes[2]);
    const std::string name =
        "face " + std::to_string(face) + " at " +
        point_text((mesh.nodes_m.col(nodes[0]) + mesh.nodes_m.col(nodes[1]) + mesh.nodes_m.col(nodes[2])) / 3);
    const std::vector<TetSide> meeting = sides.meeting(key);
    if (meeting.size() != 1) refuse(name + " does not lie on the boundary");
    if (!same_but_for_the_first_corner(nodes, meeting[0].nodes(mesh))) refuse(name + " does not point outward");
    if (!seen.insert(key).second) refuse(name + " is listed twice");
  }
}

}  // namespace

TetMesh make_quadratic(const TetMesh& mesh) {
  if (mesh.quadratic()) return mesh;
  TetMesh result = mesh;
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const int next = mesh.node_count() + static_cast<int>(middles.size());
    return middles.emplace(std::minmax(a, b), next).first->second;
  };
  result.tets.conservativeResize(10, Eigen::NoChange);
  for (int tet = 0; tet < mesh.tet_count(); ++tet) {
    for (int e = 0; e < 6; ++e) {
      result.tets(4 + e, tet) = middle(mesh.tets(kTetEdges[e][0], tet), mesh.tets(kTetEdges[e][1], tet));
    }
  }
  result.faces.conservativeResize(6, mesh.faces.cols());
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    for (int e = 0; e < 3; ++e) {
      result.faces(3 + e, face) = middle(mesh.faces(e, face), mesh.faces((e + 1) % 3, face));
    }
  }
  result.nodes_m.conservativeResize(Eigen::NoChange, mesh.node_count() + static_cast<int>(middles.size()));
  for (const auto& [edge, node] : middles) {
    result.nodes_m.col(node) = (mesh.nodes_m.col(edge.first) + mesh.nodes_m.col(edge.second)) / 2;
  }
  return result;
}

TetMesh make_linear(const TetMesh& mesh) {
  if (!mesh.quadratic()) return mesh;
  TetMesh result = mesh;
  result.tets = mesh.tets.topRows(4);
  result.faces = mesh.faces.topRows(std::min<Eigen::Index>(3, mesh.faces.rows()));
  std::vector<int> renumbered(static_cast<size_t>(mesh.node_count()), -1);
  for (Eigen::Index i = 0; i < result.tets.size(); ++i) renumbered[static_cast<size_t>(result.tets.data()[i])] = 0;
  int count = 0;
  for (int node = 0; node < mesh.node_count(); ++node) {
    if (renumbered[static_cast<size_t>(node)] < 0) continue;
    result.nodes_m.col(count) = mesh.nodes_m.col(node);
    renumbered[static_cast<size_t>(node)] = count++;
  }
  result.nodes_m.conservativeResize(Eigen::NoChange, count);
  const auto renumber = [&](int node) { return renumbered[static_cast<size_t>(node)]; };
  result.tets = result.tets.unaryExpr(renumber).eval();
  result.faces = result.faces.unaryExpr(renumber).eval();
  return result;
}

std::vector<int> bodies_of_nodes(const TetMesh& mesh) {
  std::vector<int> bodies(static_cast<size_t>(mesh.node_count()), 0);
  for (int tet = 0; tet < mesh.tet_count(); ++tet)
    for (const int node : mesh.tets.col(tet)) bodies[static_cast<size_t>(node)] = mesh.body_of(tet);
  return bodies;
}

namespace {

template <class Matrix>
void append_columns(const Matrix& added, Matrix& all) {
  const Eigen::Index before = all.cols();
  all.conservativeResize(added.rows(), before + added.cols());
  all.rightCols(added.cols()) = added;
}

}  // namespace

void add_body(const std::string& name, const TetMesh& body, TetMesh& mesh) {
  if (body.quadratic() != mesh.quadratic()) throw std::invalid_argument("bodies have elements of different order");
  if (std::count(mesh.bodies.begin(), mesh.bodies.end(), name) > 0)
    throw std::invalid_argument("two bodies are named '" + name + "'");
  const int first_node = mesh.node_count(), first_region = static_cast<int>(mesh.regions.size()),
            first_surface = static_cast<int>(mesh.surface_names.size());
  mesh.tet_region.resize(static_cast<size_t>(mesh.tet_count()), 0);
  for (int tet = 0; tet < body.tet_count(); ++tet) mesh.tet_region.push_back(first_region + body.region_of(tet));
  for (const MeshRegion& region : body.regions)
    mesh.regions.push_back({region.name, static_cast<int>(mesh.bodies.size())});
  mesh.bodies.push_back(name);
  for (const int surface : body.face_surface) mesh.face_surface.push_back(surface < 0 ? -1 : first_surface + surface);
  for (const std::string& surface : body.surface_names) mesh.surface_names.push_back(name + "/" + surface);
  append_columns(body.nodes_m, mesh.nodes_m);
  append_columns<Eigen::MatrixXi>(body.tets.array() + first_node, mesh.tets);
  append_columns<Eigen::MatrixXi>(body.faces.array() + first_node, mesh.faces);
}

void complete_boundary(TetMesh& mesh) {
  std::set<FaceKey> listed;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    listed.insert(face_key(mesh.faces(0, face), mesh.faces(1, face), mesh.faces(2, face)));
  }
  std::vector<TetSide> missing;
  TetSides(mesh).for_each_group([&](const TetSide* side, int count) {
    if (count == 1 && listed.count(side->key) == 0) missing.push_back(*side);
  });
  std::sort(missing.begin(), missing.end(), [](const TetSide& a, const TetSide& b) {
    return std::make_pair(a.tet, a.side) < std::make_pair(b.tet, b.side);
  });
  const Eigen::Index first = mesh.faces.cols();
  mesh.faces.conservativeResize(mesh.quadratic() ? 6 : 3, first + static_cast<Eigen::Index>(missing.size()));
  for (size_t i = 0; i < missing.size(); ++i) {
    mesh.faces.col(first + static_cast<Eigen::Index>(i)) = missing[i].nodes(mesh);
  }
  mesh.face_surface.resize(static_cast<size_t>(mesh.faces.cols()), -1);
}

void check_mesh(const TetMesh& mesh) {
  check_sizes(mesh);
  check_indices(mesh);
  check_regions(mesh);
  check_nodes(mesh);
  check_bodies_apart(mesh);
  check_size(mesh);
  check_elements(mesh);
  const TetSides sides(mesh);
  check_connected(mesh, sides);
  check_twice(mesh);
  check_sides(mesh, sides);
  check_faces(mesh, sides);
}

std::vector<int> folded_elements(const TetMesh& mesh) {
  std::vector<int> folded;
  for (int tet = 0; tet < mesh.tet_count(); ++tet) {
    const Eigen::Matrix3Xd nodes = element_nodes(mesh, tet);
    if (!(smallest_jacobian(nodes) > flat_jacobian(nodes))) folded.push_back(tet);
  }
  return folded;
}

double volume(const TetMesh& mesh) {
  double sum = 0;
  for (int tet = 0; tet < mesh.tet_count(); ++tet) sum += element_volume(element_nodes(mesh, tet));
  return sum;
}

}  // namespace soft_robot_lab
