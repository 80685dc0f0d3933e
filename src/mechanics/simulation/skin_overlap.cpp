// SPDX-License-Identifier: BSD-3-Clause
#include "skin_overlap.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "mechanics/mesh/element_crossings.h"
#include "mechanics/mesh/skin.h"
#include "settings/point_text.h"

namespace soft_robot_lab {
namespace {

// Of an element's edge: chords of curved skin overlap by less; and contact lets skin sink in by far less.
constexpr double kLeastDepth = 0.05, kLeastInSpite = 0.25;

std::vector<std::vector<int>> columns_of_nodes(const Eigen::MatrixXi& nodes, int node_count) {
  std::vector<std::vector<int>> columns(static_cast<std::size_t>(node_count));
  for (int column = 0; column < nodes.cols(); ++column)
    for (const int node : nodes.col(column)) columns[static_cast<std::size_t>(node)].push_back(column);
  return columns;
}

bool holds(const Eigen::MatrixXi& nodes, int column, int node) { return (nodes.col(column).array() == node).any(); }

// Corners as a tetrahedron; none where it is turned inside out, which `inverted_elements` names.
bool is_inside(const TetCorners& corners, const Eigen::Vector3d& point_m) {
  const Eigen::Matrix3d edges = corners.rightCols<3>().colwise() - corners.col(0);
  if (!(edges.determinant() > 0.0)) return false;
  const Eigen::Vector3d inner = edges.inverse() * (point_m - corners.col(0));
  return inner.minCoeff() > 0.0 && inner.sum() < 1.0;
}

int longest_axis(const Eigen::Matrix3Xd& positions_m) {
  int axis = 0;
  (positions_m.rowwise().maxCoeff() - positions_m.rowwise().minCoeff()).maxCoeff(&axis);
  return axis;
}

Eigen::Matrix3Xd normals_of_faces(const TetMesh& mesh) {  // unit vectors
  Eigen::Matrix3Xd normals(3, mesh.faces.cols());
  for (Eigen::Index face = 0; face < normals.cols(); ++face) {
    const Eigen::Vector3d at_m = mesh.nodes_m.col(mesh.faces(0, face));
    const Eigen::Vector3d u = mesh.nodes_m.col(mesh.faces(1, face)) - at_m;
    normals.col(face) = u.cross(mesh.nodes_m.col(mesh.faces(2, face)) - at_m).normalized();
  }
  return normals;
}

std::string way_out(const TetMesh& mesh, int body, int other) {
  if (mesh.bodies.size() == 1) return "`contact.self: true` keeps it out";
  const auto name = [&](int of) { return "'" + mesh.bodies[static_cast<std::size_t>(of)] + "'"; };
  return "list [" + name(body) + ", " + name(other) + "] in `contact.bodies`";
}

bool all_touch(const TouchingPairs& touching, int bodies) {
  for (int body = 0; body < bodies; ++body)
    for (int other = 0; other <= body; ++other)
      if (touching(body, other) < 0) return false;
  return true;
}

}  // namespace

SkinOverlap::SkinOverlap(const Body& body)
    : touching_(body),
      tets_of_node_(columns_of_nodes(body.mesh().tets, body.mesh().node_count())),
      faces_of_node_(columns_of_nodes(body.mesh().faces, body.mesh().node_count())),
      all_touch_(all_touch(touching_, static_cast<int>(body.mesh().bodies.size()))) {
  for (int node = 0; node < body.mesh().node_count(); ++node)
    if (!faces_of_node_[static_cast<std::size_t>(node)].empty()) skin_nodes_.push_back(node);
}

bool SkinOverlap::may_touch(const Body& body, const Inside& inside) const {
  return touching_(body.body_of_node(inside.node), body.mesh().body_of(inside.tet)) >= 0;
}

bool SkinOverlap::neighbours(const TetMesh& mesh, const Inside& inside) const {
  for (const int tet : tets_of_node_[static_cast<std::size_t>(inside.node)])
    for (int corner = 0; corner < 4; ++corner)
      if (holds(mesh.tets, inside.tet, mesh.tets(corner, tet))) return true;
  return false;
}

// Along the longest axis the nodes of an element's box stand side by side.
std::vector<SkinOverlap::Inside> SkinOverlap::nodes_inside(Contact contact, const Body& body,
                                                           const TetMesh& present) const {
  const int axis = longest_axis(present.nodes_m);
  const auto along = [&](int node) { return present.nodes_m(axis, node); };
  std::vector<int> nodes = skin_nodes_;
  std::sort(nodes.begin(), nodes.end(), [&](int a, int b) { return along(a) < along(b); });
  std::vector<Inside> found;
  for (int tet = 0; tet < present.tet_count(); ++tet) {
    const TetCorners corners = corners_of(present, tet);
    const Eigen::Array3d least = corners.rowwise().minCoeff(), most = corners.rowwise().maxCoeff();
    auto at = std::lower_bound(nodes.begin(), nodes.end(), least[axis],
                               [&](int node, double from_m) { return along(node) < from_m; });
    for (; at != nodes.end() && along(*at) <= most[axis]; ++at) {
      const Eigen::Vector3d point_m = present.nodes_m.col(*at);
      if ((point_m.array() < least).any() || (point_m.array() > most).any()) continue;
      const Inside inside{*at, tet};
      const bool asked = may_touch(body, inside) == (contact == Contact::modelled);
      if (asked && is_inside(corners, point_m) && !neighbours(present, inside)) found.push_back(inside);
    }
  }
  return found;
}

// Below the skin that looks against the node's own, and in front of which the node is not.
double SkinOverlap::depth_m(const TetMesh& present, const Eigen::Matrix3Xd& face_normals, int node) const {
  const Eigen::Vector3d point_m = present.nodes_m.col(node);
  Eigen::Vector3d own = Eigen::Vector3d::Zero();
  for (const int face : faces_of_node_[static_cast<std::size_t>(node)]) own += face_normals.col(face);
  std::vector<Eigen::Index> above;
  for (Eigen::Index face = 0; face < face_normals.cols(); ++face) {
    const Eigen::Vector3d way_m = point_m - present.nodes_m.col(present.faces(0, face));
    if (face_normals.col(face).dot(own) < 0.0 && face_normals.col(face).dot(way_m) < 0.0 &&
        !holds(present.faces, static_cast<int>(face), node))
      above.push_back(face);
  }
  return above.empty() ? 0.0 : nearest_on_skin(present, above, point_m).distance_m;
}

std::optional<SolveWarning> SkinOverlap::deepest(const Body& body, const TetMesh& present) const {
  return all_touch_ ? std::nullopt : deepest_with(Contact::none, body, present);
}

std::optional<SolveWarning> SkinOverlap::deepest_in_spite_of_contact(const Body& body, const TetMesh& present) const {
  return body.touches_itself() ? deepest_with(Contact::modelled, body, present) : std::nullopt;
}

std::optional<SolveWarning> SkinOverlap::deepest_with(Contact contact, const Body& body, const TetMesh& present) const {
  const TetMesh& mesh = body.mesh();
  const double least = contact == Contact::modelled ? kLeastInSpite : kLeastDepth;
  const std::vector<Inside> found = nodes_inside(contact, body, present);
  if (found.empty()) return std::nullopt;
  const Eigen::Matrix3Xd face_normals = normals_of_faces(present);
  SolveWarning warning;
  warning.kind = "skin_in_silicone";
  warning.unit = "m";
  for (const Inside& inside : found) {
    const double depth = depth_m(present, face_normals, inside.node);
    if (depth <= least * edge_m(mesh, inside.tet) || depth <= warning.size) continue;
    warning.size = depth;
    warning.rest_position_m = mesh.nodes_m.col(inside.node);
    std::ostringstream text;
    text << "skin at rest position " << point_text(*warning.rest_position_m) << " is " << depth
         << " m inside silicone that it "
         << (contact == Contact::modelled
                 ? "touches: no such state is a solution"
                 : "may pass through: " + way_out(mesh, body.body_of_node(inside.node), mesh.body_of(inside.tet)));
    warning.text = text.str();
  }
  if (warning.size == 0.0) return std::nullopt;
  return warning;
}

}  // namespace soft_robot_lab
