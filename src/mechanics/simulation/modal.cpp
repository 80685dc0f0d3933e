// SPDX-License-Identifier: BSD-3-Clause
// Inverse subspace iteration with Rayleigh-Ritz projection (Bathe 1971; Bathe, Finite Element Procedures, 11.6).
#include "modal.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>

#include "mechanics/linear_algebra/block_cholesky.h"
#include "mechanics/linear_algebra/block_matrix.h"
#include "mechanics/elements/elements.h"

namespace soft_robot_lab {
namespace {

constexpr double kTolerance = 1e-9;  // of a squared frequency, between two iterations
constexpr int kMaxIterations = 200;
constexpr int kGuardVectors = 8;  // beyond the wanted ones, which converge by (omega / first omega left out)^2

// Masses over 3*node + axis; zero where held.
Eigen::VectorXd free_masses(const Body& body) {
  const Eigen::Matrix3Xd masses = Eigen::Vector3d::Ones() * body.node_masses_kg().transpose();
  const Eigen::Matrix3Xd free = body.fixed().select(0.0, masses);
  return Eigen::Map<const Eigen::VectorXd>(free.data(), free.size());
}

// Moves what no hold resists away from zero, where nothing could be factorised: small against the first vibration of a
// free body as large as this one.
double shift_per_s2(const Body& body) {
  return 1e-3 * body.material().lame_mu_pa() / body.material().density_kg_m3 / (body.size_m() * body.size_m());
}

// Factor of K + shift M, the condensed Hessian of the rest shape, where all multipliers are zero.
BlockCholesky factor_of_rest_shape(const Body& body, double shift) {
  const TetMesh& mesh = body.mesh();
  BlockMatrix matrix(mesh.node_count(), stiffness_cliques(body));
  Elements elements(body, matrix);
  elements.add_hessian(mesh.nodes_m, Eigen::VectorXd::Zero(elements.multiplier_count()), false, matrix);
  for (int node = 0; node < mesh.node_count(); ++node)
    matrix.add_to_diagonal(node, shift * body.node_masses_kg()[node]);
  matrix.hold(body.fixed());
  BlockCholesky factor(matrix);
  if (!factor.factorise(matrix))
    throw std::runtime_error("modal analysis: the rest shape's stiffness could not be factorised");
  return factor;
}

// Random, but the same everywhere: the generator is defined to the bit, the standard's distributions are not.
Eigen::MatrixXd start_vectors(const Eigen::VectorXd& masses, int count) {
  std::mt19937 random(1);
  Eigen::MatrixXd vectors(masses.size(), count);
  for (Eigen::Index i = 0; i < vectors.size(); ++i)
    vectors.data()[i] = static_cast<double>(random()) / 2147483648.0 - 1.0;
  return (masses.array() > 0.0).cast<double>().matrix().asDiagonal() * vectors;
}

}  // namespace

int most_modes(const Body& body) {
  const Eigen::Index free_count = body.fixed().size() - body.fixed().count();
  return static_cast<int>(std::min<Eigen::Index>(100, free_count));
}

ModalResult modal_analysis(const Body& body, int modes) {
  const auto start = std::chrono::steady_clock::now();
  const int most = most_modes(body);
  if (modes < 1 || modes > most)
    throw std::invalid_argument("modes: " + std::to_string(modes) + " is out of range [1, " + std::to_string(most) +
                                "]");

  const Eigen::VectorXd masses = free_masses(body);
  const int free_count = static_cast<int>((masses.array() > 0.0).count());
  const double shift = shift_per_s2(body);
  const BlockCholesky factor = factor_of_rest_shape(body, shift);
  Eigen::MatrixXd vectors = start_vectors(masses, std::min(modes + kGuardVectors, free_count));
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(modes);  // shifted: omega^2 + shift

  ModalResult result;
  while (!result.converged && result.iterations < kMaxIterations) {
    // Y = K^-1 M X (K with the shift), then the best approximations within span Y. K Y is M X, so K itself is not
    // needed.
    const Eigen::MatrixXd weighted = masses.asDiagonal() * vectors;
    Eigen::MatrixXd solved = weighted;
    factor.solve(solved);
    const Eigen::MatrixXd stiffness = solved.transpose() * weighted;
    const Eigen::MatrixXd mass = solved.transpose() * masses.asDiagonal() * solved;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ritz(stiffness, mass);
    if (ritz.info() != Eigen::Success || !ritz.eigenvalues().allFinite())
      throw std::runtime_error("modal analysis: the subspace collapsed");
    vectors = solved * ritz.eigenvectors();
    const Eigen::VectorXd found = ritz.eigenvalues().head(modes);
    result.change = ((found - squares).array().abs() / found.array()).maxCoeff();
    squares = found;
    ++result.iterations;
    result.converged = result.change <= kTolerance;
  }
  result.frequencies_hz = (squares.array() - shift).max(0.0).sqrt() / (2.0 * M_PI);
  result.shapes = vectors.leftCols(modes);
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace soft_robot_lab
