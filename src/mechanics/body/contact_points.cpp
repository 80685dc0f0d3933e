// SPDX-License-Identifier: BSD-3-Clause
#include "contact_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <Eigen/Geometry>

#include "mechanics/mesh/shape_functions.h"
#include "mechanics/mesh/tet_faces.h"

namespace soft_robot_lab {
namespace {

constexpr double kSharp = 0.9;    // cosine of the angle between two faces, below which their edge is sharp
constexpr double kFoot = 0.45;    // the same where a body may stand or tip: no facet of a coarse round body
constexpr double kRound = 0.985;  // of faces that meet, below which they are round, if not sharp
constexpr int kPointsOfFoot = 7;
constexpr int kPartsOfEdge = 8;   // between the points on a sharp edge
constexpr double kOfEdge = 0.02;  // of the face's area: what the points on such an edge count for where they touch

// Places in the triangle, whose area is one half, and what they stand for of it.
struct Rule {
  std::vector<Eigen::Vector2d> places;
  std::vector<double> weights;
};

// The rule of degree 2 inside a triangle (Strang & Fix 1973), in each of the parts^2 triangles of a lattice.
Rule inside(int parts) {
  const double h = 1.0 / parts;
  Rule rule;
  const auto add = [&](const Eigen::Vector2d& corner, double side) {
    for (const Eigen::Vector2d& at : {Eigen::Vector2d(1, 1), Eigen::Vector2d(4, 1), Eigen::Vector2d(1, 4)}) {
      rule.places.push_back(corner + side / 6.0 * at);
      rule.weights.push_back(side * side / 6.0);
    }
  };
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; i + j < parts; ++j) {
      add({i * h, j * h}, h);
      if (i + j + 1 < parts) add({(i + 1) * h, (j + 1) * h}, -h);
    }
  }
  return rule;
}

// The rule of degree 3 with corners and middles of the sides (Stroud 1971).
void add_foot(Rule& rule) {
  for (const Eigen::Vector2d& at : {Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1)}) {
    rule.places.push_back(at);
    rule.weights.push_back(1.0 / 40.0);
  }
  for (const Eigen::Vector2d& at : {Eigen::Vector2d(0.5, 0), Eigen::Vector2d(0.5, 0.5), Eigen::Vector2d(0, 0.5)}) {
    rule.places.push_back(at);
    rule.weights.push_back(1.0 / 15.0);
  }
  rule.places.emplace_back(1.0 / 3.0, 1.0 / 3.0);
  rule.weights.push_back(9.0 / 40.0);
}

void add_edge(int edge, Rule& rule) {
  constexpr std::array<std::array<double, 2>, 3> corners{{{0, 0}, {1, 0}, {0, 1}}};
  const Eigen::Vector2d from(corners[edge].data()), to(corners[(edge + 1) % 3].data());
  for (int i = 0; i <= kPartsOfEdge; ++i) {
    const double along = static_cast<double>(i) / kPartsOfEdge;
    rule.places.emplace_back((1.0 - along) * from + along * to);
    rule.weights.push_back(0.5 * kOfEdge / kPartsOfEdge * (i == 0 || i == kPartsOfEdge ? 0.5 : 1.0));
  }
}

// Bits of the sides that are sharp; a combination of three has a rule.
Rule rule_for(int sharp, PointSpread spread) {
  Rule rule = inside(spread == PointSpread::dense ? 2 : 1);
  if (spread == PointSpread::sparse) {
    if (sharp != 0) add_foot(rule);
    return rule;
  }
  for (int edge = 0; edge < 3; ++edge)
    if (sharp >> edge & 1) add_edge(edge, rule);
  return rule;
}

// Along which axes all nodes of a face are.
Eigen::Matrix<bool, 3, 1> held_axes(const Body& body, int face) {
  return body.fixed()(Eigen::all, body.mesh().faces.col(face)).rowwise().all();
}

// As faces in planes of symmetry are, beyond which the body goes on.
bool held_along_an_axis(const Body& body, int face) { return held_axes(body, face).any(); }

// Of the triangle of its corners.
Eigen::Vector3d flat_normal(const Eigen::MatrixXi& faces, int face, const Eigen::Matrix3Xd& nodes_m) {
  const Eigen::Vector3d from = nodes_m.col(faces(0, face));
  const Eigen::Vector3d r = nodes_m.col(faces(1, face)) - from, s = nodes_m.col(faces(2, face)) - from;
  return r.cross(s).normalized();
}

// Per face of the mesh and side, the face beyond it where the body has a sharp edge there that stands out; else -1. In
// the dense spread only the first of two faces that can move knows of it: that one guards it.
using Edges = std::vector<std::array<int, 3>>;

Edges sharp_edges(const Body& body, const std::vector<int>& can_move, PointSpread spread) {
  const TetMesh& mesh = body.mesh();
  const bool both = spread == PointSpread::sparse;
  const auto corner = [&](int face, int i) { return mesh.nodes_m.col(mesh.faces(i % 3, face)); };
  const auto normal = [&](int face) { return flat_normal(mesh.faces, face, mesh.nodes_m); };
  std::map<std::pair<int, int>, std::pair<int, int>> sides;
  Edges beyond(static_cast<std::size_t>(mesh.faces.cols()), {-1, -1, -1});
  for (int face = 0; face < mesh.faces.cols(); ++face) {
    for (int side = 0; side < 3; ++side) {
      const int a = mesh.faces(side, face), b = mesh.faces((side + 1) % 3, face);
      const auto [found, first] = sides.emplace(std::minmax(a, b), std::make_pair(face, side));
      if (first) continue;
      const auto& [other, of_other] = found->second;
      const bool stands_out = normal(face).dot(corner(other, of_other + 2) - corner(face, side)) < 0.0;
      if (!stands_out || normal(face).dot(normal(other)) > (both ? kFoot : kSharp)) continue;
      if (both && (held_along_an_axis(body, face) || held_along_an_axis(body, other))) continue;
      const bool other_moves = std::binary_search(can_move.begin(), can_move.end(), other);
      if (other_moves || both) beyond[static_cast<std::size_t>(other)][static_cast<std::size_t>(of_other)] = face;
      if (!other_moves || both) beyond[static_cast<std::size_t>(face)][static_cast<std::size_t>(side)] = other;
    }
  }
  return beyond;
}

}  // namespace

Eigen::VectorXd moduli_of_faces_pa(const Body& body) {
  const TetMesh& mesh = body.mesh();
  Eigen::VectorXd moduli_pa = Eigen::VectorXd::Constant(mesh.faces.cols(), body.material().youngs_modulus_pa);
  if (body.one_material()) return moduli_pa;
  const TetSides sides(mesh);
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    const std::vector<TetSide> behind =
        sides.meeting(face_key(mesh.faces(0, face), mesh.faces(1, face), mesh.faces(2, face)));
    moduli_pa[face] = body.material_of(behind.front().tet).youngs_modulus_pa;
  }
  return moduli_pa;
}

ContactPoints::ContactPoints(const Body& body, PointSpread spread) {
  const TetMesh& mesh = body.mesh();
  for (int face = 0; face < mesh.faces.cols(); ++face)
    if (!held_axes(body, face).all()) mesh_faces_.push_back(face);
  faces_ = mesh.faces(Eigen::all, mesh_faces_);
  std::vector<Rule> rules;
  for (int sides = 0; sides < 8; ++sides) rules.push_back(rule_for(sides, spread));
  points_inside_ = static_cast<int>(rules[0].places.size());
  const Edges beyond = sharp_edges(body, mesh_faces_, spread);
  if (spread == PointSpread::sparse) set_beyond(mesh);
  std::vector<int> first_place{0};
  for (const Rule& rule : rules) first_place.push_back(first_place.back() + static_cast<int>(rule.places.size()));
  places_.shape.resize(faces_.rows(), first_place.back());
  places_.along_r.resizeLike(places_.shape);
  places_.along_s.resizeLike(places_.shape);
  places_.shares.resize(first_place.back());
  Eigen::Index place = 0;
  for (const Rule& rule : rules) {
    for (std::size_t i = 0; i < rule.places.size(); ++i, ++place) {
      const FaceShape shape = face_shape(faces_.rows(), rule.places[i].x(), rule.places[i].y());
      places_.shape.col(place) = shape.values;
      places_.along_r.col(place) = shape.slopes.row(0).transpose();
      places_.along_s.col(place) = shape.slopes.row(1).transpose();
      places_.shares[place] = rule.weights[i];
    }
  }
  for (int face = 0; face < face_count(); ++face) {
    const std::array<int, 3>& edges = beyond[static_cast<std::size_t>(mesh_faces_[face])];
    std::size_t rule = 0;
    std::vector<int> besides(static_cast<std::size_t>(points_inside_), -1);
    for (std::size_t side = 0; side < 3; ++side) {
      if (edges[side] < 0) continue;
      rule |= 1u << side;
      if (spread == PointSpread::dense) besides.insert(besides.end(), kPartsOfEdge + 1, edges[side]);
    }
    besides.resize(rules[rule].places.size(), -1);
    first_.push_back(static_cast<int>(face_of_.size()));
    beside_.insert(beside_.end(), besides.begin(), besides.end());
    for (int at = first_place[rule]; at < first_place[rule + 1]; ++at) {
      face_of_.push_back(face);
      place_of_.push_back(at);
    }
  }
  first_.push_back(static_cast<int>(face_of_.size()));
  weights_m2_.resize(first_.back());
  for (int point = 0; point < count(); ++point) weights_m2_[point] = present_area_m2(point, mesh.nodes_m);
  sizes_m_.resize(face_count());
  for (int face = 0; face < face_count(); ++face) {
    const double area_m2 = weights_m2_.segment(first_point(face), points_inside_).sum();
    sizes_m_[face] = std::sqrt(2.0 * area_m2);
    if (spread == PointSpread::sparse) continue;
    const int guards = first_point(face + 1) - first_point(face) - points_inside_;
    weights_m2_.segment(first_point(face) + points_inside_, guards).setConstant(area_m2 / points_inside_);
  }
}

void ContactPoints::set_beyond(const TetMesh& mesh) {
  all_faces_ = mesh.faces;
  std::map<int, std::vector<int>> at_corners;
  for (int face = 0; face < all_faces_.cols(); ++face)
    for (int i = 0; i < 3; ++i) at_corners[all_faces_(i, face)].push_back(face);
  for (const int face : mesh_faces_) {
    const Eigen::Vector3d own = flat_normal(all_faces_, face, mesh.nodes_m);
    std::vector<int>& others = beyond_.emplace_back();
    bool is_round = false;
    for (int i = 0; i < 3; ++i) {
      for (const int other : at_corners[all_faces_(i, face)]) {
        const double cosine = own.dot(flat_normal(all_faces_, other, mesh.nodes_m));
        if (cosine < kFoot) others.push_back(other);
        is_round = is_round || (cosine >= kFoot && cosine < kRound);
      }
    }
    round_.push_back(is_round);
  }
}

bool ContactPoints::stands(int face) const {
  return first_point(face + 1) - first_point(face) == points_inside_ + kPointsOfFoot;
}

bool ContactPoints::serves(int point, bool flat) const {
  const int face = face_of(point);
  return !stands(face) || flat == (point >= first_point(face) + points_inside_);
}

bool ContactPoints::looks_most(int point, const Eigen::Vector3d& way, double margin,
                               const Eigen::Matrix3Xd& positions_m) const {
  const int face = face_of(point);
  if (!stands(face) || point - first_point(face) < points_inside_) return true;
  const auto along = [&](int mesh_face) { return flat_normal(all_faces_, mesh_face, positions_m).dot(way); };
  const double own = along(mesh_faces_[static_cast<std::size_t>(face)]);
  const std::vector<int>& others = beyond_[static_cast<std::size_t>(face)];
  return std::all_of(others.begin(), others.end(), [&](int other) { return own > along(other) - margin; });
}

Eigen::Vector3d ContactPoints::at(int point, const Eigen::Matrix3Xd& columns) const {
  const int face = face_of(point), place = place_of(point);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const double* const shape = &places_.shape(0, place);
  const int* const nodes = &faces_(0, face);
  for (int a = 0; a < nodes_per_face(); ++a) sum += shape[a] * columns.col(nodes[a]);
  return sum;
}

Eigen::Vector3d ContactPoints::outward_m2(int point, const Eigen::Matrix3Xd& positions_m) const {
  const int face = face_of(point), place = place_of(point);
  Eigen::Vector3d along_r = Eigen::Vector3d::Zero(), along_s = Eigen::Vector3d::Zero();
  for (int a = 0; a < nodes_per_face(); ++a) {
    along_r += places_.along_r(a, place) * positions_m.col(faces_(a, face));
    along_s += places_.along_s(a, place) * positions_m.col(faces_(a, face));
  }
  return places_.shares[place] * along_r.cross(along_s);
}

double ContactPoints::present_area_m2(int point, const Eigen::Matrix3Xd& positions_m) const {
  return outward_m2(point, positions_m).norm();
}

}  // namespace soft_robot_lab
