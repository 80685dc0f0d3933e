// SPDX-License-Identifier: BSD-3-Clause
#include "closest_place.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr int kMostIterations = 12, kLooksBeside = 3, kStepsBeyond = 3;
constexpr double kSoFarBeyond = 0.1;  // coordinates
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

  StepOnFace(const FacePolynomial& face, const Eigen::Vector3d& point_m, const Eigen::Vector2d& local)
      : r(face.along_r(local.x(), local.y())), s(face.along_s(local.x(), local.y())) {
    const Eigen::Vector3d off_m = point_m - face.at(local.x(), local.y());
    double rr = r.dot(r), rs = r.dot(s), ss = s.dot(s);
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
