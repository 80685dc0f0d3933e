// SPDX-License-Identifier: BSD-3-Clause
// The routines of BLAS and LAPACK that the factorisation needs, for several threads at once. Matrices are column-major;
// arguments are those of the reference (netlib.org/blas, netlib.org/lapack).
//
// An OpenBLAS built without threads, as Debian's libopenblas0-serial, is not safe when two threads call it at once:
// some results are then plainly wrong. Where such a library is linked these calls wait for one another.
// The first call has the library use one thread, unless the environment's OPENBLAS_NUM_THREADS asks for more.
#pragma once

namespace soft_robot_lab::blas {

bool waits();  // whether calls wait for one another

// A = L L' in the lower triangle; the order of the first minor that is not positive, or 0.
int cholesky(int n, double* a, int ld);

enum class Side : char { left = 'L', right = 'R' };
enum class Transposed : char { no = 'N', yes = 'T' };

// B = op(L)^-1 B or B op(L)^-1 with the lower triangle L; B is rows x columns.
void solve_triangular(Side side, Transposed transposed, int rows, int columns, const double* l, int ld_l, double* b,
                      int ld_b);

// C -= A A' in the lower triangle; A is n x k.
void subtract_square(int n, int k, const double* a, int ld_a, double* c, int ld_c);

// C += factor x x' in the lower triangle.
void add_outer(int n, double factor, const double* x, double* c, int ld_c);

// C = alpha op(A) B + beta C; C is m x n, op(A) is m x k.
void multiply(Transposed transposed, int m, int n, int k, double alpha, const double* a, int ld_a, const double* b,
              int ld_b, double beta, double* c, int ld_c);

}  // namespace soft_robot_lab::blas
