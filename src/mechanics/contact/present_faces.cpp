// SPDX-License-Identifier: BSD-3-Clause
#include "present_faces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr double kSteepest = 1e3;  // as a tangent: normals of a face that tilt so far may tilt any way

// Normals of a quadratic face lie between products of its derivatives at corners, of one along r and one along s.
double largest_tilt(const Eigen::Vector3d& normal, const Eigen::Matrix<double, 3, 6>& around_m) {
  const auto& p = around_m;
  Eigen::Matrix3d r, s;
  r << p.col(3) - p.col(0), p.col(1) - p.col(3), p.col(4) - p.col(5);
  s << p.col(5) - p.col(0), p.col(4) - p.col(3), p.col(2) - p.col(5);
  double largest = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      const Eigen::Vector3d product = r.col(i).cross(s.col(j)) + r.col(j).cross(s.col(i));
      const double along = product.dot(normal);
      if (along * kSteepest <= product.norm()) return kSteepest;
      largest = std::max(largest, product.squaredNorm() / (along * along) - 1.0);
    }
  }
  return std::sqrt(largest);
}

}  // namespace

FaceNodes nodes_of(const Eigen::MatrixXi& faces, int face, const Eigen::Matrix3Xd& positions_m) {
  FaceNodes nodes(3, faces.rows());
  for (Eigen::Index a = 0; a < faces.rows(); ++a) nodes.col(a) = positions_m.col(faces(a, face));
  return nodes;
}

double apart_m(const PresentFace& mine, const PresentFace& theirs) {
  return std::max((theirs.deep_low_m - mine.high_m).maxCoeff(), (mine.low_m - theirs.deep_high_m).maxCoeff());
}

double lowest_above_m(const PresentFace& mine, const PresentFace& theirs) {
  double lowest_m = theirs.normal.dot(mine.around_m.col(0));
  for (Eigen::Index a = 1; a < mine.around_m.cols(); ++a)
    lowest_m = std::min(lowest_m, theirs.normal.dot(mine.around_m.col(a)));
  return lowest_m - theirs.top_m;
}

PresentFaces::PresentFaces(Eigen::MatrixXi faces, Eigen::VectorXd deepest_m, Eigen::VectorXd over_edge_m)
    : faces_(std::move(faces)),
      deepest_m_(std::move(deepest_m)),
      over_edge_m_(std::move(over_edge_m)),
      all_(static_cast<std::size_t>(faces_.cols())),
      known_(static_cast<std::size_t>(faces_.cols())) {}

bool PresentFaces::move_to(const Eigen::Matrix3Xd& positions_m) {
  if (positions_m_.cols() == positions_m.cols() && positions_m_ == positions_m) return false;
  positions_m_ = positions_m;
  std::fill(known_.begin(), known_.end(), 0);
  return true;
}

void PresentFaces::look_at(int face) const {
  known_[static_cast<std::size_t>(face)] = 1;
  PresentFace& at = all_[static_cast<std::size_t>(face)];
  at.turns_per_m = at.tilt = -1.0;
  at.knows_sides = false;
  auto& around = at.around_m;  // control points of the face as a Bezier triangle
  for (int corner = 0; corner < 3; ++corner) around.col(corner) = positions_m_.col(faces_(corner, face));
  for (int edge = 0; edge < 3; ++edge) {
    if (faces_.rows() == 6)
      around.col(3 + edge) =
          2.0 * positions_m_.col(faces_(3 + edge, face)) - 0.5 * (around.col(edge) + around.col((edge + 1) % 3));
    else
      around.col(3 + edge) = around.col(edge);
  }
  at.normal = (around.col(1) - around.col(0)).cross(around.col(2) - around.col(0)).normalized();
  at.low_m = around.rowwise().minCoeff();
  at.high_m = around.rowwise().maxCoeff();
  at.lowest_m = at.top_m = at.normal.dot(around.col(0));
  for (int a = 1; a < 6; ++a) {
    const double height_m = at.normal.dot(around.col(a));
    at.lowest_m = std::min(at.lowest_m, height_m);
    at.top_m = std::max(at.top_m, height_m);
  }
  const Eigen::Vector3d behind_m = -deepest_m_[face] * at.normal;
  at.deep_low_m = (at.low_m + behind_m.cwiseMin(0.0)).array() - over_edge_m_[face];
  at.deep_high_m = (at.high_m + behind_m.cwiseMax(0.0)).array() + over_edge_m_[face];
}

// Two edges move by twice the way, so their product by so much of itself. Where that is by less than 0.8 the normal
// changes by less than 2.5 times as much; it never changes by more than 2.
double PresentFaces::turns_per_m(int face) const {
  const auto& around = (*this)[face].around_m;
  double& turns_per_m = all_[static_cast<std::size_t>(face)].turns_per_m;
  if (turns_per_m >= 0.0) return turns_per_m;
  const Eigen::Vector3d along = around.col(1) - around.col(0), across = around.col(2) - around.col(0);
  return turns_per_m = 2.5 * 2.0 * (along.norm() + across.norm()) / along.cross(across).norm();
}

const PresentFace& PresentFaces::with_sides(int face) const {
  (*this)[face];
  PresentFace& at = all_[static_cast<std::size_t>(face)];
  if (at.knows_sides) return at;
  for (int side = 0; side < 3; ++side)
    at.sideways.row(side) = (at.around_m.col((side + 1) % 3) - at.around_m.col(side)).cross(at.normal).normalized();
  at.farthest_m = at.sideways * at.around_m.col(0);
  for (Eigen::Index a = 1; a < at.around_m.cols(); ++a)
    at.farthest_m = at.farthest_m.cwiseMax(at.sideways * at.around_m.col(a));
  at.knows_sides = true;
  return at;
}

double PresentFaces::tilt(int face) const {
  double& tilt = all_[static_cast<std::size_t>(face)].tilt;
  if (tilt < 0.0) tilt = faces_.rows() == 6 ? largest_tilt((*this)[face].normal, (*this)[face].around_m) : 0.0;
  return tilt;
}

}  // namespace soft_robot_lab
