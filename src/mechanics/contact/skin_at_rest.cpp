// SPDX-License-Identifier: BSD-3-Clause
#include "skin_at_rest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <Eigen/Geometry>

#include "closest_place.h"
#include "present_faces.h"

namespace soft_robot_lab {
namespace {

constexpr double kBehind = 4.0;    // of the largest face's size: walls are looked for so near
constexpr double kInFront = 1e-9;  // of the same: a face that has no corner so far in front of another lies behind it
constexpr double kOneSide = 0.5;   // cosine: faces whose normals agree so are one side of a wall; it may fold
constexpr double kBeside = 0.25, kDeeperBehind = 1.25;  // of a face's size; of the depth that counts
constexpr int kLookedAt = 6;                            // along a side of a face: places of it that are looked at
constexpr std::size_t kMostPairs = 4000000;             // of faces of which it is kept whether they count

// The area vector of a face's corners.
Eigen::Vector3d corner_normal(const Eigen::MatrixXi& faces, int face, const Eigen::Matrix3Xd& positions_m) {
  const Eigen::Vector3d a = positions_m.col(faces(0, face));
  return (positions_m.col(faces(1, face)) - a).cross(positions_m.col(faces(2, face)) - a);
}

// How far behind the middle of a face at rest another one is that looks the other way; infinite where the line from
// there does not meet it.
double wall_m(const Eigen::MatrixXi& faces, int face, int other, const Eigen::Matrix3Xd& rest_m) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d out = corner_normal(faces, face, rest_m).normalized();
  const Eigen::Vector3d area_m2 = corner_normal(faces, other, rest_m);
  if (out.dot(area_m2) > -SkinAtRest::kAgainst * area_m2.norm()) return kInfinite;
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

// By Bullet.
std::vector<std::pair<int, int>> overlapping_faces(const Eigen::MatrixXi& faces, const Eigen::Matrix3Xd& positions_m,
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

TouchingPairs::TouchingPairs(const Body& body)
    : of_bodies_(Eigen::MatrixXi::Constant(body.mesh().bodies.size(), body.mesh().bodies.size(), -1)) {
  int index = 0;
  for (const TouchingBodies& pair : body.touching_bodies())
    of_bodies_(pair.first, pair.second) = of_bodies_(pair.second, pair.first) = index++;
}

SkinAtRest::SkinAtRest(const Body& body, const ContactPoints& points)
    : faces_(body.mesh().faces),
      nodes_m_(body.mesh().nodes_m),
      same_(points.mesh_faces()),
      body_(bodies_of_faces(body)),
      touching_(body) {
  const auto count = static_cast<int>(faces_.cols());
  const std::set<int> nodes(faces_.reshaped().begin(), faces_.reshaped().end());
  nodes_.assign(nodes.begin(), nodes.end());
  middles_m_.resize(3, count);
  normals_.resize(3, count);
  sizes_m_.resize(count);
  for (int face = 0; face < count; ++face) {
    const Eigen::Vector3d area_m2 = corner_normal(faces_, face, nodes_m_);
    middles_m_.col(face) = nodes_of(faces_, face, nodes_m_).rowwise().mean();
    normals_.col(face) = area_m2.normalized();
    sizes_m_[face] = std::sqrt(area_m2.norm());
  }
  const std::size_t pairs = same_.size() * static_cast<std::size_t>(count);
  if (pairs <= kMostPairs) kept_.assign(pairs, -1);
  largest_size_m_ = sizes_m_.maxCoeff();
  deepest_m_ = kDeepest * sizes_m_;
  for (const auto& [a, b] : overlapping_faces(faces_, nodes_m_, 0.5 * kDeepest * largest_size_m_)) {
    if (body_of(a) != body_of(b)) continue;
    deepest_m_[a] = std::min(deepest_m_[a], wall_m(faces_, a, b, nodes_m_));
    deepest_m_[b] = std::min(deepest_m_[b], wall_m(faces_, b, a, nodes_m_));
  }
}

bool SkinAtRest::counts_kept(int face, int other) {
  if (kept_.empty()) return counts(face, other);
  signed char& known =
      kept_[static_cast<std::size_t>(face) * static_cast<std::size_t>(faces_.cols()) + static_cast<std::size_t>(other)];
  if (known < 0) known = counts(face, other) ? 1 : 0;
  return known == 1;
}

bool SkinAtRest::counts(int face, int other) const {
  const int same = this->same(face);
  if (pair_of(face, other) < 0) return false;
  if (body_of(same) != body_of(other)) return true;
  const auto mine = faces_.col(same), theirs = faces_.col(other);
  for (Eigen::Index a = 0; a < 3; ++a)  // what shares a node shares a corner
    for (Eigen::Index b = 0; b < 3; ++b)
      if (mine[a] == theirs[b]) return false;
  if (normals_.col(same).dot(normals_.col(other)) > kOneSide) return true;
  const Eigen::Vector3d between_m = middles_m_.col(same) - middles_m_.col(other);
  if (between_m.norm() > kBehind * largest_size_m_) return true;
  double foremost_m = -largest_size_m_;
  for (int corner = 0; corner < 3; ++corner)
    foremost_m = std::max(foremost_m, (nodes_m_.col(mine[corner]) - middles_m_.col(other)).dot(normals_.col(other)));
  return foremost_m > kInFront * largest_size_m_ && !overlap(same, other) && !overlap(other, same);
}

// Of a curved wall that its faces follow roughly a face may lie partly behind one that is not opposite, no deeper than
// counts. By the planes of corners; what lies a little beside the other counts too, as a small deformation brings it
// there.
bool SkinAtRest::overlap(int mine, int other) const {
  const Eigen::Vector3d& normal = normals_.col(other);
  if (normals_.col(mine).dot(normal) > -kAgainst) return false;
  const Eigen::Matrix3d corners_m = nodes_m_(Eigen::all, faces_.col(mine).head<3>()),
                        theirs_m = nodes_m_(Eigen::all, faces_.col(other).head<3>());
  Eigen::Matrix3d beyond;  // of each side, unit vectors
  for (int side = 0; side < 3; ++side)
    beyond.col(side) = (theirs_m.col((side + 1) % 3) - theirs_m.col(side)).cross(normal).normalized();
  for (int i = 0; i <= kLookedAt; ++i)
    for (int j = 0; i + j <= kLookedAt; ++j) {
      const Eigen::Vector3d at_m = corners_m * Eigen::Vector3d(i, j, kLookedAt - i - j) / kLookedAt;
      const double depth_m = (theirs_m.col(0) - at_m).dot(normal);
      if (depth_m < kHeldOver * sizes_m_[other] || depth_m > kDeeperBehind * deepest_m_[other]) continue;
      double beside_m = 0.0;
      for (int side = 0; side < 3; ++side)
        beside_m = std::max(beside_m, (at_m - theirs_m.col(side)).dot(beyond.col(side)));
      if (beside_m < kBeside * sizes_m_[other]) return true;
    }
  return false;
}

}  // namespace soft_robot_lab
