// SPDX-License-Identifier: BSD-3-Clause
// Whether a rest state is a minimum of the energy, and the way off one that is not.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "mechanics/solver_constants.h"
#include "newton_solver.h"

namespace soft_robot_lab {
namespace {

constexpr int kVectors = 6;  // of the subspace; more where more pivots are negative
constexpr int kMostVectors = 12;
constexpr int kIterations = 8;  // of the subspace

// Smooth motions to start from: a polynomial of the place in each, with fixed numbers between -1 and 1 as factors.
Eigen::MatrixXd smooth_motions(const Eigen::Matrix3Xd& positions_m, int count) {
  const Eigen::Vector3d center_m = positions_m.rowwise().mean();
  const double size_m = (positions_m.colwise() - center_m).colwise().norm().maxCoeff();
  Eigen::MatrixXd motions(positions_m.size(), count);
  double number = 0.5;
  for (int column = 0; column < count; ++column) {
    Eigen::Matrix<double, 3, 10> factors;
    for (double& factor : factors.reshaped())
      factor = 2.0 * (number = std::fmod(number + 0.6180339887498949, 1.0)) - 1.0;
    for (Eigen::Index node = 0; node < positions_m.cols(); ++node) {
      const Eigen::Vector3d at = (positions_m.col(node) - center_m) / size_m;
      Eigen::Matrix<double, 10, 1> terms;
      terms << 1.0, at, at.cwiseAbs2(), at.x() * at.y(), at.y() * at.z(), at.z() * at.x();
      motions.col(column).segment<3>(3 * node) = factors * terms;
    }
  }
  return motions;
}

// Columns that are orthonormal in the inner product of the masses.
void orthonormalise(const Eigen::VectorXd& masses_kg, Eigen::MatrixXd& columns) {
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    for (int twice = 0; twice < 2; ++twice)
      for (Eigen::Index j = 0; j < i; ++j)
        columns.col(i) -= columns.col(j).dot(masses_kg.cwiseProduct(columns.col(i))) * columns.col(j);
    const double norm = std::sqrt(columns.col(i).dot(masses_kg.cwiseProduct(columns.col(i))));
    if (norm > 0.0) columns.col(i) /= norm;
  }
}

SoftModes in_order_of_stiffness(const Eigen::VectorXd& stiffness_per_s2, const Eigen::MatrixXd& motions) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(stiffness_per_s2.size()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](Eigen::Index a, Eigen::Index b) { return stiffness_per_s2[a] < stiffness_per_s2[b]; });
  return {stiffness_per_s2(order), motions(Eigen::all, order)};
}

// A column for each constraint that is active, or for those that slip together: which they are.
Eigen::MatrixXd active_sums(const MultiplierProblem& problem, const Eigen::VectorXd& multipliers) {
  const int count = static_cast<int>(problem.laws.size());
  const std::vector<int> group = slipping_groups(problem, multipliers);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(count, count);
  int size = 0;
  for (int g = 0; g < count; ++g) {
    for (int i = 0; i < count; ++i)
      if (group[i] == g && active(problem.laws[i], multipliers[i])) sums(i, size) = 1.0;
    if (!sums.col(size).isZero(0.0) && ++size == count) break;
  }
  return sums.leftCols(size);
}

}  // namespace

// Whether the energy has a minimum on the active constraints, though A itself may not be positive definite: a buckled
// body is held by its cables' lengths. So it is where the Schur complement has as many negative eigenvalues as A
// (Haynsworth 1968: the inertia of the bordered matrix).
bool NewtonSolver::stable_under(const MultiplierProblem& problem, const Eigen::VectorXd& multipliers) const {
  if (system_.negative_pivots() == 0) return true;
  const Eigen::MatrixXd sums = active_sums(problem, multipliers);
  if (sums.cols() < system_.negative_pivots()) return false;
  const Eigen::MatrixXd sub = sums.transpose() * problem.delassus * sums;
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(sub, Eigen::EigenvaluesOnly).eigenvalues();
  return (eigenvalues.array() < 0.0).count() == system_.negative_pivots();
}

bool NewtonSolver::stable_at_rest(const NewtonState& state) {
  if (!system_.has_factor_at(state, 0.0, nullptr) && !system_.linearise(state, 0.0, nullptr, false)) return false;
  const bool stable = system_.negative_pivots() == 0 ||
                      (constraint_count() > 0 &&
                       stable_under(problem_at(state, system_.solve_exactly(system_.border().columns).motions_m),
                                    state.constraint_multipliers));
  return stable && system_.free_border().stable();
}

SoftModes NewtonSolver::soft_modes(const NewtonState& state) {
  if (!system_.has_factor_at(state, 0.0, nullptr) && !system_.linearise(state, 0.0, nullptr, false)) return {};
  const int vectors = std::clamp(system_.negative_pivots() + 2, kVectors, kMostVectors);
  Eigen::MatrixXd border_solved, sums;
  Eigen::PartialPivLU<Eigen::MatrixXd> schur;
  if (constraint_count() > 0) {
    border_solved = system_.solve_exactly(system_.border().columns).motions_m;
    const MultiplierProblem problem = problem_at(state, border_solved);
    sums = active_sums(problem, state.constraint_multipliers);
    if (sums.cols() > 0) schur.compute(sums.transpose() * problem.delassus * sums);
  }
  // How the body yields to loads, where it keeps to the active constraints.
  const auto yield = [&](const Eigen::MatrixXd& loads_n) {
    Eigen::MatrixXd motions = system_.solve_exactly(loads_n).motions_m;
    if (sums.cols() > 0)
      motions -=
          border_solved * sums * schur.solve(sums.transpose() * (system_.border().columns.transpose() * motions));
    return motions;
  };
  const Eigen::VectorXd masses_kg = body_.node_masses_kg().transpose().replicate<3, 1>().reshaped();
  Eigen::MatrixXd basis = smooth_motions(state.positions_m, vectors);
  basis(tables_->held, Eigen::all).setZero();
  orthonormalise(masses_kg, basis);
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Eigen::MatrixXd loads_n = masses_kg.asDiagonal() * basis;
    const Eigen::MatrixXd motions = yield(loads_n), compliance = loads_n.transpose() * motions;
    ritz.compute(0.5 * (compliance + compliance.transpose()));
    basis = motions * ritz.eigenvectors();
    orthonormalise(masses_kg, basis);
    if (!basis.allFinite()) return {};
  }
  return in_order_of_stiffness(ritz.eigenvalues().cwiseInverse(), basis);
}

bool NewtonSolver::minimum_at_rest(const NewtonState& state) {
  if (stable_at_rest(state)) return true;
  const SoftModes modes = soft_modes(state);
  const double slow_per_s2 = constants::kNeutral * body_.material().youngs_modulus_pa /
                             (body_.material().density_kg_m3 * body_.size_m() * body_.size_m());
  return modes.stiffness_per_s2.size() > 0 && modes.stiffness_per_s2[0] < 0.0 &&
         modes.stiffness_per_s2[0] > -slow_per_s2;
}

}  // namespace soft_robot_lab
