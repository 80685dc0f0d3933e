// SPDX-License-Identifier: BSD-3-Clause
#include "free_border.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace soft_robot_lab {
namespace {

constexpr double kNothing = 1e-6;  // of E * size: a stiffness that counts as none
constexpr double kLittle = 1e-3;   // of E * size: what stands for it where there is no weight
constexpr double kStill = 1e-6;    // of a free obstacle's size: a way in a step whose inertia counts as none

Eigen::Map<const Eigen::VectorXd> as_column(const FreeColumns& columns) { return {columns.data(), columns.size()}; }

// N/m; turns count by the way of the surface. A step moves no obstacle more softly.
double least_inertia_n_m(const FreeObstacles& free, const FreeInertia& inertia) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < free.count(); ++i) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(inertia.kg_m2[static_cast<std::size_t>(i)],
                                                              Eigen::EigenvaluesOnly);
    const double of_turns_kg = axes.eigenvalues()[0] / (free.size_m(i) * free.size_m(i));
    least = std::min(least, inertia.per_s2 * std::min(free.mass_kg(i), of_turns_kg));
  }
  return least;
}

}  // namespace

double add_free_gradient(const FreeObstacles& free, const FreePoses& at, const FreeInertia* inertia,
                         FreeColumns& gradient) {
  double energy_j = 0.0;
  const FreePoses start = free.at_start();
  for (int i = 0; i < free.count(); ++i) {
    const Eigen::Vector3d weight_n = free.mass_kg(i) * free.gravity_m_s2();
    energy_j -= weight_n.dot(at.centers_m.col(i) - start.centers_m.col(i));
    gradient.col(2 * i) -= weight_n;
    if (!inertia) continue;
    const Eigen::Vector3d lag_m = at.centers_m.col(i) - inertia->predicted_m.col(i);
    const Eigen::Vector3d lag_rad =
        turned_rad(inertia->start.turns.col(i), at.turns.col(i)) - inertia->predicted_rad.col(i);
    const Eigen::Vector3d force_n = inertia->per_s2 * free.mass_kg(i) * lag_m;
    const Eigen::Vector3d torque_nm = inertia->per_s2 * inertia->kg_m2[static_cast<std::size_t>(i)] * lag_rad;
    energy_j += 0.5 * (force_n.dot(lag_m) + torque_nm.dot(lag_rad));
    gradient.col(2 * i) += force_n;
    gradient.col(2 * i + 1) += torque_nm;
  }
  return energy_j;
}

void add_free_inertia(const FreeObstacles& free, const FreeInertia& inertia, Eigen::MatrixXd& own) {
  for (int i = 0; i < free.count(); ++i) {
    own.block<3, 3>(6 * i, 6 * i).diagonal().array() += inertia.per_s2 * free.mass_kg(i);
    own.block<3, 3>(6 * i + 3, 6 * i + 3) += inertia.per_s2 * inertia.kg_m2[static_cast<std::size_t>(i)];
  }
}

double free_norm_n(const FreeObstacles& free, int one, const FreeColumns& forces) {
  return std::hypot(forces.col(2 * one).norm(), forces.col(2 * one + 1).norm() / free.size_m(one));
}

double free_norm_n(const FreeObstacles& free, const FreeColumns& forces) {
  double squares = 0.0;
  for (int i = 0; i < free.count(); ++i) squares += std::pow(free_norm_n(free, i, forces), 2);
  return std::sqrt(squares);
}

double free_imbalance(const FreeObstacles& free, const FreeColumns& contact_n, const FreeColumns& residual_n,
                      const FreeInertia* inertia) {
  double largest = 0.0;
  for (int i = 0; i < free.count(); ++i) {
    const double left_n = free_norm_n(free, i, residual_n);
    double scale_n = free_norm_n(free, i, contact_n) + free.mass_kg(i) * free.gravity_m_s2().norm();
    if (inertia) scale_n = std::max(scale_n, kStill * inertia->per_s2 * free.mass_kg(i) * free.size_m(i));
    if (left_n > 0.0) largest = std::max(largest, left_n / std::max(scale_n, left_n));
  }
  return largest;
}

FreeBorder::FreeBorder(Eigen::MatrixXd border, Eigen::MatrixXd solved, Eigen::MatrixXd own, const FreeObstacles& free,
                       double youngs_modulus_pa, const FreeInertia* inertia)
    : border_(std::move(border)), solved_(std::move(solved)) {
  // Turns count by the way of the surface, so that all is N/m.
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(own.cols());
  double nothing = 0.0, little = 0.0;
  for (int i = 0; i < free.count(); ++i) {
    scale.segment<3>(6 * i + 3).setConstant(1.0 / free.size_m(i));
    const double stiffness_n_m = youngs_modulus_pa * free.size_m(i);
    nothing = std::max(nothing, kNothing * stiffness_n_m);
    little = std::max(
        {little, kLittle * stiffness_n_m, 2.0 * free.mass_kg(i) * free.gravity_m_s2().norm() / free.size_m(i)});
  }
  own -= border_.transpose() * solved_;
  const Eigen::MatrixXd scaled = scale.asDiagonal() * (0.5 * (own + own.transpose())) * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  stable_ = eigen.eigenvalues()[0] > -nothing;
  if (inertia) nothing = std::min(nothing, 0.5 * least_inertia_n_m(free, *inertia));
  const Eigen::VectorXd values = eigen.eigenvalues().unaryExpr(
      [&](double value) { return 1.0 / (value > nothing ? value : std::max(-value, little)); });
  inverse_ = scale.asDiagonal() * eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose() *
             scale.asDiagonal();
}

FreeColumns FreeBorder::motion(const FreeColumns& free_load, const Eigen::VectorXd& nodal_load) const {
  if (empty()) return FreeColumns::Zero(3, free_load.cols());
  const Eigen::VectorXd all = motions(as_column(free_load), nodal_load);
  return Eigen::Map<const FreeColumns>(all.data(), 3, free_load.cols());
}

Eigen::MatrixXd FreeBorder::motions(const Eigen::MatrixXd& free_loads, const Eigen::MatrixXd& nodal_loads) const {
  return inverse_ * (free_loads - solved_.transpose() * nodal_loads);
}

void FreeBorder::complete(const Eigen::MatrixXd& nodal_loads, Eigen::MatrixXd& of_nodes) const {
  if (empty()) return;
  of_nodes -= solved_ * motions(Eigen::MatrixXd::Zero(inverse_.rows(), nodal_loads.cols()), nodal_loads);
}

Eigen::MatrixXd FreeBorder::nodal_motions(const Eigen::MatrixXd& free_loads) const {
  return -solved_ * (inverse_ * free_loads);
}

}  // namespace soft_robot_lab
