// SPDX-License-Identifier: BSD-3-Clause
// Inverses of four small dense symmetric matrices at once, one per lane, without pivoting; lower triangle by columns.
#pragma once

#include "batches.h"

namespace soft_robot_lab {

// Where column j of an N x N lower triangle starts, less j: row i >= j is at column_start(N, j) + i.
constexpr int column_start(int n, int j) { return j * (2 * n - j - 1) / 2; }
constexpr int triangle_size(int n) { return n * (n + 1) / 2; }

// Replaces A by minus its inverse, by symmetric elimination (the sweep operator: Goodnight 1979). Returns the smallest
// pivot of each lane, those of A = L D L^T, without which the result is of no use where <= 0.
template <int N>
inline Batch invert_negated(Batch* a) {
  Batch smallest = splat(1e300);
  Batch column[N];
  for (int k = 0; k < N; ++k) {
    for (int i = 0; i < N; ++i) column[i] = i < k ? a[column_start(N, i) + k] : a[column_start(N, k) + i];
    smallest = column[k] < smallest ? column[k] : smallest;
    const Batch inverse = 1.0 / column[k];
    for (int j = 0; j < N; ++j) {
      const Batch factor = column[j] * inverse;
      Batch* target = a + column_start(N, j);
      for (int i = j; i < N; ++i) target[i] -= column[i] * factor;
    }
    for (int i = 0; i < N; ++i) a[i < k ? column_start(N, i) + k : column_start(N, k) + i] = column[i] * inverse;
    a[column_start(N, k) + k] = -inverse;
  }
  return smallest;
}

}  // namespace soft_robot_lab
