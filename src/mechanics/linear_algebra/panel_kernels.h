// SPDX-License-Identifier: BSD-3-Clause
// Sums with one dense panel of a sparse factor L S L', S = diag(+-1): m x k by columns, its first k rows lower
// triangular. A BLAS spends more on copies of so small a panel, and on calls, than on the sums.
#pragma once

namespace soft_robot_lab {

// The panel of A to that of L, with S; false at a pivot that all but vanishes.
bool factorise_panel(int m, int k, double* panel, double* signs);

// C -= A S A' in the lower triangle; A is n x k.
void subtract_signed_square(int n, int k, const double* a, int ld_a, const double* signs, double* c, int ld_c);

// x, `columns` of m: [L11 0; L21 1] x_new = x.
void solve_panel(int m, int k, const double* panel, int columns, double* x);

// [L11' L21'; 0 1] x_new = x.
void solve_panel_transposed(int m, int k, const double* panel, int columns, double* x);

}  // namespace soft_robot_lab
