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

}  // namespace

ReducedEnergy::ReducedEnergy(const Body& body, const ReducedBasis& basis)
    : mu_(body.material().lame_mu_pa()),
      lambda_(bulk_lambda_pa(body.material())),
      points_(rest_points(body.mesh(), basis.modes)),
      point_sums_(points_),
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
  point_sums_ = PointSums(points_);
}

Eigen::VectorXd ReducedEnergy::scales(const Eigen::VectorXd& r) const {
  Eigen::VectorXd all(r.size() + 1);
  all << r, -mu_;
  return all;
}

ReducedEnergy::Sums ReducedEnergy::sums(const Eigen::VectorXd& q, const Eigen::VectorXd& r) const {
  const Eigen::VectorXd of_volumes = scales(r), stretched = stretch_ * q;
  const VolumePolynomials::Values volumes = volumes_.at(q, of_volumes);
  Sums result;
  result.force = mu_ * (stretched + linear_) + volumes.gradient - loads_;
  result.value = 0.5 * mu_ * (3.0 * rest_volume_m3_ + 2.0 * linear_.dot(q) + q.dot(stretched)) +
                 volumes.values.dot(of_volumes) - r.squaredNorm() / (2.0 * lambda_) - loads_.dot(q);
  result.value += point_sums_.add_force(q, mu_, result.force);
  result.mismatch = volumes.values.head(r.size()) - r / lambda_;
  return result;
}

Eigen::MatrixXd ReducedEnergy::hessian(const Eigen::VectorXd& q, const Eigen::VectorXd& r) const {
  Eigen::MatrixXd result = mu_ * stretch_ + volumes_.hessian(q, scales(r));
  point_sums_.add_hessian(q, mu_, result);
  return result;
}

Eigen::MatrixXd ReducedEnergy::volume_gradients(const Eigen::VectorXd& q) const {
  return volumes_.gradients(q).leftCols(pressures());
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
