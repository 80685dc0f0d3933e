// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_energy.h"

#include "mechanics/material/material_law.h"

namespace soft_robot_lab {
namespace {

// Of each element.
template <class Number>
Eigen::VectorXd of_elements(const Body& body, const Number& number) {
  Eigen::VectorXd all(body.mesh().tet_count());
  for (int e = 0; e < all.size(); ++e) all[e] = number(body.material_of(e));
  return all;
}

Eigen::VectorXd shear_moduli_pa(const Body& body) {
  return of_elements(body, [](const Material& material) { return material.lame_mu_pa(); });
}

Eigen::MatrixXd with_column(const Eigen::MatrixXd& columns, const Eigen::VectorXd& last) {
  Eigen::MatrixXd all(columns.rows(), columns.cols() + 1);
  all << columns, last;
  return all;
}

}  // namespace

ReducedEnergy::ReducedEnergy(const Body& body, const ReducedBasis& basis)
    : points_(rest_points(body.mesh(), basis.modes)),
      point_sums_(points_, body),
      volumes_(points_, with_column(basis.pressures, shear_moduli_pa(body))),
      stretch_(Eigen::MatrixXd::Zero(basis.modes.cols(), basis.modes.cols())),
      linear_(Eigen::VectorXd::Zero(basis.modes.cols())) {
  const Eigen::VectorXd mu_pa = shear_moduli_pa(body);
  Eigen::VectorXd bulk_m3_pa = Eigen::VectorXd::Zero(mu_pa.size());  // V / lambda
  for (const RestPoint& point : points_) {
    const double weight_j = mu_pa[point.element] * point.weight_m3;
    stretch_ += weight_j * point.gradient.transpose() * point.gradient;
    linear_ += weight_j * traces(point.gradient);
    bulk_m3_pa[point.element] += point.weight_m3 / bulk_lambda_pa(body.material_of(point.element));
  }
  bulk_compliance_ = basis.pressures.transpose() * bulk_m3_pa.asDiagonal() * basis.pressures;
  const Eigen::Matrix3Xd forces = body.external_forces_n();
  loads_ = basis.modes.transpose() * Eigen::Map<const Eigen::VectorXd>(forces.data(), forces.size());
}

void ReducedEnergy::hyper_reduce(const Eigen::VectorXd& factors, const Body& body) {
  std::vector<RestPoint> kept;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const double factor = factors[static_cast<Eigen::Index>(i)];
    if (factor > 0.0) kept.push_back({points_[i].element, factor * points_[i].weight_m3, points_[i].gradient});
  }
  points_ = std::move(kept);
  point_sums_ = PointSums(points_, body);
}

Eigen::VectorXd ReducedEnergy::scales(const Eigen::VectorXd& r) const {
  Eigen::VectorXd all(r.size() + 1);
  all << r, -1.0;
  return all;
}

ReducedEnergy::Sums ReducedEnergy::sums(const Eigen::VectorXd& q, const Eigen::VectorXd& r) const {
  const Eigen::VectorXd of_volumes = scales(r), stretched = stretch_ * q;
  const VolumePolynomials::Values volumes = volumes_.at(q, of_volumes);
  Sums result;
  result.force = stretched + linear_ + volumes.gradient - loads_;
  const Eigen::VectorXd squeezed = bulk_compliance_ * r;
  result.value =
      linear_.dot(q) + 0.5 * q.dot(stretched) + volumes.values.dot(of_volumes) - 0.5 * r.dot(squeezed) - loads_.dot(q);
  result.value += point_sums_.add_force(q, result.force);
  result.mismatch = volumes.values.head(r.size()) - squeezed;
  return result;
}

Eigen::MatrixXd ReducedEnergy::hessian(const Eigen::VectorXd& q, const Eigen::VectorXd& r) const {
  Eigen::MatrixXd result = stretch_ + volumes_.hessian(q, scales(r));
  point_sums_.add_hessian(q, result);
  return result;
}

Eigen::MatrixXd ReducedEnergy::volume_gradients(const Eigen::VectorXd& q) const {
  return volumes_.gradients(q).leftCols(pressures());
}

}  // namespace soft_robot_lab
