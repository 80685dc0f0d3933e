// SPDX-License-Identifier: BSD-3-Clause
#include "skin_pairs.h"

#include <algorithm>
#include <array>
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
constexpr std::size_t kMostPairs = 4000000;  // of faces of which it is kept whether they count

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
  explicit FacePolynomial(const FaceNodes& n) : corner_(n.col(0)), r_(n.col(1) - corner_), s_(n.col(2) - corner_) {
    rr_.setZero();
    rs_.setZero();
    ss_.setZero();
    if (n.cols() == 3) return;
    rr_ = 2.0 * (n.col(0) + n.col(1) - 2.0 * n.col(3));
    rs_ = 4.0 * (n.col(0) - n.col(3) + n.col(4) - n.col(5));
    ss_ = 2.0 * (n.col(0) + n.col(2) - 2.0 * n.col(5));
    r_ -= rr_;
    s_ -= ss_;
  }
  Eigen::Vector3d at(double r, double s) const { return corner_ + r * (r_ + r * rr_ + s * rs_) + s * (s_ + s * ss_); }
  Eigen::Vector3d along_r(double r, double s) const { return r_ + 2.0 * r * rr_ + s * rs_; }
  Eigen::Vector3d along_s(double r, double s) const { return s_ + r * rs_ + 2.0 * s * ss_; }

 private:
  Eigen::Vector3d corner_, r_, s_, rr_, rs_, ss_;
};

// Coordinates of the closest place, by Gauss and Newton's method, kept on the face.
Eigen::Vector2d closest(const FacePolynomial& face, const Eigen::Vector3d& point_m) {
  Eigen::Vector2d local = Eigen::Vector2d::Constant(1.0 / 3.0);
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    const Eigen::Vector3d r = face.along_r(local.x(), local.y()), s = face.along_s(local.x(), local.y());
    const Eigen::Vector3d off_m = point_m - face.at(local.x(), local.y());
    const double rr = r.dot(r), rs = r.dot(s), ss = s.dot(s), by_r = r.dot(off_m), by_s = s.dot(off_m);
    const double scale = 1.0 / (rr * ss - rs * rs);
    const Eigen::Vector2d change(scale * (ss * by_r - rs * by_s), scale * (rr * by_s - rs * by_r));
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
  for (Eigen::Matrix3Xd* columns : {&low_m_, &high_m_, &deep_low_m_, &deep_high_m_, &normals_, &farthest_m_})
    columns->resize(3, count);
  sideways_.resize(3, 3 * count);
  around_m_.resize(3, faces_.rows() * count);
  reach_.resize(same_.size());
  lowest_m_.resize(count);
  top_m_.resize(count);
  for (int face = 0; face < points.face_count(); ++face) {
    std::vector<int>& besides = beside_.emplace_back();
    for (int point = points.first_point(face); point < points.first_point(face + 1); ++point)
      if (points.guards(point) && (besides.empty() || besides.back() != points.beside(point)))
        besides.push_back(points.beside(point));
  }
  const std::size_t pairs = same_.size() * static_cast<std::size_t>(count);
  if (pairs <= kMostPairs) counts_.assign(pairs, -1);
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
  for (Eigen::Index a = 0; a < 3; ++a)  // what shares a node shares a corner
    for (Eigen::Index b = 0; b < 3; ++b)
      if (mine[a] == theirs[b]) return false;
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
  const bool near_enough = near_at_m_.cols() == positions_m.cols() &&
                           (positions_m - near_at_m_).colwise().squaredNorm().maxCoeff() < 0.25 * margin_m_ * margin_m_;
  if (!near_enough) find_near(positions_m);
  for (const int face : in_reach_) prepare_face(face, positions_m);
  for (Reach& reach : reach_) reach.known = false;
  // Along a long body most are apart, so that axis is looked at first.
  std::array<int, 3> axes{0, 1, 2};
  const Eigen::Vector3d extent_m = positions_m.rowwise().maxCoeff() - positions_m.rowwise().minCoeff();
  std::sort(axes.begin(), axes.end(), [&](int a, int b) { return extent_m[a] > extent_m[b]; });
  overlaps_.resize(near_.size());
  for (std::size_t face = 0; face < near_.size(); ++face) {
    const double *low_m = &low_m_(0, same_[face]), *high_m = &high_m_(0, same_[face]);
    overlaps_[face].clear();
    for (const int other : near_[face]) {
      const double *other_low_m = &deep_low_m_(0, other), *other_high_m = &deep_high_m_(0, other);
      const auto meets = [&](int axis) {
        return other_low_m[axis] <= high_m[axis] && other_high_m[axis] >= low_m[axis];
      };
      if (meets(axes[0]) && meets(axes[1]) && meets(axes[2]) && may_face(face, other) && goes_below(face, other))
        overlaps_[face].push_back(other);
    }
  }
}

void SkinPairs::prepare_face(int face, const Eigen::Matrix3Xd& positions_m) {
  const FaceNodes around = control_points(nodes_of(faces_, face, positions_m));
  around_m_.middleCols(around.cols() * face, around.cols()) = around;
  const Eigen::Vector3d normal = corner_normal(faces_, face, positions_m).normalized();
  Eigen::Vector3d low_m = around.col(0), high_m = low_m;
  Eigen::Vector2d heights_m = Eigen::Vector2d::Constant(normal.dot(low_m));
  std::array<Eigen::Vector3d, 3> sideways;
  Eigen::Vector3d farthest_m;
  for (int side = 0; side < 3; ++side) {
    sideways[side] = (around.col((side + 1) % 3) - around.col(side)).cross(normal).normalized();
    farthest_m[side] = sideways[side].dot(low_m);
  }
  for (Eigen::Index a = 1; a < around.cols(); ++a) {
    const Eigen::Vector3d at_m = around.col(a);
    const double height_m = normal.dot(at_m);
    low_m = low_m.cwiseMin(at_m);
    high_m = high_m.cwiseMax(at_m);
    heights_m = {std::min(heights_m[0], height_m), std::max(heights_m[1], height_m)};
    for (int side = 0; side < 3; ++side) farthest_m[side] = std::max(farthest_m[side], sideways[side].dot(at_m));
  }
  normals_.col(face) = normal;
  lowest_m_[face] = heights_m[0];
  top_m_[face] = heights_m[1];
  low_m_.col(face) = low_m;
  high_m_.col(face) = high_m;
  farthest_m_.col(face) = farthest_m;
  for (int side = 0; side < 3; ++side) sideways_.col(3 * face + side) = sideways[side];
  const Eigen::Vector3d behind_m = -deepest_m_[face] * normal;
  deep_low_m_.col(face) = (low_m + behind_m.cwiseMin(0.0)).array() - kOverEdge * sizes_m_[face];
  deep_high_m_.col(face) = (high_m + behind_m.cwiseMax(0.0)).array() + kOverEdge * sizes_m_[face];
}

bool SkinPairs::goes_below(std::size_t face, int other) const {
  const Eigen::Index first = faces_.rows() * same_[face];
  const double top_m = top_m_[other] + kOverEdge * sizes_m_[other];
  for (Eigen::Index a = 0; a < faces_.rows(); ++a)
    if (normals_.col(other).dot(around_m_.col(first + a)) < top_m) return true;
  return false;
}

bool SkinPairs::out_of_reach(std::size_t face, int other) const {
  const int same = same_[face];
  const double deepest_m = deepest_m_[other];
  return (low_m_.col(other) - high_m_.col(same)).maxCoeff() > deepest_m ||
         (low_m_.col(same) - high_m_.col(other)).maxCoeff() > deepest_m;
}

const std::vector<int>& SkinPairs::in_reach_of(int face) const {
  Reach& reach = reach_[static_cast<std::size_t>(face)];
  if (reach.known) return reach.others;
  reach.known = true;
  reach.others.clear();
  for (const int other : near_[static_cast<std::size_t>(face)])
    if (!out_of_reach(static_cast<std::size_t>(face), other)) reach.others.push_back(other);
  return reach.others;
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
    if (own < 0) return;
    signed char unknown = -1;
    signed char& known = counts_.empty()
                             ? unknown
                             : counts_[static_cast<std::size_t>(own) * static_cast<std::size_t>(faces_.cols()) +
                                       static_cast<std::size_t>(other)];
    if (known < 0) known = counts(own, other) ? 1 : 0;
    if (known == 1) near_[static_cast<std::size_t>(own)].push_back(other);
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
  std::vector<bool> in_reach(static_cast<std::size_t>(faces_.cols()), false);
  for (std::size_t face = 0; face < near_.size(); ++face) {
    if (near_[face].empty()) continue;
    in_reach[static_cast<std::size_t>(same_[face])] = true;
    for (const int other : near_[face]) in_reach[static_cast<std::size_t>(other)] = true;
    for (const int other : beside_[face]) in_reach[static_cast<std::size_t>(other)] = true;
  }
  in_reach_.clear();
  for (std::size_t face = 0; face < in_reach.size(); ++face)
    if (in_reach[face]) in_reach_.push_back(static_cast<int>(face));
}

// What a point finds on one face, where it is in front of it, or not deeper inside than counts.
std::optional<SkinPairs::Meeting> SkinPairs::meeting(int other, const Eigen::Vector3d& point_m,
                                                     const Eigen::Vector3d& outward,
                                                     const Eigen::Matrix3Xd& positions_m) const {
  const FacePolynomial face(nodes_of(faces_, other, positions_m));
  Meeting met;
  met.face = other;
  met.local = closest(face, point_m);
  const double r = met.local.x(), s = met.local.y();
  met.normal = face.along_r(r, s).cross(face.along_s(r, s)).normalized();
  if (!met.normal.allFinite() || met.normal.dot(outward) >= -kAgainst * outward.norm()) return std::nullopt;
  const Eigen::Vector3d off_m = point_m - face.at(r, s);
  met.gap_m = met.normal.dot(off_m);
  const double beyond_edge_m = (off_m - met.gap_m * met.normal).norm();
  if (std::abs(met.gap_m) > deepest_m_[other] || beyond_edge_m > kOverEdge * sizes_m_[other]) return std::nullopt;
  return met;
}

SkinGap SkinPairs::gap_at(const Meeting& met, const Eigen::Matrix3Xd& positions_m) const {
  const FaceNodes nodes = nodes_of(faces_, met.face, positions_m);
  const FaceShape shape = face_shape(nodes.cols(), met.local.x(), met.local.y());
  const Eigen::Matrix<double, 3, 2> tangents = nodes * shape.slopes.transpose();
  SkinGap gap;
  gap.gap_m = met.gap_m;
  gap.normal = met.normal;
  gap.at.face = met.face;
  gap.at.r = met.local.x();
  gap.at.s = met.local.y();
  gap.at.shape.head(nodes.cols()) = shape.values;
  gap.at.slopes.topRows(nodes.cols()) = shape.slopes.transpose();
  gap.at.dual_per_m = tangents * Eigen::Matrix2d(tangents.transpose() * tangents).inverse();
  const Eigen::Vector3d bends = (nodes * face_bends(nodes.cols())).transpose() * gap.normal;
  const Eigen::Matrix2d curvature = (Eigen::Matrix2d() << bends[0], bends[2], bends[2], bends[1]).finished();
  gap.curvature_per_m = gap.at.dual_per_m * curvature * gap.at.dual_per_m.transpose();
  return gap;
}

// By its box, by the planes that it lies between, and by those along its sides.
double SkinPairs::least_distance_m(int other, const Eigen::Vector3d& point_m) const {
  const double height_m = normals_.col(other).dot(point_m);
  double least_m = std::max({(low_m_.col(other) - point_m).maxCoeff(), (point_m - high_m_.col(other)).maxCoeff(),
                             height_m - top_m_[other], lowest_m_[other] - height_m});
  for (int side = 0; side < 3; ++side)
    least_m = std::max(least_m, sideways_.col(3 * other + side).dot(point_m) - farthest_m_(side, other));
  return least_m;
}

// The one that may be nearest first, as then most others need no closer look.
std::optional<SkinGap> SkinPairs::meet(int face, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                                       const Eigen::Matrix3Xd& positions_m) const {
  const std::vector<int>& near = in_reach_of(face);
  int first = -1;
  double least_m = 0.0;
  for (const int other : near) {
    const double distance_m = least_distance_m(other, point_m);
    if (distance_m > deepest_m_[other] || (first >= 0 && distance_m >= least_m) || !may_meet(other, point_m, outward))
      continue;
    first = other;
    least_m = distance_m;
  }
  if (first < 0) return std::nullopt;
  std::optional<Meeting> best = meeting(first, point_m, outward, positions_m);
  for (const int other : near) {
    const double reach_m = best ? std::abs(best->gap_m) : deepest_m_[other];
    if (other == first || least_distance_m(other, point_m) > reach_m || !may_meet(other, point_m, outward)) continue;
    const std::optional<Meeting> met = meeting(other, point_m, outward, positions_m);
    if (met && (!best || std::abs(met->gap_m) < std::abs(best->gap_m))) best = met;
  }
  if (!best) return std::nullopt;
  return gap_at(*best, positions_m);
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
    const Eigen::Vector2d local = closest(FacePolynomial(nodes), point_m);
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
