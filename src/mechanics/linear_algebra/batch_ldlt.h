// SPDX-License-Identifier: BSD-3-Clause
// Four small dense symmetric systems at once, one per lane: A = L D L^T without pivoting, lower triangle by columns.
#pragma once

#include "mechanics/elements/batches.h"

namespace soft_robot_lab {

// Where column j of an N x N lower triangle starts, less j: row i >= j is at column_start(N, j) + i.
constexpr int column_start(int n, int j) { return j * (2 * n - j - 1) / 2; }
constexpr int triangle_size(int n) { return n * (n + 1) / 2; }

// Replaces A by L and 1/D; returns the smallest pivot of each lane, without which the factor is of no use where <= 0.
template <int N>
inline Batch factorise_ldlt(Batch* a) {
  Batch smallest = splat(1e300);
  for (int k = 0; k < N; ++k) {
    Batch* column = a + column_start(N, k);
    smallest = column[k] < smallest ? column[k] : smallest;
    const Batch inverse = 1.0 / column[k];
    for (int j = k + 1; j < N; ++j) {
      const Batch factor = column[j] * inverse;
      Batch* target = a + column_start(N, j);
      for (int i = j; i < N; ++i) target[i] -= column[i] * factor;
    }
    column[k] = inverse;
    for (int i = k + 1; i < N; ++i) column[i] *= inverse;
  }
  return smallest;
}

template <int N>
inline void solve_ldlt(const Batch* a, Batch* b) {
  for (int k = 0; k < N; ++k)
    for (int i = k + 1; i < N; ++i) b[i] -= a[column_start(N, k) + i] * b[k];
  for (int k = N - 1; k >= 0; --k) {
    const Batch* column = a + column_start(N, k);
    Batch sum = b[k] * column[k];
    for (int i = k + 1; i < N; ++i) sum -= column[i] * b[i];
    b[k] = sum;
  }
}

}  // namespace soft_robot_lab
