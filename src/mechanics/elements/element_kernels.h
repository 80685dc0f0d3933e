// SPDX-License-Identifier: BSD-3-Clause
// Energy, gradient and Hessian of four tetrahedra at once: the element described in elements.h.
#pragma once

#include <cmath>

#include "mechanics/material/material_law.h"
#include "mechanics/linear_algebra/batches.h"

namespace soft_robot_lab {

struct BatchSums {
  Batch energy, mean_determinant, smallest_determinant;
};

// Elastic gradient plus p grad(V0 Jbar) of four elements.
template <int Nodes, int Points, class Law>
inline BatchSums batch_gradient(const Batch* x, const Batch* gradients, const Batch* weights, const Law& law, Batch p,
                                Batch* forces) {
  BatchSums sums{splat(0.0), splat(0.0), splat(1e300)};
  for (int i = 0; i < 3 * Nodes; ++i) forces[i] = splat(0.0);
  Batch volume = splat(0.0);
  for (int q = 0; q < Points; ++q) {
    const Batch* g = gradients + 3 * Nodes * q;
    const BatchMatrix f = deformation_gradient<Nodes>(x, g);
    const BatchMatrix c = cofactor(f);
    const Batch j = determinant(f, c), w = weights[q];
    const BatchStress point = stress_of(law, f, c, j);
    sums.energy += w * point.energy;
    sums.mean_determinant += w * j;
    sums.smallest_determinant = j < sums.smallest_determinant ? j : sums.smallest_determinant;
    volume += w;
    const Batch along_f = w * point.along_f, along_cofactor = w * (point.along_cofactor + p);
    BatchMatrix stress;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) stress.m[i][k] = along_f * f.m[i][k] + along_cofactor * c.m[i][k];
    add_rest_of_stress(law, f, w, stress);
    for (int a = 0; a < Nodes; ++a) {
      const BatchVector force = multiply(stress, g + 3 * a);
      for (int i = 0; i < 3; ++i) forces[3 * a + i] += force.v[i];
    }
  }
  const Batch safe_volume = volume > 0.0 ? volume : splat(1.0);
  sums.mean_determinant = sums.mean_determinant / safe_volume;
  return sums;
}

// isotropic I + [e]x: in row i, column k epsilon_ikm e_m.
inline void add_isotropic_and_cross(Batch isotropic, const Batch* e, Batch* block) {
  block[0] += isotropic;
  block[4] += isotropic;
  block[8] += isotropic;
  block[3] += e[2];
  block[1] -= e[2];
  block[6] -= e[1];
  block[2] += e[1];
  block[7] += e[0];
  block[5] -= e[0];
}

// Of weight w, so much that w (mu I + s d2J/dF2) gets positive: |eigenvalues of d2J/dF2| <= 2/sqrt(3) |F|.
inline Batch convex_shift(Batch w, Batch mu, Batch s, const BatchMatrix& f) {
  Batch bound;
  const Batch norm = squared_norm(f);
  for (int lane = 0; lane < kLanes; ++lane) bound[lane] = std::abs(s[lane]) * 1.1547005384 * std::sqrt(norm[lane]);
  return bound > mu ? w * (bound - mu) : splat(0.0);
}

// Condensed Hessian blocks of four elements: pairs a >= b in rows, 9 numbers each (column-major). With g = d(V0
// Jbar)/dx the block (a, b) is
//   [laplacian + extra] I + sum_q w mu (c grad a)(c grad b)^T + lambda/V0 g_a g_b^T
//   + [e]x with e = sum_q w (mu (J - 2) + p) F (grad a x grad b),   ([e]x)_ik = epsilon_ikm e_m   (d2J/dF2 contracted)
template <int Nodes, int Points>
inline void batch_hessian(const Batch* x, const Batch* gradients, const Batch* weights, const Batch* laplacian,
                          const NeoHookean& law, Batch lambda, Batch p, bool convex, Batch* blocks,
                          Batch* volume_gradient) {
  const Batch mu = law.mu;
  BatchMatrix f[Points], c[Points];
  Batch second[Points], extra[Points], cg[Points][3 * Nodes];
  Batch volume = splat(0.0);
  for (int i = 0; i < 3 * Nodes; ++i) volume_gradient[i] = splat(0.0);
  for (int q = 0; q < Points; ++q) {
    const Batch* g = gradients + 3 * Nodes * q;
    f[q] = deformation_gradient<Nodes>(x, g);
    c[q] = cofactor(f[q]);
    const Batch j = determinant(f[q], c[q]), w = weights[q];
    const Batch s = mu * (j - 2.0) + p;
    second[q] = w * s;
    extra[q] = splat(0.0);
    if (convex) extra[q] = convex_shift(w, mu, s, f[q]);
    volume += w;
    for (int a = 0; a < Nodes; ++a) {
      const BatchVector along = multiply(c[q], g + 3 * a);
      for (int i = 0; i < 3; ++i) {
        volume_gradient[3 * a + i] += w * along.v[i];
        cg[q][3 * a + i] = along.v[i];
      }
    }
  }
  const Batch safe_volume = volume > 0.0 ? volume : splat(1.0);
  const Batch stiffness = lambda / safe_volume;

  int pair = 0;
  for (int a = 0; a < Nodes; ++a) {
    for (int b = 0; b <= a; ++b, ++pair) {
      Batch* block = blocks + 9 * pair;
      Batch left[3], e[3], isotropic = laplacian[pair];
      for (int i = 0; i < 3; ++i) {
        left[i] = stiffness * volume_gradient[3 * a + i];
        e[i] = splat(0.0);
      }
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) block[3 * k + i] = left[i] * volume_gradient[3 * b + k];
      for (int q = 0; q < Points; ++q) {
        const Batch* ga = gradients + 3 * Nodes * q + 3 * a;
        const Batch* gb = gradients + 3 * Nodes * q + 3 * b;
        const Batch w = weights[q] * mu;
        for (int k = 0; k < 3; ++k) {
          const Batch right = w * cg[q][3 * b + k];
          for (int i = 0; i < 3; ++i) block[3 * k + i] += cg[q][3 * a + i] * right;
        }
        if (convex) isotropic += extra[q] * (ga[0] * gb[0] + ga[1] * gb[1] + ga[2] * gb[2]);
        if (a == b) continue;
        const Batch cross[3] = {ga[1] * gb[2] - ga[2] * gb[1], ga[2] * gb[0] - ga[0] * gb[2],
                                ga[0] * gb[1] - ga[1] * gb[0]};
        const BatchVector turned = multiply(f[q], cross);
        for (int i = 0; i < 3; ++i) e[i] += second[q] * turned.v[i];
      }
      add_isotropic_and_cross(isotropic, e, block);
    }
  }
}

}  // namespace soft_robot_lab
