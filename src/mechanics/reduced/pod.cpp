// SPDX-License-Identifier: BSD-3-Clause
#include "pod.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace soft_robot_lab {

Eigen::MatrixXd pod(const Eigen::MatrixXd& snapshots, const Eigen::VectorXd& weights, int count) {
  const Eigen::VectorXd roots = weights.cwiseSqrt();
  const Eigen::MatrixXd scaled = roots.asDiagonal() * snapshots;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled.transpose() * scaled);
  const Eigen::VectorXd& energies = eigen.eigenvalues();  // ascending
  const double least = 1e-14 * energies[energies.size() - 1];
  const Eigen::Index spanned = (energies.array() > least).count(), kept = std::min<Eigen::Index>(count, spanned);
  Eigen::MatrixXd modes = scaled * eigen.eigenvectors().rightCols(kept).rowwise().reverse();
  modes.colwise().normalize();
  // The weakest lose their right angles in the squares above.
  const Eigen::MatrixXd q = modes.householderQr().householderQ() * Eigen::MatrixXd::Identity(modes.rows(), kept);
  modes = roots.cwiseInverse().asDiagonal() * q;
  for (Eigen::Index i = 0; i < modes.rows(); ++i)
    if (snapshots.row(i).isZero(0.0)) modes.row(i).setZero();  // a held node stays where it is
  return modes;
}

}  // namespace soft_robot_lab
