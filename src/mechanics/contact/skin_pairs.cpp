// SPDX-License-Identifier: BSD-3-Clause
#include "skin_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {
namespace {

constexpr double kDeepest = 0.5;    // of a face's size: deeper is the other side of a wall, as is deeper than a wall
constexpr double kBehind = 4.0;     // of the largest face's size: walls are looked for so near
constexpr double kInFront = 1e-9;   // of the same: a face that has no corner so far in front of another lies behind it
constexpr double kMargin = 0.02;    // of the body's size: what near faces are looked for within
constexpr double kOneSide = 0.5;    // cosine: faces whose normals agree so at rest are one side of a wall; it may fold
constexpr double kOneWay = 0.9;     // cosine: neither face meets the other, nor do the guards at its edges
constexpr double kAlong = 0.6;      // cosine: faces bend less than to turn such normals against one another
constexpr double kAgainst = 0.2;    // cosine: skin that meets skin faces it at least so much
constexpr double kOverEdge = 0.01;  // of a face's size: a point so far beyond its edge still meets it
constexpr int kMostIterations = 12;

// The area vector of a face's corners.
Eigen::Vector3d corner_normal(const Eigen::MatrixXi& faces, int face, const Eigen::Matrix3Xd& positions_m) {
  const Eigen::Vector3d a = positions_m.col(faces(0, face));
  return (positions_m.col(faces(1, face)) - a).cross(positions_m.col(faces(2, face)) - a);
}

using FaceNodes = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 6>;

FaceNodes nodes_of(const Eigen::MatrixXi& faces, int face, const Eigen::Matrix3Xd& positions_m) {
  FaceNodes nodes(3, faces.rows());
  for (Eigen::Index a = 0; a < faces.rows(); ++a) nodes.col(a) = positions_m.col(faces(a, face));
  return nodes;
}

// Of the face as a Bezier triangle, which lies between them.
FaceNodes control_points(const FaceNodes& nodes) {
  FaceNodes points = nodes;
  for (int edge = 0; edge < 3 && nodes.cols() == 6; ++edge)
    points.col(3 + edge) = 2.0 * nodes.col(3 + edge) - 0.5 * (nodes.col(edge) + nodes.col((edge + 1) % 3));
  return points;
}

Eigen::Vector2d into_triangle(Eigen::Vector2d local) {
  local = local.cwiseMax(0.0);
  const double beyond = local.sum() - 1.0;
  if (beyond > 0.0) local -= Eigen::Vector2d::Constant(0.5 * beyond);
  local = local.cwiseMax(0.0);
  return local / std::max(1.0, local.sum());
}

// A face as a polynomial of its coordinates, of terms 1, r, s, r^2, r s, s^2.
class FacePolynomial {
 public:
  explicit FacePolynomial(const FaceNodes& n) {
    of_ << n.col(0), n.col(1) - n.col(0), n.col(2) - n.col(0), Eigen::Matrix3d::Zero();
    if (n.cols() == 3) return;
    const Eigen::Vector3d r = 2.0 * (n.col(0) + n.col(1) - 2.0 * n.col(3));
    const Eigen::Vector3d s = 2.0 * (n.col(0) + n.col(2) - 2.0 * n.col(5));
    of_.col(1) -= r;
    of_.col(2) -= s;
    of_.rightCols<3>() << r, 4.0 * (n.col(0) - n.col(3) + n.col(4) - n.col(5)), s;
  }
  Eigen::Vector3d at(double r, double s) const {
    return of_.col(0) + r * (of_.col(1) + r * of_.col(3) + s * of_.col(4)) + s * (of_.col(2) + s * of_.col(5));
  }
  Eigen::Matrix<double, 3, 2> tangents(double r, double s) const {
    return (Eigen::Matrix<double, 3, 2>() << of_.col(1) + 2.0 * r * of_.col(3) + s * of_.col(4),
            of_.col(2) + r * of_.col(4) + 2.0 * s * of_.col(5))
        .finished();
  }

 private:
  Eigen::Matrix<double, 3, 6> of_;
};

// Coordinates of the closest place, by Gauss and Newton's method, kept on the face.
Eigen::Vector2d closest(const FaceNodes& nodes, const Eigen::Vector3d& point_m) {
  const FacePolynomial face(nodes);
  Eigen::Vector2d local = Eigen::Vector2d::Constant(1.0 / 3.0);
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    const Eigen::Matrix<double, 3, 2> tangents = face.tangents(local.x(), local.y());
    const Eigen::Matrix2d metric = tangents.transpose() * tangents;
    const Eigen::Vector2d change =
        metric.inverse() * (tangents.transpose() * (point_m - face.at(local.x(), local.y())));
    const Eigen::Vector2d next = into_triangle(local + change);
    const double moved = (next - local).cwiseAbs().maxCoeff();
    local = next;
    if (!(moved > 1e-13)) break;
  }
  return local;
}

// Faces whose boxes overlap, by Bullet.
std::vector<std::pair<int, int>> overlapping(const Eigen::MatrixXi& faces, const Eigen::Matrix3Xd& positions_m,
                                             double wider_m) {
  struct Collect : btDbvt::ICollide {
    std::vector<std::pair<int, int>> pairs;
    void Process(const btDbvtNode* a, const btDbvtNode* b) override { pairs.emplace_back(a->dataAsInt, b->dataAsInt); }
  } found;
  btDbvt tree;
  const auto corner = [](const Eigen::Vector3d& at_m) {
    return btVector3(static_cast<btScalar>(at_m.x()), static_cast<btScalar>(at_m.y()), static_cast<btScalar>(at_m.z()));
  };
  for (int face = 0; face < faces.cols(); ++face) {
    const FaceNodes nodes = nodes_of(faces, face, positions_m);
    const Eigen::Vector3d low_m = nodes.rowwise().minCoeff().array() - wider_m;
    const Eigen::Vector3d high_m = nodes.rowwise().maxCoeff().array() + wider_m;
    tree.insert(btDbvtVolume::FromMM(corner(low_m), corner(high_m)), nullptr)->dataAsInt = face;
  }
  if (!tree.empty()) tree.collideTT(tree.m_root, tree.m_root, found);
  return std::move(found.pairs);
}

// How far behind the middle of a face at rest another one is that looks the other way; infinite where the line from
// there does not meet it.
double wall_m(const Eigen::MatrixXi& faces, int face, int other, const Eigen::Matrix3Xd& rest_m) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d out = corner_normal(faces, face, rest_m).normalized();
  const Eigen::Vector3d area_m2 = corner_normal(faces, other, rest_m);
  if (out.dot(area_m2) > -kAgainst * area_m2.norm()) return kInfinite;
  const Eigen::Matrix3d corners_m = rest_m(Eigen::all, faces.col(other).head<3>());
  const Eigen::Vector3d from_m = rest_m(Eigen::all, faces.col(face).head<3>()).rowwise().mean();
  const double depth_m = (from_m - corners_m.col(0)).dot(area_m2) / out.dot(area_m2);
  const Eigen::Vector3d at_m = from_m - depth_m * out;
  for (int side = 0; side < 3; ++side) {
    const Eigen::Vector3d edge_m = corners_m.col((side + 1) % 3) - corners_m.col(side);
    if (edge_m.cross(at_m - corners_m.col(side)).dot(area_m2) < -1e-9 * area_m2.squaredNorm()) return kInfinite;
  }
  return depth_m > 0.0 ? depth_m : kInfinite;
}

// Of each face of the mesh.
std::vector<int> bodies_of_faces(const Body& body) {
  std::vector<int> all;
  for (const int node : body.mesh().faces.row(0)) all.push_back(body.body_of_node(node));
  return all;
}

}  // namespace

TouchingPairs::TouchingPairs(const Body& body)
    : of_bodies_(Eigen::MatrixXi::Constant(body.mesh().bodies.size(), body.mesh().bodies.size(), -1)) {
  int index = 0;
  for (const TouchingBodies& pair : body.touching_bodies())
    of_bodies_(pair.first, pair.second) = of_bodies_(pair.second, pair.first) = index++;
}

SkinPairs::SkinPairs(const Body& body, const ContactPoints& points)
    : faces_(body.mesh().faces),
      same_(points.mesh_faces()),
      body_(bodies_of_faces(body)),
      touching_(body),
      margin_m_(kMargin * body.size_m()) {
  const Eigen::Matrix3Xd& nodes_m = body.mesh().nodes_m;
  rest_m_ = nodes_m;
  const auto count = static_cast<int>(faces_.cols());
  rest_middles_m_.resize(3, count);
  rest_normals_.resize(3, count);
  sizes_m_.resize(count);
  for (int face = 0; face < count; ++face) {
    const Eigen::Vector3d area_m2 = corner_normal(faces_, face, nodes_m);
    rest_middles_m_.col(face) = nodes_of(faces_, face, nodes_m).rowwise().mean();
    rest_normals_.col(face) = area_m2.normalized();
    sizes_m_[face] = std::sqrt(area_m2.norm());
  }
  largest_size_m_ = sizes_m_.maxCoeff();
  deepest_m_ = kDeepest * sizes_m_;
  for (const auto& [a, b] : overlapping(faces_, rest_m_, 0.5 * kDeepest * largest_size_m_)) {
    if (body_[static_cast<std::size_t>(a)] != body_[static_cast<std::size_t>(b)]) continue;
    deepest_m_[a] = std::min(deepest_m_[a], wall_m(faces_, a, b, rest_m_));
    deepest_m_[b] = std::min(deepest_m_[b], wall_m(faces_, b, a, rest_m_));
  }
}

bool SkinPairs::counts(int face, int other) const {
  const int same = same_[static_cast<std::size_t>(face)];
  if (pair_of(face, other) < 0) return false;
  if (body_[static_cast<std::size_t>(same)] != body_[static_cast<std::size_t>(other)]) return true;
  const auto mine = faces_.col(same), theirs = faces_.col(other);
  for (Eigen::Index a = 0; a < mine.size(); ++a)
    if (std::find(theirs.begin(), theirs.end(), mine[a]) != theirs.end()) return false;
  if (rest_normals_.col(same).dot(rest_normals_.col(other)) > kOneSide) return true;
  const Eigen::Vector3d between_m = rest_middles_m_.col(same) - rest_middles_m_.col(other);
  if (between_m.norm() > kBehind * largest_size_m_) return true;
  double foremost_m = -largest_size_m_;
  for (int corner = 0; corner < 3; ++corner)
    foremost_m =
        std::max(foremost_m, (rest_m_.col(mine[corner]) - rest_middles_m_.col(other)).dot(rest_normals_.col(other)));
  return foremost_m > kInFront * largest_size_m_;
}

bool SkinPairs::may_face(std::size_t face, int other) const {
  return normals_.col(same_[face]).dot(normals_.col(other)) < kOneWay;
}

void SkinPairs::prepare(const Eigen::Matrix3Xd& positions_m) {
  if (prepared_at_m_.cols() == positions_m.cols() && prepared_at_m_ == positions_m) return;
  prepared_at_m_ = positions_m;
  const auto count = static_cast<int>(faces_.cols());
  for (Eigen::Matrix3Xd* corners_m : {&low_m_, &high_m_, &deep_low_m_, &deep_high_m_}) corners_m->resize(3, count);
  normals_.resize(3, count);
  lowest_m_.resize(count);
  top_m_.resize(count);
  for (int face = 0; face < count; ++face) {
    const FaceNodes around = control_points(nodes_of(faces_, face, positions_m));
    normals_.col(face) = corner_normal(faces_, face, positions_m).normalized();
    const Eigen::RowVectorXd heights_m = normals_.col(face).transpose() * around;
    lowest_m_[face] = heights_m.minCoeff();
    top_m_[face] = heights_m.maxCoeff();
    low_m_.col(face) = around.rowwise().minCoeff();
    high_m_.col(face) = around.rowwise().maxCoeff();
    const Eigen::Vector3d behind_m = -deepest_m_[face] * normals_.col(face);
    deep_low_m_.col(face) = (low_m_.col(face) + behind_m.cwiseMin(0.0)).array() - kOverEdge * sizes_m_[face];
    deep_high_m_.col(face) = (high_m_.col(face) + behind_m.cwiseMax(0.0)).array() + kOverEdge * sizes_m_[face];
  }
  const bool near_enough = near_at_m_.cols() == positions_m.cols() &&
                           (positions_m - near_at_m_).colwise().squaredNorm().maxCoeff() < 0.25 * margin_m_ * margin_m_;
  if (!near_enough) find_near(positions_m);
  overlaps_.resize(near_.size());
  for (std::size_t face = 0; face < near_.size(); ++face) {
    const auto low_m = low_m_.col(same_[face]), high_m = high_m_.col(same_[face]);
    overlaps_[face].clear();
    for (const int other : near_[face])
      if ((deep_low_m_.col(other).array() <= high_m.array()).all() &&
          (deep_high_m_.col(other).array() >= low_m.array()).all() && may_face(face, other))
        overlaps_[face].push_back(other);
  }
}

bool SkinPairs::may_meet(int other, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward) const {
  if (normals_.col(other).dot(outward) > kAlong * outward.norm()) return false;
  const double height_m = normals_.col(other).dot(point_m), deepest_m = deepest_m_[other];
  return height_m > lowest_m_[other] - deepest_m && height_m < top_m_[other] + deepest_m;
}

bool SkinPairs::may_be_inside(int face, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward) const {
  const std::vector<int>& all = overlaps_[static_cast<std::size_t>(face)];
  return std::any_of(all.begin(), all.end(), [&](int other) {
    return (deep_low_m_.col(other).array() <= point_m.array()).all() &&
           (deep_high_m_.col(other).array() >= point_m.array()).all() && may_meet(other, point_m, outward) &&
           normals_.col(other).dot(point_m) < top_m_[other] + kOverEdge * sizes_m_[other];
  });
}

void SkinPairs::find_near(const Eigen::Matrix3Xd& positions_m) {
  near_at_m_ = positions_m;
  near_.assign(same_.size(), {});
  std::vector<int> mine(static_cast<std::size_t>(faces_.cols()), -1);
  for (std::size_t face = 0; face < same_.size(); ++face)
    mine[static_cast<std::size_t>(same_[face])] = static_cast<int>(face);
  const auto add = [&](int face, int other) {
    const int own = mine[static_cast<std::size_t>(face)];
    if (own >= 0 && counts(own, other)) near_[static_cast<std::size_t>(own)].push_back(other);
  };
  const double wider_m = 0.5 * (margin_m_ + kDeepest * largest_size_m_) + 1e-6 * positions_m.cwiseAbs().maxCoeff();
  for (const auto& [a, b] : overlapping(faces_, positions_m, wider_m)) {
    if (a == b) continue;
    add(a, b);
    add(b, a);
  }
  for (std::vector<int>& of_face : near_) {
    std::sort(of_face.begin(), of_face.end());
    of_face.erase(std::unique(of_face.begin(), of_face.end()), of_face.end());
  }
}

// What a point finds on one face, where it is in front of it, or not deeper inside than counts.
std::optional<SkinGap> SkinPairs::gap_to(int other, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                                         const Eigen::Matrix3Xd& positions_m) const {
  const FaceNodes nodes = nodes_of(faces_, other, positions_m);
  const Eigen::Vector2d local = closest(nodes, point_m);
  const FaceShape shape = face_shape(nodes.cols(), local.x(), local.y());
  const Eigen::Matrix<double, 3, 2> tangents = nodes * shape.slopes.transpose();
  SkinGap gap;
  gap.normal = tangents.col(0).cross(tangents.col(1)).normalized();
  if (!gap.normal.allFinite() || gap.normal.dot(outward) >= -kAgainst * outward.norm()) return std::nullopt;
  const Eigen::Vector3d off_m = point_m - nodes * shape.values;
  gap.gap_m = gap.normal.dot(off_m);
  const double beyond_edge_m = (off_m - gap.gap_m * gap.normal).norm();
  if (std::abs(gap.gap_m) > deepest_m_[other] || beyond_edge_m > kOverEdge * sizes_m_[other]) return std::nullopt;
  gap.at.face = other;
  gap.at.r = local.x();
  gap.at.s = local.y();
  gap.at.shape.head(nodes.cols()) = shape.values;
  gap.at.slopes.topRows(nodes.cols()) = shape.slopes.transpose();
  gap.at.dual_per_m = tangents * Eigen::Matrix2d(tangents.transpose() * tangents).inverse();
  const Eigen::Vector3d bends = (nodes * face_bends(nodes.cols())).transpose() * gap.normal;
  const Eigen::Matrix2d curvature = (Eigen::Matrix2d() << bends[0], bends[2], bends[2], bends[1]).finished();
  gap.curvature_per_m = gap.at.dual_per_m * curvature * gap.at.dual_per_m.transpose();
  return gap;
}

double SkinPairs::least_gap_m(int other, const Eigen::Vector3d& point_m) const {
  const double height_m = normals_.col(other).dot(point_m);
  return std::max({(low_m_.col(other) - point_m).maxCoeff(), (point_m - high_m_.col(other)).maxCoeff(),
                   height_m - top_m_[other], lowest_m_[other] - height_m});
}

// The one that may be nearest first, as then most others need no closer look.
std::optional<SkinGap> SkinPairs::meet(int face, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                                       const Eigen::Matrix3Xd& positions_m) const {
  const std::vector<int>& near = near_[static_cast<std::size_t>(face)];
  const auto may = [&](int other, double reach_m) {
    return least_gap_m(other, point_m) <= reach_m && may_meet(other, point_m, outward);
  };
  int first = -1;
  double least_m = 0.0;
  for (const int other : near) {
    if (!may(other, first < 0 ? deepest_m_[other] : std::min(least_m, deepest_m_[other]))) continue;
    first = other;
    least_m = least_gap_m(other, point_m);
  }
  if (first < 0) return std::nullopt;
  std::optional<SkinGap> best = gap_to(first, point_m, outward, positions_m);
  for (const int other : near) {
    if (other == first || !may(other, best ? std::abs(best->gap_m) : deepest_m_[other])) continue;
    const std::optional<SkinGap> gap = gap_to(other, point_m, outward, positions_m);
    if (gap && (!best || std::abs(gap->gap_m) < std::abs(best->gap_m))) best = gap;
  }
  return best;
}

std::optional<SkinAnchor> SkinPairs::anchor(int face, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                                            const Eigen::Matrix3Xd& positions_m) const {
  std::optional<SkinAnchor> best;
  double best_m = 0.0;
  for (const int other : near_[static_cast<std::size_t>(face)]) {
    const double reach_m = best ? best_m : sizes_m_[other];
    if ((point_m - low_m_.col(other)).minCoeff() < -reach_m || (high_m_.col(other) - point_m).minCoeff() < -reach_m)
      continue;
    if (normals_.col(other).dot(outward) > -kAgainst * outward.norm()) continue;
    const FaceNodes nodes = nodes_of(faces_, other, positions_m);
    const Eigen::Vector2d local = closest(nodes, point_m);
    const FaceShape shape = face_shape(nodes.cols(), local.x(), local.y());
    const Eigen::Vector3d off_m = point_m - nodes * shape.values;
    if (off_m.norm() > reach_m) continue;
    const Eigen::Matrix<double, 3, 2> tangents = nodes * shape.slopes.transpose();
    const Eigen::Vector2d there =
        local + Eigen::Matrix2d(tangents.transpose() * tangents).inverse() * (tangents.transpose() * off_m);
    best_m = off_m.norm();
    best = {other, there.x(), there.y()};
  }
  return best;
}

Eigen::Vector3d SkinPairs::at(int face, double r, double s, const Eigen::Matrix3Xd& positions_m) const {
  return nodes_of(faces_, face, positions_m) * face_shape(faces_.rows(), r, s).values;
}

std::vector<int> SkinPairs::nodes(const FacePair& pair) const {
  const auto own = faces_.col(same_[static_cast<std::size_t>(pair.first)]), other = faces_.col(pair.second);
  std::vector<int> both(own.begin(), own.end());
  both.insert(both.end(), other.begin(), other.end());
  return both;
}

}  // namespace soft_robot_lab
