// SPDX-License-Identifier: BSD-3-Clause
#include "node_turns.h"

#include <algorithm>
#include <cmath>

#include "mechanics/linear_algebra/loose_batch.h"

namespace soft_robot_lab {
namespace {

constexpr int kPolarSteps = 4;  // from stretches of a half to a rotation within 1e-9

// Plain pointers, so that every copy of the code stays self-contained.
struct ElementArrays {
  int batches;
  const int* nodes;
  const Batch *gradients, *volumes;
};

// V F_to F_from^-1 of four elements, zero where one is inverted at first.
inline void relative_motion(const BatchMatrix& from, const BatchMatrix& to, Batch volume, Batch* sum) {
  const BatchMatrix c = cofactor(from);
  const Batch j = determinant(from, c);
  const Batch scale = j > 0.0 ? volume / j : splat(0.0);
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i)
      sum[3 * k + i] = scale * (to.m[i][0] * c.m[k][0] + to.m[i][1] * c.m[k][1] + to.m[i][2] * c.m[k][2]);
}

inline void add_matrix(const double* matrix, double* sum) {
  for (int i = 0; i < 2 * kLanes; i += kLanes) store(load(sum + i) + load(matrix + i), sum + i);
  sum[8] += matrix[8];
}

template <int Nodes>
inline void add_motions(const ElementArrays& e, const double* from, const double* to, double* sums) {
  Batch x[3 * Nodes], y[3 * Nodes], motion[9];
  for (int batch = 0; batch < e.batches; ++batch) {
    const int* nodes = e.nodes + static_cast<std::ptrdiff_t>(batch) * Nodes * kLanes;
    const Batch* g = e.gradients + static_cast<std::ptrdiff_t>(batch) * Nodes * 3;
    gather(from, nodes, Nodes, x);
    gather(to, nodes, Nodes, y);
    relative_motion(deformation_gradient<Nodes>(x, g), deformation_gradient<Nodes>(y, g), e.volumes[batch], motion);
    double of_element[kLanes][9];
    for (int lane = 0; lane < kLanes; ++lane)
      for (int i = 0; i < 9; ++i) of_element[lane][i] = motion[i][lane];
    for (int a = 0; a < Nodes * kLanes; ++a) add_matrix(of_element[a % kLanes], sums + 9 * nodes[a]);
  }
}

SOFT_ROBOT_LAB_CLONES void quadratic_motions(const ElementArrays& e, const double* x, const double* y, double* sums) {
  add_motions<10>(e, x, y, sums);
}
SOFT_ROBOT_LAB_CLONES void linear_motions(const ElementArrays& e, const double* x, const double* y, double* sums) {
  add_motions<4>(e, x, y, sums);
}

// To the rotation of its polar decomposition, four at a time (Higham 1986); the identity where det <= 0.
SOFT_ROBOT_LAB_CLONES void to_rotations(int groups, double* matrices) {
  for (double* at = matrices; at < matrices + 9 * kLanes * static_cast<std::ptrdiff_t>(groups); at += 9 * kLanes) {
    BatchMatrix r;
    for (int i = 0; i < 9; ++i)
      for (int lane = 0; lane < kLanes; ++lane) r.m[i % 3][i / 3][lane] = at[9 * lane + i];
    const Batch first = determinant(r, cofactor(r));
    const auto usable = first > 0.0;
    Batch size = splat(1.0);
    for (int lane = 0; lane < kLanes; ++lane)
      if (first[lane] > 0.0) size[lane] = 1.0 / std::cbrt(first[lane]);
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) r.m[i][k] = usable ? size * r.m[i][k] : splat(i == k ? 1.0 : 0.0);
    for (int step = 0; step < kPolarSteps; ++step) {
      const BatchMatrix c = cofactor(r);
      const Batch half = 0.5 / determinant(r, c);
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) r.m[i][k] = 0.5 * r.m[i][k] + half * c.m[i][k];
    }
    for (int i = 0; i < 9; ++i)
      for (int lane = 0; lane < kLanes; ++lane) at[9 * lane + i] = r.m[i % 3][i / 3][lane];
  }
}

}  // namespace

Eigen::Matrix3Xd turned(const Turns& turns, const Eigen::Matrix3Xd& vectors) {
  if (turns.cols() == 0) return vectors;
  Eigen::Matrix3Xd result(3, vectors.cols());
  for (Eigen::Index node = 0; node < vectors.cols(); ++node)
    result.col(node).noalias() = turns.middleCols<3>(3 * node) * vectors.col(node);
  return result;
}

Eigen::Matrix3Xd turned_back(const Turns& turns, const Eigen::Matrix3Xd& vectors) {
  if (turns.cols() == 0) return vectors;
  Eigen::Matrix3Xd result(3, vectors.cols());
  for (Eigen::Index node = 0; node < vectors.cols(); ++node)
    result.col(node).noalias() = turns.middleCols<3>(3 * node).transpose() * vectors.col(node);
  return result;
}

NodeTurns::NodeTurns(const Body& body, const ElementBatches& batches)
    : body_(body),
      batches_(batches),
      gradients_(static_cast<std::size_t>(batches.count() * batches.node_count) * 3, splat(0.0)),
      volumes_(static_cast<std::size_t>(batches.count()), splat(0.0)) {
  const std::size_t entries = static_cast<std::size_t>(batches.node_count) * 3;
  for (std::size_t batch = 0; batch < volumes_.size(); ++batch) {
    for (int q = 0; q < batches.point_count; ++q) {
      const std::size_t point = batch * batches.point_count + static_cast<std::size_t>(q);
      volumes_[batch] += batches.weights[point];
      for (std::size_t i = 0; i < entries; ++i)
        gradients_[batch * entries + i] += batches.weights[point] * batches.gradients[point * entries + i];
    }
    for (std::size_t i = 0; i < entries; ++i)
      gradients_[batch * entries + i] /= volumes_[batch] > 0.0 ? volumes_[batch] : splat(1.0);
  }
}

Turns NodeTurns::between(const Eigen::Matrix3Xd& from_m, const Eigen::Matrix3Xd& to_m) const {
  const ElementArrays arrays{batches_.count(), batches_.nodes.data(), gradients_.data(), volumes_.data()};
  const Eigen::Index count = from_m.cols();
  const Eigen::Index groups = (count + kLanes - 1) / kLanes;
  Turns turns = Turns::Zero(3, 3 * kLanes * groups);
  const auto add = batches_.node_count == 10 ? quadratic_motions : linear_motions;
  add(arrays, from_m.data(), to_m.data(), turns.data());
  for (Eigen::Index node = 0; node < count; ++node)
    if (body_.fixed().col(node).any()) turns.middleCols<3>(3 * node).setZero();
  to_rotations(static_cast<int>(groups), turns.data());
  return turns;
}

}  // namespace soft_robot_lab
