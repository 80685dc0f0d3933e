// SPDX-License-Identifier: BSD-3-Clause
#include "co_rotated_step.h"

#include <cmath>

namespace soft_robot_lab {
namespace {

constexpr double kShift = 1e-11;  // of the diagonal, for an axis that nothing is held along

// exp([w]x), by Rodrigues.
inline BatchMatrix rotation(const Batch* w) {
  const Batch squared = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
  Batch along, across;  // sin t / t, (1 - cos t) / t^2
  for (int lane = 0; lane < kLanes; ++lane) {
    const double angle = std::sqrt(squared[lane]);
    const double half = angle > 0.0 ? std::sin(0.5 * angle) / angle : 0.5;
    along[lane] = angle > 0.0 ? std::sin(angle) / angle : 1.0;
    across[lane] = 2.0 * half * half;
  }
  BatchMatrix r;
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3, last = (i + 2) % 3;
    r.m[i][i] = 1.0 - across * (squared - w[i] * w[i]);
    r.m[i][next] = across * w[i] * w[next] - along * w[last];
    r.m[i][last] = across * w[i] * w[last] + along * w[next];
  }
  return r;
}

inline BatchMatrix times(const BatchMatrix& a, const BatchMatrix& b) {
  BatchMatrix c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) c.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j];
  return c;
}

// T F - (F + D), zero where F or I + e is inverted.
inline BatchMatrix what_turning_adds(const BatchMatrix& f, const BatchMatrix& d) {
  const BatchMatrix cofactors = cofactor(f);
  const Batch j = determinant(f, cofactors);
  BatchMatrix g;  // D F^-1
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      g.m[i][k] = (d.m[i][0] * cofactors.m[k][0] + d.m[i][1] * cofactors.m[k][1] + d.m[i][2] * cofactors.m[k][2]) / j;
  const Batch w[3] = {0.5 * (g.m[2][1] - g.m[1][2]), 0.5 * (g.m[0][2] - g.m[2][0]), 0.5 * (g.m[1][0] - g.m[0][1])};
  BatchMatrix stretch;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) stretch.m[i][k] = 0.5 * (g.m[i][k] + g.m[k][i]) + (i == k ? 1.0 : 0.0);
  const Batch volume = determinant(stretch, cofactor(stretch)), meant = 1.0 + g.m[0][0] + g.m[1][1] + g.m[2][2];
  const auto usable = (j > 0.0) & (volume > 0.0) & (meant > 0.0);
  Batch scale = splat(1.0);
  for (int lane = 0; lane < kLanes; ++lane)
    if (usable[lane]) scale[lane] = std::cbrt(meant[lane] / volume[lane]);
  BatchMatrix turned = times(rotation(w), times(stretch, f));
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      const Batch added = scale * turned.m[i][k] - f.m[i][k] - d.m[i][k];
      turned.m[i][k] = usable ? added : splat(0.0);
    }
  return turned;
}

// Plain pointers, so that every copy of the code stays self-contained.
struct ElementArrays {
  int batches;
  const int* nodes;
  const Batch *gradients, *weights, *mu_ratio;
};

template <int Nodes, int Points>
inline void all_additions(const ElementArrays& e, const double* positions, const double* step, double* sums) {
  Batch x[3 * Nodes], d[3 * Nodes], sum[3 * Nodes];
  for (int batch = 0; batch < e.batches; ++batch) {
    const int* nodes = e.nodes + static_cast<std::ptrdiff_t>(batch) * Nodes * kLanes;
    gather(positions, nodes, Nodes, x);
    gather(step, nodes, Nodes, d);
    for (Batch& value : sum) value = splat(0.0);
    for (int q = 0; q < Points; ++q) {
      const std::ptrdiff_t point = static_cast<std::ptrdiff_t>(batch) * Points + q;
      const Batch* g = e.gradients + point * Nodes * 3;
      BatchMatrix added = what_turning_adds(deformation_gradient<Nodes>(x, g), deformation_gradient<Nodes>(d, g));
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) added.m[i][k] *= e.weights[point] * e.mu_ratio[batch];
      for (int a = 0; a < Nodes; ++a) {
        const BatchVector fraction = multiply(added, g + 3 * a);
        for (int i = 0; i < 3; ++i) sum[3 * a + i] += fraction.v[i];
      }
    }
    scatter_add(sum, nodes, Nodes, sums);
  }
}

SOFT_ROBOT_LAB_CLONES void quadratic_additions(const ElementArrays& e, const double* x, const double* d, double* sums) {
  all_additions<10, 4>(e, x, d, sums);
}
SOFT_ROBOT_LAB_CLONES void linear_additions(const ElementArrays& e, const double* x, const double* d, double* sums) {
  all_additions<4, 1>(e, x, d, sums);
}

}  // namespace

CoRotatedStep::CoRotatedStep(const Body& body, const ElementBatches& batches, const BlockPattern& matrix)
    : batches_(batches), mu_pa_(body.material().lame_mu_pa()) {
  for (int axis = 0; axis < 3; ++axis) {
    const bool as_before = axis > 0 && body.fixed().row(axis) == body.fixed().row(axis - 1);
    axes_[axis] = as_before ? axes_[axis - 1] : poisson(body.fixed().row(axis), matrix);
  }
}

std::shared_ptr<const CoRotatedStep::Poisson> CoRotatedStep::poisson(const Eigen::Matrix<bool, 1, Eigen::Dynamic>& held,
                                                                     const BlockPattern& matrix) const {
  auto result = std::make_shared<Poisson>();
  std::vector<int> place(held.size(), -1);
  for (int position = 0; position < matrix.node_count(); ++position) {
    const int node = matrix.node(position);
    if (node >= held.size() || held[node]) continue;
    place[node] = static_cast<int>(result->free.size());
    result->free.push_back(node);
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (int batch = 0; batch < batches_.count(); ++batch) {
    const int* nodes = batches_.nodes.data() + static_cast<std::ptrdiff_t>(batch) * batches_.node_count * kLanes;
    const Batch* pairs = batches_.laplacian.data() + static_cast<std::ptrdiff_t>(batch) * batches_.pair_count();
    for (int a = 0; a < batches_.node_count; ++a)
      for (int b = 0; b <= a; ++b, ++pairs)
        for (int lane = 0; lane < kLanes; ++lane) {
          const int row = place[nodes[a * kLanes + lane]], column = place[nodes[b * kLanes + lane]];
          if (row < 0 || column < 0) continue;
          entries.emplace_back(std::max(row, column), std::min(row, column),
                               (*pairs)[lane] * (row == column ? 1.0 + kShift : 1.0));
        }
  }
  const auto size = static_cast<Eigen::Index>(result->free.size());
  Eigen::SparseMatrix<double> lower(size, size);
  lower.setFromTriplets(entries.begin(), entries.end());
  result->laplacian.compute(lower);
  return result;
}

Eigen::Matrix3Xd CoRotatedStep::follow(const Eigen::Matrix3Xd& positions_m, const Eigen::Matrix3Xd& step_m) const {
  const ElementArrays arrays{batches_.count(), batches_.nodes.data(), batches_.gradients.data(),
                             batches_.weights.data(), batches_.mu_ratio.data()};
  Eigen::Matrix3Xd added = Eigen::Matrix3Xd::Zero(3, positions_m.cols());
  const auto sum = batches_.node_count == 10 ? quadratic_additions : linear_additions;
  sum(arrays, positions_m.data(), step_m.data(), added.data());
  Eigen::Matrix3Xd there = positions_m + step_m;
  for (int axis = 0; axis < 3; ++axis) {
    const Poisson& poisson = *axes_[axis];
    there(axis, poisson.free) +=
        mu_pa_ * poisson.laplacian.solve(Eigen::VectorXd(added(axis, poisson.free).transpose())).transpose();
  }
  return there;
}

}  // namespace soft_robot_lab
