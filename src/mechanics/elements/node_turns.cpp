// SPDX-License-Identifier: BSD-3-Clause
#include "node_turns.h"

#include <algorithm>
#include <cmath>

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

template <int Nodes>
inline void add_motions(const ElementArrays& e, const double* from, const double* to, double* sums) {
  Batch x[3 * Nodes], y[3 * Nodes], motion[9];
  for (int batch = 0; batch < e.batches; ++batch) {
    const int* nodes = e.nodes + static_cast<std::ptrdiff_t>(batch) * Nodes * kLanes;
    const Batch* g = e.gradients + static_cast<std::ptrdiff_t>(batch) * Nodes * 3;
    gather(from, nodes, Nodes, x);
    gather(to, nodes, Nodes, y);
    relative_motion(deformation_gradient<Nodes>(x, g), deformation_gradient<Nodes>(y, g), e.volumes[batch], motion);
    for (int a = 0; a < Nodes * kLanes; ++a)
      for (int i = 0; i < 9; ++i) sums[9 * nodes[a] + i] += motion[i][a % kLanes];
  }
}

SOFT_ROBOT_LAB_CLONES void quadratic_motions(const ElementArrays& e, const double* x, const double* y, double* sums) {
  add_motions<10>(e, x, y, sums);
}
SOFT_ROBOT_LAB_CLONES void linear_motions(const ElementArrays& e, const double* x, const double* y, double* sums) {
  add_motions<4>(e, x, y, sums);
}

// To the rotation of its polar decomposition, four at a time (Higham 1986); the identity where det <= 0.
SOFT_ROBOT_LAB_CLONES void to_rotations(int groups, Batch* matrices) {
  for (Batch* at = matrices; at < matrices + 9 * static_cast<std::ptrdiff_t>(groups); at += 9) {
    BatchMatrix r;
    for (int i = 0; i < 9; ++i) r.m[i % 3][i / 3] = at[i];
    const Batch first = determinant(r, cofactor(r));
    const auto usable = first > 0.0;
    Batch size = splat(1.0);
    for (int lane = 0; lane < kLanes; ++lane)
      if (first[lane] > 0.0) size[lane] = 1.0 / std::cbrt(first[lane]);
    for (int i = 0; i < 9; ++i) r.m[i % 3][i / 3] = usable ? size * at[i] : splat(i % 4 == 0 ? 1.0 : 0.0);
    for (int step = 0; step < kPolarSteps; ++step) {
      const BatchMatrix c = cofactor(r);
      const Batch half = 0.5 / determinant(r, c);
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) r.m[i][k] = 0.5 * r.m[i][k] + half * c.m[i][k];
    }
    for (int i = 0; i < 9; ++i) at[i] = r.m[i % 3][i / 3];
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
  Turns turns = Turns::Zero(3, 3 * count);
  const auto add = batches_.node_count == 10 ? quadratic_motions : linear_motions;
  add(arrays, from_m.data(), to_m.data(), turns.data());
  for (Eigen::Index node = 0; node < count; ++node)
    if (body_.fixed().col(node).any()) turns.middleCols<3>(3 * node).setZero();
  const auto groups = static_cast<std::size_t>((count + kLanes - 1) / kLanes);
  Batches matrices(9 * groups, splat(0.0));
  const auto group_of = [&](Eigen::Index node) { return matrices.data() + 9 * (node / kLanes); };
  for (Eigen::Index node = 0; node < count; ++node)
    for (int i = 0; i < 9; ++i) group_of(node)[i][node % kLanes] = turns.data()[9 * node + i];
  to_rotations(static_cast<int>(groups), matrices.data());
  for (Eigen::Index node = 0; node < count; ++node)
    for (int i = 0; i < 9; ++i) turns.data()[9 * node + i] = group_of(node)[i][node % kLanes];
  return turns;
}

}  // namespace soft_robot_lab
