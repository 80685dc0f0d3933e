// Arithmetic of four tetrahedra at once, one per lane: energy, gradient and Hessian of the element described in
// elements.h. Node and coordinate of an array of packs: 3 * node + axis.
#pragma once

#include <cmath>
#include <cstddef>

// One copy of each kernel for processors with AVX2 and fused multiply-add, one for all others; chosen at start.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define SOFT_ROBOT_LAB_CLONES __attribute__((target_clones("arch=haswell", "default"), flatten))
#else
#define SOFT_ROBOT_LAB_CLONES
#endif

namespace soft_robot_lab {

// Elements are worked on four at a time, one per lane.
inline constexpr int kLanes = 4;
typedef double Pack __attribute__((vector_size(kLanes * sizeof(double))));

struct PackVector {
  Pack v[3];
};
struct PackMatrix {
  Pack m[3][3];  // row, column
};

inline Pack splat(double value) { return Pack{value, value, value, value}; }

inline PackMatrix cofactor(const PackMatrix& f) {
  PackMatrix c;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c.m[i][j] = f.m[i1][j1] * f.m[i2][j2] - f.m[i1][j2] * f.m[i2][j1];
    }
  }
  return c;
}

inline Pack determinant(const PackMatrix& f, const PackMatrix& cofactors) {
  return f.m[0][0] * cofactors.m[0][0] + f.m[0][1] * cofactors.m[0][1] + f.m[0][2] * cofactors.m[0][2];
}

inline Pack squared_norm(const PackMatrix& f) {
  Pack sum = splat(0.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += f.m[i][j] * f.m[i][j];
  return sum;
}

inline PackVector multiply(const PackMatrix& a, const Pack* x) {
  PackVector y;
  for (int i = 0; i < 3; ++i) y.v[i] = a.m[i][0] * x[0] + a.m[i][1] * x[1] + a.m[i][2] * x[2];
  return y;
}

// Deformation gradient F = sum_a x_a (grad a)^T.
template <int Nodes>
inline PackMatrix deformation_gradient(const Pack* positions, const Pack* gradients) {
  PackMatrix f;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) f.m[i][j] = splat(0.0);
  for (int a = 0; a < Nodes; ++a)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) f.m[i][j] += positions[3 * a + i] * gradients[3 * a + j];
  return f;
}

inline void gather(const double* positions, const int* nodes, int node_count, Pack* out) {
  for (int a = 0; a < node_count; ++a)
    for (int lane = 0; lane < kLanes; ++lane)
      for (int i = 0; i < 3; ++i) out[3 * a + i][lane] = positions[3 * nodes[a * kLanes + lane] + i];
}

inline void scatter_add(const Pack* in, const int* nodes, int node_count, double* forces) {
  for (int a = 0; a < node_count; ++a)
    for (int lane = 0; lane < kLanes; ++lane)
      for (int i = 0; i < 3; ++i) forces[3 * nodes[a * kLanes + lane] + i] += in[3 * a + i][lane];
}

struct PackSums {
  Pack energy, mean_determinant, smallest_determinant;
};

// Elastic gradient plus p grad(V0 Jbar) of four elements.
template <int Nodes, int Points>
inline PackSums pack_gradient(const Pack* x, const Pack* gradients, const Pack* weights, double mu, Pack p,
                              Pack* forces) {
  PackSums sums{splat(0.0), splat(0.0), splat(1e300)};
  for (int i = 0; i < 3 * Nodes; ++i) forces[i] = splat(0.0);
  Pack volume = splat(0.0);
  for (int q = 0; q < Points; ++q) {
    const Pack* g = gradients + 3 * Nodes * q;
    const PackMatrix f = deformation_gradient<Nodes>(x, g);
    const PackMatrix c = cofactor(f);
    const Pack j = determinant(f, c), w = weights[q];
    sums.energy += w * mu * (0.5 * (squared_norm(f) - 3.0) - (j - 1.0) + 0.5 * (j - 1.0) * (j - 1.0));
    sums.mean_determinant += w * j;
    sums.smallest_determinant = j < sums.smallest_determinant ? j : sums.smallest_determinant;
    volume += w;
    const Pack volumetric = w * (mu * (j - 2.0) + p);
    PackMatrix stress;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) stress.m[i][k] = w * mu * f.m[i][k] + volumetric * c.m[i][k];
    for (int a = 0; a < Nodes; ++a) {
      const PackVector force = multiply(stress, g + 3 * a);
      for (int i = 0; i < 3; ++i) forces[3 * a + i] += force.v[i];
    }
  }
  const Pack safe_volume = volume > 0.0 ? volume : splat(1.0);
  sums.mean_determinant = sums.mean_determinant / safe_volume;
  return sums;
}

// Condensed Hessian blocks of four elements: pairs a >= b in rows, 9 numbers each (column-major). With g = d(V0
// Jbar)/dx the block (a, b) is
//   [laplacian + extra] I + sum_q w mu (c grad a)(c grad b)^T + lambda/V0 g_a g_b^T
//   + [e]x with e = sum_q w (mu (J - 2) + p) F (grad a x grad b),   ([e]x)_ik = epsilon_ikm e_m   (d2J/dF2 contracted)
template <int Nodes, int Points>
inline void pack_hessian(const Pack* x, const Pack* gradients, const Pack* weights, const Pack* laplacian, double mu,
                         double lambda, Pack p, bool convex, Pack* blocks, Pack* volume_gradient) {
  PackMatrix f[Points], c[Points];
  Pack second[Points], extra[Points], cg[Points][3 * Nodes];
  Pack volume = splat(0.0);
  for (int i = 0; i < 3 * Nodes; ++i) volume_gradient[i] = splat(0.0);
  for (int q = 0; q < Points; ++q) {
    const Pack* g = gradients + 3 * Nodes * q;
    f[q] = deformation_gradient<Nodes>(x, g);
    c[q] = cofactor(f[q]);
    const Pack j = determinant(f[q], c[q]), w = weights[q];
    const Pack s = mu * (j - 2.0) + p;
    second[q] = w * s;
    extra[q] = splat(0.0);
    if (convex) {
      // |eigenvalues of d2J/dF2| <= 2/sqrt(3) |F|, so this much makes mu I + s d2J/dF2 positive.
      Pack bound;
      const Pack norm = squared_norm(f[q]);
      for (int lane = 0; lane < kLanes; ++lane) bound[lane] = std::abs(s[lane]) * 1.1547005384 * std::sqrt(norm[lane]);
      extra[q] = bound > mu ? w * (bound - mu) : splat(0.0);
    }
    volume += w;
    for (int a = 0; a < Nodes; ++a) {
      const PackVector along = multiply(c[q], g + 3 * a);
      for (int i = 0; i < 3; ++i) {
        volume_gradient[3 * a + i] += w * along.v[i];
        cg[q][3 * a + i] = along.v[i];
      }
    }
  }
  const Pack safe_volume = volume > 0.0 ? volume : splat(1.0);
  const Pack stiffness = lambda / safe_volume;

  int pair = 0;
  for (int a = 0; a < Nodes; ++a) {
    for (int b = 0; b <= a; ++b, ++pair) {
      Pack* block = blocks + 9 * pair;
      Pack left[3], e[3], isotropic = laplacian[pair];
      for (int i = 0; i < 3; ++i) {
        left[i] = stiffness * volume_gradient[3 * a + i];
        e[i] = splat(0.0);
      }
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) block[3 * k + i] = left[i] * volume_gradient[3 * b + k];
      for (int q = 0; q < Points; ++q) {
        const Pack* ga = gradients + 3 * Nodes * q + 3 * a;
        const Pack* gb = gradients + 3 * Nodes * q + 3 * b;
        const Pack w = weights[q] * mu;
        for (int k = 0; k < 3; ++k) {
          const Pack right = w * cg[q][3 * b + k];
          for (int i = 0; i < 3; ++i) block[3 * k + i] += cg[q][3 * a + i] * right;
        }
        if (convex) isotropic += extra[q] * (ga[0] * gb[0] + ga[1] * gb[1] + ga[2] * gb[2]);
        if (a == b) continue;
        const Pack cross[3] = {ga[1] * gb[2] - ga[2] * gb[1], ga[2] * gb[0] - ga[0] * gb[2],
                               ga[0] * gb[1] - ga[1] * gb[0]};
        const PackVector turned = multiply(f[q], cross);
        for (int i = 0; i < 3; ++i) e[i] += second[q] * turned.v[i];
      }
      block[0] += isotropic;
      block[4] += isotropic;
      block[8] += isotropic;
      // row i, column k: epsilon_ikm e_m
      block[3] += e[2];
      block[1] -= e[2];
      block[6] -= e[1];
      block[2] += e[1];
      block[7] += e[0];
      block[5] -= e[0];
    }
  }
}

}  // namespace soft_robot_lab
