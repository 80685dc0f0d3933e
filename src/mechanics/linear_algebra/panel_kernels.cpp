// SPDX-License-Identifier: BSD-3-Clause
#include "panel_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "loose_batch.h"

namespace soft_robot_lab {
namespace {

constexpr int kWidth = 4;              // columns of the panel at a time
constexpr int kDepth = 128;            // columns whose sums are taken at once
constexpr int kRows = 192;             // rows of them meanwhile
constexpr double kLeastPivot = 1e-13;  // that is negative, over the largest of the diagonal

// x -= a f, of `Width` columns of a.
template <int Width>
inline void subtract_columns(int rows, const double* a, std::ptrdiff_t ld, const double* f, double* x) {
  int i = 0;
  for (; i + kLanes <= rows; i += kLanes) {
    LooseBatch sum = load(x + i);
    for (int c = 0; c < Width; ++c) sum -= load(a + c * ld + i) * f[c];
    store(sum, x + i);
  }
  for (; i < rows; ++i)
    for (int c = 0; c < Width; ++c) x[i] -= a[c * ld + i] * f[c];
}

// f -= a' x
template <int Width>
inline void subtract_products(int rows, const double* a, std::ptrdiff_t ld, const double* x, double* f) {
  LooseBatch even[Width] = {}, odd[Width] = {};
  int i = 0;
  for (; i + 2 * kLanes <= rows; i += 2 * kLanes)
    for (int c = 0; c < Width; ++c) {
      even[c] += load(a + c * ld + i) * load(x + i);
      odd[c] += load(a + c * ld + i + kLanes) * load(x + i + kLanes);
    }
  for (int c = 0; c < Width; ++c) f[c] -= sum_of_lanes(even[c] + odd[c]);
  for (; i < rows; ++i)
    for (int c = 0; c < Width; ++c) f[c] -= a[c * ld + i] * x[i];
}

template <int Width>
inline void solve_columns(int rows, const double* a, std::ptrdiff_t ld, double* x) {
  for (int c = 0; c < Width; ++c) {
    x[c] /= a[c * ld + c];
    for (int i = c + 1; i < Width; ++i) x[i] -= a[c * ld + i] * x[c];
  }
  subtract_columns<Width>(rows - Width, a + Width, ld, x, x + Width);
}

template <int Width>
inline void solve_columns_transposed(int rows, const double* a, std::ptrdiff_t ld, double* x) {
  subtract_products<Width>(rows - Width, a + Width, ld, x + Width, x);
  for (int c = Width - 1; c >= 0; --c) {
    for (int i = c + 1; i < Width; ++i) x[c] -= a[c * ld + i] * x[i];
    x[c] /= a[c * ld + c];
  }
}

// tile -= A b' over `depth` columns of A; b by rows of `Width`.
template <int Rows, int Width>
inline void subtract_products(int depth, const double* a, std::ptrdiff_t ld_a, const double* b,
                              LooseBatch (&tile)[Width][Rows]) {
  for (int p = 0; p < depth; ++p, a += ld_a, b += Width) {
    LooseBatch column[Rows];
    for (int r = 0; r < Rows; ++r) column[r] = load(a + r * kLanes);
    for (int c = 0; c < Width; ++c)
      for (int r = 0; r < Rows; ++r) tile[c][r] -= column[r] * b[c];
  }
}

template <int Rows, int Width>
inline void subtract_tile(int depth, const double* a, std::ptrdiff_t ld_a, const double* b, double* c,
                          std::ptrdiff_t ld_c) {
  LooseBatch tile[Width][Rows];
  for (int j = 0; j < Width; ++j)
    for (int r = 0; r < Rows; ++r) tile[j][r] = load(c + j * ld_c + r * kLanes);
  subtract_products<Rows, Width>(depth, a, ld_a, b, tile);
  for (int j = 0; j < Width; ++j)
    for (int r = 0; r < Rows; ++r) store(tile[j][r], c + j * ld_c + r * kLanes);
}

// C -= A b' for the rows below the corner.
template <int Width>
inline void subtract_below(int rows, int depth, const double* a, std::ptrdiff_t ld_a, const double* b, double* c,
                           std::ptrdiff_t ld_c) {
  constexpr int kTile = 3;  // batches: with Width and one factor they fill the registers
  int i = 0;
  for (; i + kTile * kLanes <= rows; i += kTile * kLanes)
    subtract_tile<kTile, Width>(depth, a + i, ld_a, b, c + i, ld_c);
  for (; i + kLanes <= rows; i += kLanes) subtract_tile<1, Width>(depth, a + i, ld_a, b, c + i, ld_c);
  for (; i < rows; ++i)
    for (int j = 0; j < Width; ++j) {
      double sum = 0.0;
      for (int p = 0; p < depth; ++p) sum += a[p * ld_a + i] * b[p * Width + j];
      c[j * ld_c + i] -= sum;
    }
}

// The lower triangle of the first `Width` rows.
template <int Width>
inline void subtract_corner(int depth, const double* a, std::ptrdiff_t ld_a, const double* b, double* c,
                            std::ptrdiff_t ld_c) {
  for (int p = 0; p < depth; ++p)
    for (int j = 0; j < Width; ++j)
      for (int i = j; i < Width; ++i) c[j * ld_c + i] -= a[p * ld_a + i] * b[p * Width + j];
}
template <>
inline void subtract_corner<kLanes>(int depth, const double* a, std::ptrdiff_t ld_a, const double* b, double* c,
                                    std::ptrdiff_t ld_c) {
  LooseBatch tile[kLanes][1] = {};
  subtract_products<1, kLanes>(depth, a, ld_a, b, tile);
  for (int j = 0; j < kLanes; ++j)
    for (int i = j; i < kLanes; ++i) c[j * ld_c + i] += tile[j][0][i];
}

// Rows [first, end) of the first `Width` columns of C -= A S A', in the lower triangle; A has `depth` <= kDepth
// columns.
template <int Width>
inline void subtract_columns_of_square(int first, int end, int depth, const double* a, std::ptrdiff_t ld_a,
                                       const double* signs, double* c, std::ptrdiff_t ld_c) {
  double b[kDepth * Width];
  for (int p = 0; p < depth; ++p)
    for (int j = 0; j < Width; ++j) b[p * Width + j] = signs[p] * a[p * ld_a + j];
  if (first < Width) subtract_corner<Width>(depth, a, ld_a, b, c, ld_c);
  first = std::max(first, Width);
  subtract_below<Width>(end - first, depth, a + first, ld_a, b, c + first, ld_c);
}

// The first columns of C -= A S A', in the lower triangle, for some rows at a time that stay in the cache.
inline void subtract_from_columns(int n, int columns, int depth, const double* a, std::ptrdiff_t ld_a,
                                  const double* signs, double* c, std::ptrdiff_t ld_c) {
  for (int first = 0; first < n; first += kRows) {
    const int end = std::min(n, first + kRows), last = std::min(columns, end);
    int j = 0;
    for (; j + kWidth <= last; j += kWidth)
      subtract_columns_of_square<kWidth>(std::max(first - j, 0), end - j, depth, a + j, ld_a, signs, c + j * (ld_c + 1),
                                         ld_c);
    for (; j < last; ++j)
      subtract_columns_of_square<1>(std::max(first - j, 0), end - j, depth, a + j, ld_a, signs, c + j * (ld_c + 1),
                                    ld_c);
  }
}

// The pivots of `Width` columns, and all that stands below them; `least`: of a negative pivot.
template <int Width>
inline bool factorise_columns(int rows, double* a, std::ptrdiff_t ld, double least, double* signs) {
  double inverse[Width];
  for (int c = 0; c < Width; ++c) {
    for (int d = 0; d < c; ++d)
      for (int i = c; i < Width; ++i) a[c * ld + i] -= signs[d] * a[d * ld + c] * a[d * ld + i];
    const double pivot = a[c * ld + c];
    if (!(pivot > 0.0 || pivot < -least) || !std::isfinite(pivot)) return false;
    signs[c] = pivot > 0.0 ? 1.0 : -1.0;
    a[c * ld + c] = std::sqrt(std::abs(pivot));
    inverse[c] = signs[c] / a[c * ld + c];
    for (int i = c + 1; i < Width; ++i) a[c * ld + i] *= inverse[c];
  }
  int i = Width;
  for (; i + kLanes <= rows; i += kLanes)
    for (int c = 0; c < Width; ++c) {
      LooseBatch sum = load(a + c * ld + i);
      for (int d = 0; d < c; ++d) sum -= load(a + d * ld + i) * (signs[d] * a[d * ld + c]);
      store(sum * inverse[c], a + c * ld + i);
    }
  for (; i < rows; ++i)
    for (int c = 0; c < Width; ++c) {
      for (int d = 0; d < c; ++d) a[c * ld + i] -= signs[d] * a[d * ld + c] * a[d * ld + i];
      a[c * ld + i] *= inverse[c];
    }
  return true;
}

// Column by column from the left, each first less what those before it take.
inline bool factorise_block(int m, int k, double* a, std::ptrdiff_t ld, double least, double* signs) {
  int j = 0;
  for (; j + kWidth <= k; j += kWidth) {
    double* const corner = a + j * (ld + 1);
    subtract_columns_of_square<kWidth>(0, m - j, j, a + j, ld, signs, corner, ld);
    if (!factorise_columns<kWidth>(m - j, corner, ld, least, signs + j)) return false;
  }
  for (; j < k; ++j) {
    double* const corner = a + j * (ld + 1);
    subtract_columns_of_square<1>(0, m - j, j, a + j, ld, signs, corner, ld);
    if (!factorise_columns<1>(m - j, corner, ld, least, signs + j)) return false;
  }
  return true;
}

}  // namespace

SOFT_ROBOT_LAB_CLONES bool factorise_panel(int m, int k, double* panel, double* signs) {
  double largest = 0.0;
  for (int j = 0; j < k; ++j) largest = std::max(largest, std::abs(panel[static_cast<std::ptrdiff_t>(j) * (m + 1)]));
  const double least = kLeastPivot * largest;
  for (int first = 0; first < k; first += kDepth) {
    const int columns = std::min(kDepth, k - first), left = k - first - columns;
    double* const block = panel + static_cast<std::ptrdiff_t>(first) * (m + 1);
    if (!factorise_block(m - first, columns, block, m, least, signs + first)) return false;
    subtract_from_columns(m - first - columns, left, columns, block + columns, m, signs + first,
                          block + static_cast<std::ptrdiff_t>(columns) * (m + 1), m);
  }
  return true;
}

SOFT_ROBOT_LAB_CLONES void subtract_signed_square(int n, int k, const double* a, int ld_a, const double* signs,
                                                  double* c, int ld_c) {
  for (int first = 0; first < k; first += kDepth)
    subtract_from_columns(n, n, std::min(kDepth, k - first), a + static_cast<std::ptrdiff_t>(first) * ld_a, ld_a,
                          signs + first, c, ld_c);
}

SOFT_ROBOT_LAB_CLONES void solve_panel(int m, int k, const double* panel, int columns, double* x) {
  for (double* end = x + static_cast<std::ptrdiff_t>(columns) * m; x < end; x += m) {
    int j = 0;
    for (; j + kWidth <= k; j += kWidth)
      solve_columns<kWidth>(m - j, panel + static_cast<std::ptrdiff_t>(j) * (m + 1), m, x + j);
    for (; j < k; ++j) solve_columns<1>(m - j, panel + static_cast<std::ptrdiff_t>(j) * (m + 1), m, x + j);
  }
}

SOFT_ROBOT_LAB_CLONES void solve_panel_transposed(int m, int k, const double* panel, int columns, double* x) {
  for (double* end = x + static_cast<std::ptrdiff_t>(columns) * m; x < end; x += m) {
    int j = k;
    for (; j % kWidth != 0; --j)
      solve_columns_transposed<1>(m - j + 1, panel + static_cast<std::ptrdiff_t>(j - 1) * (m + 1), m, x + j - 1);
    for (; j > 0; j -= kWidth)
      solve_columns_transposed<kWidth>(m - j + kWidth, panel + static_cast<std::ptrdiff_t>(j - kWidth) * (m + 1), m,
                                       x + j - kWidth);
  }
}

}  // namespace soft_robot_lab
