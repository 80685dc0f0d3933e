// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_energy.h"

#include <Eigen/LU>

#include "mechanics/elements/elements.h"

namespace soft_robot_lab {
namespace {

// How much a point's volume has grown.
struct Growth {
  FlatMatrix f;              // 1 + A
  double value;              // det F - 1
  Eigen::VectorXd gradient;  // d value / dq

  Growth(const RestPoint& point, const Eigen::VectorXd& q) {
    const Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity() + point.displacement_gradient(q);
    f = Eigen::Map<const FlatMatrix>(matrix.data());
    value = matrix.determinant() - 1.0;
    gradient = point.gradient.transpose() * (0.5 * tensor_cross(f, f));
  }
};

// d cof(F) for each column of D: F x D_i.
PointGradient cofactor_changes(const FlatMatrix& f, const PointGradient& d) {
  PointGradient changes(9, d.cols());
  for (Eigen::Index i = 0; i < d.cols(); ++i) changes.col(i) = tensor_cross(f, d.col(i));
  return changes;
}

}  // namespace

ReducedEnergy::ReducedEnergy(const Body& body, const ReducedBasis& basis)
    : mu_(body.material().lame_mu_pa()),
      lambda_(bulk_lambda_pa(body.material())),
      points_(rest_points(body.mesh(), basis.modes)),
      volumes_(points_, basis.pressures),
      stretch_(Eigen::MatrixXd::Zero(basis.modes.cols(), basis.modes.cols())),
      linear_(Eigen::VectorXd::Zero(basis.modes.cols())) {
  for (const RestPoint& point : points_) {
    rest_volume_m3_ += point.weight_m3;
    stretch_ += point.weight_m3 * point.gradient.transpose() * point.gradient;
    linear_ += point.weight_m3 * traces(point.gradient);
  }
  const Eigen::Matrix3Xd forces = body.external_forces_n();
  loads_ = basis.modes.transpose() * Eigen::Map<const Eigen::VectorXd>(forces.data(), forces.size());
}

void ReducedEnergy::keep_points(const Eigen::VectorXd& factors) {
  std::vector<RestPoint> kept;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const double factor = factors[static_cast<Eigen::Index>(i)];
    if (factor > 0.0) kept.push_back({points_[i].element, factor * points_[i].weight_m3, points_[i].gradient});
  }
  points_ = std::move(kept);
}

Eigen::VectorXd ReducedEnergy::scales(const Eigen::VectorXd& r) const {
  Eigen::VectorXd all(r.size() + 1);
  all << r, -mu_;
  return all;
}

ReducedEnergy::Sums ReducedEnergy::sums(const Eigen::VectorXd& q, const Eigen::VectorXd& r) const {
  VolumePolynomials::Values volumes = volumes_.at(q);
  const Eigen::VectorXd stretched = stretch_ * q;
  Sums result;
  result.force = mu_ * (stretched + linear_) + volumes.gradients * scales(r) - loads_;
  result.value = 0.5 * mu_ * (3.0 * rest_volume_m3_ + 2.0 * linear_.dot(q) + q.dot(stretched)) +
                 volumes.values.dot(scales(r)) - r.squaredNorm() / (2.0 * lambda_) - loads_.dot(q);
  for (const RestPoint& point : points_) {
    const Growth growth(point, q);
    const double weight = mu_ * point.weight_m3;
    result.value += 0.5 * weight * growth.value * growth.value;
    result.force += weight * growth.value * growth.gradient;
  }
  result.mismatch = volumes.values.head(r.size()) - r / lambda_;
  result.volume_gradients = volumes.gradients.leftCols(r.size());
  return result;
}

Eigen::MatrixXd ReducedEnergy::hessian(const Eigen::VectorXd& q, const Eigen::VectorXd& r) const {
  Eigen::MatrixXd result = mu_ * stretch_ + volumes_.hessian(q, scales(r));
  for (const RestPoint& point : points_) {
    const Growth growth(point, q);
    const double weight = mu_ * point.weight_m3;
    result += weight * (growth.gradient * growth.gradient.transpose());
    result += weight * growth.value * point.gradient.transpose() * cofactor_changes(growth.f, point.gradient);
  }
  return result;
}

Eigen::MatrixXd ReducedEnergy::point_forces(const Eigen::VectorXd& q) const {
  Eigen::MatrixXd forces(q.size(), static_cast<Eigen::Index>(points_.size()));
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Growth growth(points_[i], q);
    forces.col(static_cast<Eigen::Index>(i)) = mu_ * points_[i].weight_m3 * growth.value * growth.gradient;
  }
  return forces;
}

}  // namespace soft_robot_lab
