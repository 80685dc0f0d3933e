// SPDX-License-Identifier: BSD-3-Clause
#include "point_sums.h"

#include <utility>

#include "mechanics/linear_algebra/batches.h"

namespace soft_robot_lab {
namespace {

using Index = Eigen::Index;

struct Flat {
  Batch m[9];
};

inline Flat deformation(const Batch* d, const double* q, Index modes) {
  Flat f{};
  f.m[0] = f.m[4] = f.m[8] = splat(1.0);
  for (Index i = 0; i < modes; ++i)
    for (int c = 0; c < 9; ++c) f.m[c] += splat(q[i]) * d[9 * i + c];
  return f;
}

inline Flat cross(const Flat& a, const Flat& b) {
  Flat r;
  for (int c = 0; c < 3; ++c) {
    const Batch *const au = a.m + 3 * ((c + 1) % 3), *const av = a.m + 3 * ((c + 2) % 3);
    const Batch *const bu = b.m + 3 * ((c + 1) % 3), *const bv = b.m + 3 * ((c + 2) % 3);
    for (int k = 0; k < 3; ++k) {
      const int x = (k + 1) % 3, y = (k + 2) % 3;
      r.m[3 * c + k] = au[x] * bv[y] - au[y] * bv[x] + bu[x] * av[y] - bu[y] * av[x];
    }
  }
  return r;
}

inline Batch dot(const Flat& a, const Batch* b) {
  Batch sum = a.m[0] * b[0];
  for (int c = 1; c < 9; ++c) sum += a.m[c] * b[c];
  return sum;
}

inline Flat cofactors(const Flat& f) {
  Flat r = cross(f, f);
  for (Batch& entry : r.m) entry *= splat(0.5);
  return r;
}

inline Batch growth(const Flat& f, const Flat& cofactor) {
  return f.m[0] * cofactor.m[0] + f.m[1] * cofactor.m[1] + f.m[2] * cofactor.m[2] - splat(1.0);
}

inline double total(const Batch& b) { return (b[0] + b[1]) + (b[2] + b[3]); }

inline Flat scaled(const Flat& a, const Batch& scale) {
  Flat r;
  for (int c = 0; c < 9; ++c) r.m[c] = scale * a.m[c];
  return r;
}

SOFT_ROBOT_LAB_CLONES double group_force(const Batch* d, const Batch* weight, const double* q, Index modes,
                                         Batch* force) {
  const Flat f = deformation(d, q, modes), cofactor = cofactors(f);
  const Batch grown = growth(f, cofactor), pull = *weight * grown;
  const Flat stress = scaled(cofactor, pull);
  for (Index i = 0; i < modes; ++i) force[i] += dot(stress, d + 9 * i);
  return 0.5 * total(pull * grown);
}

// Its lower triangle, lanes apart: w (g g' + (J - 1) D' (F x D)).
SOFT_ROBOT_LAB_CLONES void group_hessian(const Batch* d, const Batch* weight, const double* q, Index modes,
                                         Batch* triangle) {
  const Flat f = deformation(d, q, modes), cofactor = cofactors(f);
  const Batch pull = *weight * growth(f, cofactor);
  for (Index i = 0; i < modes; ++i) {
    Flat of;
    for (int c = 0; c < 9; ++c) of.m[c] = d[9 * i + c];
    const Flat turned = cross(f, of);
    const Batch along = *weight * dot(cofactor, of.m);
    Flat column;
    for (int c = 0; c < 9; ++c) column.m[c] = along * cofactor.m[c] + pull * turned.m[c];
    for (Index j = 0; j <= i; ++j) *triangle++ += dot(column, d + 9 * j);
  }
}

}  // namespace

struct PointSums::Groups {
  Batches gradients;  // per group and mode: 9, a matrix column after column
  Batches weights;    // per group, zero where a lane is empty
};

PointSums::PointSums(const std::vector<RestPoint>& points)
    : modes_(points.empty() ? 0 : points.front().gradient.cols()) {
  const std::size_t count = (points.size() + kLanes - 1) / kLanes, entries = 9 * static_cast<std::size_t>(modes_);
  Groups groups{Batches(count * entries, Batch{}), Batches(count, Batch{})};
  for (std::size_t p = 0; p < points.size(); ++p) {
    const std::size_t group = p / kLanes, lane = p % kLanes;
    groups.weights[group][lane] = points[p].weight_m3;
    for (std::size_t i = 0; i < entries; ++i)
      groups.gradients[group * entries + i][lane] = points[p].gradient.data()[i];
  }
  groups_ = std::make_shared<const Groups>(std::move(groups));
}

double PointSums::add_force(const Eigen::VectorXd& q, double scale, Eigen::VectorXd& force) const {
  Batches sums(static_cast<std::size_t>(modes_), Batch{});
  const Batch* d = groups_->gradients.data();
  double value = 0.0;
  for (const Batch& weight : groups_->weights) {
    value += group_force(d, &weight, q.data(), modes_, sums.data());
    d += 9 * modes_;
  }
  for (Index i = 0; i < modes_; ++i) force[i] += scale * total(sums[static_cast<std::size_t>(i)]);
  return scale * value;
}

void PointSums::add_hessian(const Eigen::VectorXd& q, double scale, Eigen::MatrixXd& hessian) const {
  const auto modes = static_cast<std::size_t>(modes_);
  Batches triangle(modes * (modes + 1) / 2, Batch{});
  const Batch* d = groups_->gradients.data();
  for (const Batch& weight : groups_->weights) {
    group_hessian(d, &weight, q.data(), modes_, triangle.data());
    d += 9 * modes_;
  }
  const Batch* entry = triangle.data();
  for (Index i = 0; i < modes_; ++i)
    for (Index j = 0; j <= i; ++j, ++entry) {
      const double sum = scale * total(*entry);
      hessian(i, j) += sum;
      if (i != j) hessian(j, i) += sum;
    }
}

}  // namespace soft_robot_lab
