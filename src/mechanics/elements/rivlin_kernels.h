// SPDX-License-Identifier: BSD-3-Clause
// The condensed Hessian of four tetrahedra of Mooney-Rivlin or Yeoh silicone (material_law.h).
#pragma once

#include <cmath>

#include "element_kernels.h"

namespace soft_robot_lab {

// What the Hessian needs of one quadrature point, times its weight.
struct RivlinPoint {
  BatchMatrix f, b;      // F, F F^T
  Batch second;          // w (slope (J - 2) - 4 c01 + p): weight of d2J/dF2
  Batch isotropic;       // w (slope + 2 c01 I1), and the convex shift
  Batch along_cofactor;  // w slope
  Batch curvature;       // w Y''(phi)
  Batch invariant;       // 2 w c01
};

// |eigenvalues of d2J/dF2| <= 2/sqrt(3) |F|, and d2 I2/dF2 >= -4/sqrt(3) |cof F|, as |cof A| <= |A|^2 / sqrt(3).
inline Batch convex_shift(Batch slope, Batch second, Batch c01, const BatchMatrix& f, const BatchMatrix& c) {
  const Batch f2 = squared_norm(f), c2 = squared_norm(c);
  Batch shift = splat(0.0);
  for (int lane = 0; lane < kLanes; ++lane) {
    const double least = 1.1547005384 * std::abs(second[lane]) * std::sqrt(f2[lane]) +
                         2.3094010768 * c01[lane] * std::sqrt(c2[lane]) - slope[lane];
    shift[lane] = least > 0.0 ? least : 0.0;
  }
  return shift;
}

inline RivlinPoint rivlin_point(const BatchMatrix& f, const BatchMatrix& c, Batch j, Batch w, const Rivlin& law,
                                Batch p, bool convex) {
  const Batch phi = shear_energy(f, j);
  Batch slope = 2.0 * (law.c10 + phi * (2.0 * law.c2 + 3.0 * law.c3 * phi));
  Batch curvature = 2.0 * law.c2 + 6.0 * law.c3 * phi;
  if (convex) {
    slope = slope > 0.0 ? slope : splat(0.0);
    curvature = curvature > 0.0 ? curvature : splat(0.0);
  }
  const Batch second = slope * (j - 2.0) - 4.0 * law.c01 + p;
  RivlinPoint point;
  point.f = f;
  point.b = times_transposed(f);
  point.second = w * second;
  point.isotropic = w * (slope + 2.0 * law.c01 * squared_norm(f));
  if (convex) point.isotropic += w * convex_shift(slope, second, law.c01, f, c);
  point.along_cofactor = w * slope;
  point.curvature = w * curvature;
  point.invariant = 2.0 * law.c01 * w;
  return point;
}

// With Y(phi) = c1 phi + c2 phi^2 + c3 phi^3 and slope = 2 Y': a = F grad a, a' = cof F grad a, n = 2 a + 2 (J - 2) a',
// ab = grad a . grad b. The block (a, b) is
//   sum_q w { [slope ab + 2 c01 (I1 ab - a.b)] I + slope a' b'^T + Y'' n_a n_b^T + 2 c01 (2 a b^T - b a^T - ab F F^T) }
//   + lambda/V0 g_a g_b^T + [e]x   with e and g as for neo-Hookean silicone.
template <int Nodes, int Points>
inline void batch_hessian(const Batch* x, const Batch* gradients, const Batch* weights, const Batch* /*laplacian*/,
                          const Rivlin& law, Batch lambda, Batch p, bool convex, Batch* blocks,
                          Batch* volume_gradient) {
  RivlinPoint points[Points];
  Batch along_f[Points][3 * Nodes], along_c[Points][3 * Nodes], along_phi[Points][3 * Nodes];
  Batch volume = splat(0.0);
  for (int i = 0; i < 3 * Nodes; ++i) volume_gradient[i] = splat(0.0);
  for (int q = 0; q < Points; ++q) {
    const Batch* g = gradients + 3 * Nodes * q;
    const BatchMatrix f = deformation_gradient<Nodes>(x, g), c = cofactor(f);
    const Batch j = determinant(f, c), w = weights[q];
    points[q] = rivlin_point(f, c, j, w, law, p, convex);
    volume += w;
    for (int a = 0; a < Nodes; ++a) {
      const BatchVector fa = multiply(f, g + 3 * a), ca = multiply(c, g + 3 * a);
      for (int i = 0; i < 3; ++i) {
        along_f[q][3 * a + i] = fa.v[i];
        along_c[q][3 * a + i] = ca.v[i];
        along_phi[q][3 * a + i] = 2.0 * (fa.v[i] + (j - 2.0) * ca.v[i]);
        volume_gradient[3 * a + i] += w * ca.v[i];
      }
    }
  }
  const Batch safe_volume = volume > 0.0 ? volume : splat(1.0);
  const Batch stiffness = lambda / safe_volume;

  int pair = 0;
  for (int a = 0; a < Nodes; ++a) {
    for (int b = 0; b <= a; ++b, ++pair) {
      Batch* block = blocks + 9 * pair;
      Batch e[3] = {splat(0.0), splat(0.0), splat(0.0)}, isotropic = splat(0.0);
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i)
          block[3 * k + i] = stiffness * volume_gradient[3 * a + i] * volume_gradient[3 * b + k];
      for (int q = 0; q < Points; ++q) {
        const RivlinPoint& point = points[q];
        const Batch *ga = gradients + 3 * Nodes * q + 3 * a, *gb = gradients + 3 * Nodes * q + 3 * b;
        const Batch *fa = along_f[q] + 3 * a, *fb = along_f[q] + 3 * b;
        const Batch *ca = along_c[q] + 3 * a, *cb = along_c[q] + 3 * b;
        const Batch *na = along_phi[q] + 3 * a, *nb = along_phi[q] + 3 * b;
        const Batch both = ga[0] * gb[0] + ga[1] * gb[1] + ga[2] * gb[2];
        const Batch weight = point.invariant * both;
        isotropic += point.isotropic * both - point.invariant * (fa[0] * fb[0] + fa[1] * fb[1] + fa[2] * fb[2]);
        for (int k = 0; k < 3; ++k) {
          const Batch right_c = point.along_cofactor * cb[k], right_n = point.curvature * nb[k];
          const Batch right_f = 2.0 * point.invariant * fb[k], left_f = point.invariant * fa[k];
          for (int i = 0; i < 3; ++i)
            block[3 * k + i] +=
                ca[i] * right_c + na[i] * right_n + fa[i] * right_f - fb[i] * left_f - weight * point.b.m[i][k];
        }
        if (a == b) continue;
        const Batch cross[3] = {ga[1] * gb[2] - ga[2] * gb[1], ga[2] * gb[0] - ga[0] * gb[2],
                                ga[0] * gb[1] - ga[1] * gb[0]};
        const BatchVector turned = multiply(point.f, cross);
        for (int i = 0; i < 3; ++i) e[i] += point.second * turned.v[i];
      }
      add_isotropic_and_cross(isotropic, e, block);
    }
  }
}

}  // namespace soft_robot_lab
