// SPDX-License-Identifier: BSD-3-Clause
#include "closest_place.h"

#include <algorithm>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {
namespace {

constexpr int kMostIterations = 12, kLooksBeside = 3, kStepsBeyond = 3;
constexpr double kSoFarBeyond = 0.1;  // coordinates
constexpr double kOnEdge = 1e-12;     // the same
constexpr double kStillConvex = 0.1;  // of a flat face's determinant

Eigen::Vector2d into_triangle(Eigen::Vector2d local) {
  local = local.cwiseMax(0.0);
  const double across = local.sum() - 1.0;
  if (across > 0.0) local -= Eigen::Vector2d::Constant(0.5 * across);
  local = local.cwiseMax(0.0);
  return local / std::max(1.0, local.sum());
}

// A step towards the closest place, by Newton's method; by Gauss and Newton's where the distance has no minimum nearby.
struct StepOnFace {
  Eigen::Vector2d change;
  Eigen::Vector3d r, s;  // the face's derivatives where it starts
  double rr, rs, ss;     // of half the squared distance

  StepOnFace(const FacePolynomial& face, const Eigen::Vector3d& point_m, const Eigen::Vector2d& local)
      : r(face.along_r(local.x(), local.y())), s(face.along_s(local.x(), local.y())) {
    const Eigen::Vector3d off_m = point_m - face.at(local.x(), local.y());
    rr = r.dot(r);
    rs = r.dot(s);
    ss = s.dot(s);
    const double by_r = r.dot(off_m), by_s = s.dot(off_m), flat = rr * ss - rs * rs;
    const Eigen::Vector3d bends = face.bends(off_m);
    if ((rr - bends[0]) * (ss - bends[1]) - (rs - bends[2]) * (rs - bends[2]) > kStillConvex * flat && rr > bends[0]) {
      rr -= bends[0];
      ss -= bends[1];
      rs -= bends[2];
    }
    const double scale = 1.0 / (rr * ss - rs * rs);
    change = {scale * (ss * by_r - rs * by_s), scale * (rr * by_s - rs * by_r)};
  }

  // How far such coordinates are beyond an edge, as if the face went on straight; less how far the step was.
  double surely_beyond_m(const Eigen::Vector2d& local) const {
    const double beside_r = -local.x() / s.norm(), beside_s = -local.y() / r.norm();
    const double across = (local.sum() - 1.0) / (r - s).norm();
    return r.cross(s).norm() * std::max({beside_r, beside_s, across}) - (change.x() * r + change.y() * s).norm();
  }
};

// The direction of the edge where a place is; zero at a corner.
Eigen::Vector2d edge_at(const Eigen::Vector2d& local) {
  const bool r = local.x() <= kOnEdge, s = local.y() <= kOnEdge, across = local.sum() >= 1.0 - kOnEdge;
  if (r + s + across != 1) return Eigen::Vector2d::Zero();
  return r ? Eigen::Vector2d(0.0, 1.0) : s ? Eigen::Vector2d(1.0, 0.0) : Eigen::Vector2d(1.0, -1.0);
}

const Eigen::Vector2d kMiddle(1.0 / 3.0, 1.0 / 3.0);

Eigen::Vector2d closest_from(const FacePolynomial& face, const Eigen::Vector3d& point_m, Eigen::Vector2d local) {
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    const Eigen::Vector2d next = into_triangle(local + StepOnFace(face, point_m, local).change);
    const double moved = (next - local).cwiseAbs().maxCoeff();
    local = next;
    if (!(moved > 1e-13)) break;
  }
  return local;
}

}  // namespace

FacePolynomial::FacePolynomial(const FaceNodes& nodes)
    : corner_(nodes.col(0)), r_(nodes.col(1) - corner_), s_(nodes.col(2) - corner_) {
  rr_.setZero();
  rs_.setZero();
  ss_.setZero();
  if (nodes.cols() == 3) return;
  rr_ = 2.0 * (nodes.col(0) + nodes.col(1) - 2.0 * nodes.col(3));
  rs_ = 4.0 * (nodes.col(0) - nodes.col(3) + nodes.col(4) - nodes.col(5));
  ss_ = 2.0 * (nodes.col(0) + nodes.col(2) - 2.0 * nodes.col(5));
  r_ -= rr_;
  s_ -= ss_;
}

SeenPlace::SeenPlace(const FacePolynomial& face, const Eigen::Vector2d& coordinates, const Eigen::Vector3d& point_m)
    : local(coordinates),
      normal(face.along_r(local.x(), local.y()).cross(face.along_s(local.x(), local.y())).normalized()),
      off_m(point_m - face.at(local.x(), local.y())),
      gap_m(normal.dot(off_m)) {}

// closest() ends there where e . d = 0, with the edge e and the step d that is left, H d = t . off: the derivative of
// that. H as where the distance has a minimum.
PlaceAtEdge::PlaceAtEdge(const FaceNodes& nodes, const SeenPlace& place)
    : along(edge_at(place.local)),
      by_way_per_m(Eigen::Vector3d::Zero()),
      by_nodes_per_m(FaceNodes::Zero(3, nodes.cols())) {
  const FaceShape shape = face_shape(nodes.cols(), place.local.x(), place.local.y());
  const auto node_bends = face_bends(nodes.cols());
  const Eigen::Matrix<double, 3, 2> tangents = nodes * shape.slopes.transpose();
  const Eigen::Matrix3d bends = nodes * node_bends;
  dual_per_m = tangents * (tangents.transpose() * tangents).inverse();
  const Eigen::Vector3d bent_m = bends.transpose() * place.normal;
  curvature_m << bent_m[0], bent_m[2], bent_m[2], bent_m[1];
  beyond_m = place.off_m - place.gap_m * place.normal;
  if (along.isZero(0.0)) return;
  const StepOnFace step(FacePolynomial(nodes), nodes * shape.values + place.off_m, place.local);
  const Eigen::Vector2d& left = step.change;
  const Eigen::Vector2d by = (Eigen::Matrix2d() << step.rr, step.rs, step.rs, step.ss).finished().inverse() * along;
  const auto both = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return Eigen::Vector3d(a.x() * b.x(), a.y() * b.y(), a.x() * b.y() + a.y() * b.x());
  };
  const Eigen::Vector3d by_m = tangents * by, left_m = tangents * left, by_left = both(by, left);
  const double per = along.squaredNorm() + left_m.dot(bends * both(by, along)) + by_m.dot(bends * both(left, along)) +
                     (bends * by_left).dot(tangents * along);
  by_way_per_m = (by_m + bends * by_left) / per;
  for (Eigen::Index a = 0; a < nodes.cols(); ++a)
    by_nodes_per_m.col(a) = (shape.slopes.col(a).dot(by) * (place.off_m - left_m) -
                             shape.slopes.col(a).dot(left) * by_m + node_bends.row(a).dot(by_left) * place.off_m) /
                            per;
}

Eigen::Vector2d closest(const FacePolynomial& face, const Eigen::Vector3d& point_m) {
  return closest_from(face, point_m, kMiddle);
}

std::optional<Eigen::Vector2d> closest_above(const FacePolynomial& face, const Eigen::Vector3d& point_m,
                                             double most_m) {
  Eigen::Vector2d local = kMiddle;
  for (int iteration = 0; iteration < kLooksBeside; ++iteration) {
    const StepOnFace step(face, point_m, local);
    local += step.change;
    if (local.minCoeff() >= 0.0 && local.sum() <= 1.0) break;
    if (step.surely_beyond_m(local) > most_m) return std::nullopt;
  }
  return closest_from(face, point_m, into_triangle(local));
}

std::optional<SeenPlace> closest_beyond(const FacePolynomial& face, const Eigen::Vector3d& point_m,
                                        Eigen::Vector2d local) {
  for (int step = 0; step < kStepsBeyond; ++step) local += StepOnFace(face, point_m, local).change;
  if (!(std::max({-local.x(), -local.y(), local.sum() - 1.0}) <= kSoFarBeyond)) return std::nullopt;
  const SeenPlace place(face, local, point_m);
  if (!place.normal.allFinite()) return std::nullopt;
  return place;
}

}  // namespace soft_robot_lab
