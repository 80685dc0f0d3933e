// SPDX-License-Identifier: BSD-3-Clause
// Arithmetic of four tetrahedra at once, one per lane. Node and coordinate of an array of batches: 3 * node + axis.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

// One copy of each kernel for processors with AVX2 and fused multiply-add, one for all others; chosen at start. Older
// compilers know of such processors by the name of one alone.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#if __GNUC__ >= 12
#define SOFT_ROBOT_LAB_CLONES __attribute__((target_clones("arch=x86-64-v3", "default"), flatten))
#else
#define SOFT_ROBOT_LAB_CLONES __attribute__((target_clones("arch=haswell", "default"), flatten))
#endif
#else
#define SOFT_ROBOT_LAB_CLONES
#endif

namespace soft_robot_lab {

// Elements are worked on four at a time, one per lane.
inline constexpr int kLanes = 4;
typedef double Batch __attribute__((vector_size(kLanes * sizeof(double))));

// The copies for AVX2 load and store batches at multiples of their size. The compiler knows of less where it does not
// compile for AVX2, and would allocate them at multiples of 16 bytes.
template <class T>
struct BatchAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{sizeof(Batch)};

  BatchAllocator() = default;
  template <class Other>
  BatchAllocator(const BatchAllocator<Other>& /*other*/) {}
  T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), kAlignment)); }
  void deallocate(T* batches, std::size_t /*count*/) { ::operator delete(batches, kAlignment); }
  friend bool operator==(BatchAllocator, BatchAllocator) { return true; }
  friend bool operator!=(BatchAllocator, BatchAllocator) { return false; }
};
using Batches = std::vector<Batch, BatchAllocator<Batch>>;

struct BatchVector {
  Batch v[3];
};
struct BatchMatrix {
  Batch m[3][3];  // row, column
};

inline Batch splat(double value) { return Batch{value, value, value, value}; }

inline BatchMatrix cofactor(const BatchMatrix& f) {
  BatchMatrix c;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c.m[i][j] = f.m[i1][j1] * f.m[i2][j2] - f.m[i1][j2] * f.m[i2][j1];
    }
  }
  return c;
}

inline Batch determinant(const BatchMatrix& f, const BatchMatrix& cofactors) {
  return f.m[0][0] * cofactors.m[0][0] + f.m[0][1] * cofactors.m[0][1] + f.m[0][2] * cofactors.m[0][2];
}

inline Batch squared_norm(const BatchMatrix& f) {
  Batch sum = splat(0.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += f.m[i][j] * f.m[i][j];
  return sum;
}

// F F^T
inline BatchMatrix times_transposed(const BatchMatrix& f) {
  BatchMatrix b;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) b.m[i][j] = f.m[i][0] * f.m[j][0] + f.m[i][1] * f.m[j][1] + f.m[i][2] * f.m[j][2];
  return b;
}

inline BatchVector multiply(const BatchMatrix& a, const Batch* x) {
  BatchVector y;
  for (int i = 0; i < 3; ++i) y.v[i] = a.m[i][0] * x[0] + a.m[i][1] * x[1] + a.m[i][2] * x[2];
  return y;
}

// Deformation gradient F = sum_a x_a (grad a)^T.
template <int Nodes>
inline BatchMatrix deformation_gradient(const Batch* positions, const Batch* gradients) {
  BatchMatrix f;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) f.m[i][j] = splat(0.0);
  for (int a = 0; a < Nodes; ++a)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) f.m[i][j] += positions[3 * a + i] * gradients[3 * a + j];
  return f;
}

inline void gather(const double* positions, const int* nodes, int node_count, Batch* out) {
  for (int a = 0; a < node_count; ++a)
    for (int lane = 0; lane < kLanes; ++lane)
      for (int i = 0; i < 3; ++i) out[3 * a + i][lane] = positions[3 * nodes[a * kLanes + lane] + i];
}

inline void scatter_add(const Batch* in, const int* nodes, int node_count, double* forces) {
  for (int a = 0; a < node_count; ++a)
    for (int lane = 0; lane < kLanes; ++lane)
      for (int i = 0; i < 3; ++i) forces[3 * nodes[a * kLanes + lane] + i] += in[3 * a + i][lane];
}

}  // namespace soft_robot_lab
