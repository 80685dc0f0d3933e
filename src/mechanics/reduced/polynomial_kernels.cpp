// SPDX-License-Identifier: BSD-3-Clause
#include "polynomial_kernels.h"

#include <algorithm>

#include "mechanics/linear_algebra/loose_batch.h"

namespace soft_robot_lab {
namespace {

using Index = Eigen::Index;

inline double dot(const double* a, const double* b, Index count) {
  LooseBatch even{}, odd{};
  Index i = 0;
  for (; i + 2 * kLanes <= count; i += 2 * kLanes) {
    even += load(a + i) * load(b + i);
    odd += load(a + i + kLanes) * load(b + i + kLanes);
  }
  double sum = sum_of_lanes(even + odd);
  for (; i < count; ++i) sum += a[i] * b[i];
  return sum;
}

inline void add(double scale, const double* __restrict a, Index count, double* __restrict sum) {
  for (Index i = 0; i < count; ++i) sum[i] += scale * a[i];
}

}  // namespace

SOFT_ROBOT_LAB_CLONES void fill_monomials(const double* q, Index modes, double* monomials) {
  std::copy(q, q + modes, monomials);
  double* const pairs = monomials + modes;
  double* place = pairs;
  for (Index i = 0; i < modes; ++i)
    for (Index j = i; j < modes; ++j) *place++ = q[i] * q[j];
  const double* const end = place;
  const double* from = pairs;
  for (Index i = 0; i < modes; from += modes - i, ++i)
    for (const double* pair = from; pair < end; ++pair) *place++ = q[i] * *pair;
}

SOFT_ROBOT_LAB_CLONES void add_polynomials(const Batch* coefficients, std::size_t row, Index count,
                                           const double* scales, Batch* sum) {
  for (std::size_t block = 0; block < row; block += kBlock)
    for (Index k = 0; k < count; ++k) {
      const Batch* const of = coefficients + row * static_cast<std::size_t>(k) + block;
      const Batch scale = splat(scales[k]);
      for (std::size_t i = 0; i < kBlock; ++i) sum[block + i] += scale * of[i];
    }
}

SOFT_ROBOT_LAB_CLONES void evaluate_polynomials(const Batch* coefficients, std::size_t row, Index count,
                                                const Batch* monomials, const double* scales, double* values,
                                                Batch* sum) {
  std::fill(values, values + count, 0.0);
  for (std::size_t block = 0; block < row; block += kBlock)
    for (Index k = 0; k < count; ++k) {
      const Batch* const of = coefficients + row * static_cast<std::size_t>(k) + block;
      const Batch scale = splat(scales[k]);
      Batch value{};
      for (std::size_t i = 0; i < kBlock; ++i) {
        value += of[i] * monomials[block + i];
        sum[block + i] += scale * of[i];
      }
      values[k] += sum_of_lanes(value);
    }
}

// sum of the cubic terms = sum_i q_i (sum over pairs p from (i, i) on: S_ip m_p) = sum_p slope_p m_p less the others.
SOFT_ROBOT_LAB_CLONES void polynomial_gradient(const CubicAt& p, double* slopes, double* gradient) {
  const Index pairs = p.modes * (p.modes + 1) / 2;
  const double* const products = p.monomials + p.modes;
  const double* triples = p.coefficients + p.modes + pairs;
  std::copy(p.coefficients, p.coefficients + p.modes, gradient);
  std::copy(p.coefficients + p.modes, p.coefficients + p.modes + pairs, slopes);
  for (Index i = 0, first = 0; i < p.modes; triples += pairs - first, first += p.modes - i, ++i) {
    gradient[i] += dot(triples, products + first, pairs - first);
    add(p.q[i], triples, pairs - first, slopes + first);
  }
  const double* slope = slopes;
  for (Index j = 0; j < p.modes; slope += p.modes - j, ++j) {
    gradient[j] += dot(slope, p.q + j, p.modes - j);
    add(p.q[j], slope, p.modes - j, gradient + j);
  }
}

SOFT_ROBOT_LAB_CLONES void add_polynomial_hessian(const CubicAt& p, const double* slopes, double* half) {
  const Index pairs = p.modes * (p.modes + 1) / 2;
  const double* triple = p.coefficients + p.modes + pairs;
  for (Index i = 0; i < p.modes; ++i) {
    double* const column = half + i * p.modes;
    for (Index j = i; j < p.modes; triple += p.modes - j, ++j) {
      column[j] += dot(triple, p.q + j, p.modes - j);
      add(p.q[j], triple, p.modes - j, column + j);
    }
    add(1.0, slopes, p.modes - i, column + i);
    slopes += p.modes - i;
  }
}

}  // namespace soft_robot_lab
