// SPDX-License-Identifier: BSD-3-Clause
#include "blas.h"

#include <cstddef>
#include <cstdlib>
#include <mutex>

// By their Fortran names, as every implementation has them.
extern "C" {
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dtrsm_(const char* side, const char* uplo, const char* trans, const char* diag, const int* m, const int* n,
            const double* alpha, const double* a, const int* lda, double* b, const int* ldb);
void dtrsv_(const char* uplo, const char* trans, const char* diag, const int* n, const double* a, const int* lda,
            double* x, const int* incx);
void dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha, const double* a,
            const int* lda, const double* beta, double* c, const int* ldc);
void dsyr_(const char* uplo, const int* n, const double* alpha, const double* x, const int* incx, double* a,
           const int* lda);
void dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k, const double* alpha,
            const double* a, const int* lda, const double* b, const int* ldb, const double* beta, double* c,
            const int* ldc);

// Of OpenBLAS alone: 0 where it was built without threads.
int openblas_get_parallel() __attribute__((weak));
void openblas_set_num_threads(int threads) __attribute__((weak));
}

namespace soft_robot_lab::blas {
namespace {

constexpr double kOne = 1.0, kMinusOne = -1.0;
constexpr int kNext = 1;
constexpr int kFewColumns = 4;  // for which dtrsm would spend more on copies of the triangle than on the solution

// The fronts are small: threads of the library's own only wait for one another, and for those of the simulation.
void use_one_thread() {
  static const bool done = [] {
    if (openblas_set_num_threads != nullptr && std::getenv("OPENBLAS_NUM_THREADS") == nullptr)
      openblas_set_num_threads(1);
    return true;
  }();
  static_cast<void>(done);
}

// Held during a call, where calls wait for one another.
class Turn {
 public:
  Turn() {
    use_one_thread();
    if (waits()) lock_ = std::unique_lock<std::mutex>(mutex());
  }

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::unique_lock<std::mutex> lock_;
};

char letter(Side side) { return static_cast<char>(side); }
char letter(Transposed transposed) { return static_cast<char>(transposed); }

}  // namespace

bool waits() {
  static const bool without_threads = openblas_get_parallel != nullptr && openblas_get_parallel() == 0;
  return without_threads;
}

int cholesky(int n, double* a, int ld) {
  const Turn turn;
  int info = 0;
  dpotrf_("L", &n, a, &ld, &info);
  return info;
}

void solve_triangular(Side side, Transposed transposed, int rows, int columns, const double* l, int ld_l, double* b,
                      int ld_b) {
  const Turn turn;
  const char at = letter(side), how = letter(transposed);
  if (side == Side::left && columns <= kFewColumns) {
    for (int j = 0; j < columns; ++j) dtrsv_("L", &how, "N", &rows, l, &ld_l, b + std::ptrdiff_t(j) * ld_b, &kNext);
    return;
  }
  dtrsm_(&at, "L", &how, "N", &rows, &columns, &kOne, l, &ld_l, b, &ld_b);
}

void subtract_square(int n, int k, const double* a, int ld_a, double* c, int ld_c) {
  const Turn turn;
  dsyrk_("L", "N", &n, &k, &kMinusOne, a, &ld_a, &kOne, c, &ld_c);
}

void add_outer(int n, double factor, const double* x, double* c, int ld_c) {
  const Turn turn;
  dsyr_("L", &n, &factor, x, &kNext, c, &ld_c);
}

void multiply(Transposed transposed, int m, int n, int k, double alpha, const double* a, int ld_a, const double* b,
              int ld_b, double beta, double* c, int ld_c) {
  const Turn turn;
  const char how = letter(transposed);
  dgemm_(&how, "N", &m, &n, &k, &alpha, a, &ld_a, b, &ld_b, &beta, c, &ld_c);
}

}  // namespace soft_robot_lab::blas
