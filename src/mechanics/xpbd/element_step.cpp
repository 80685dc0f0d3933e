// SPDX-License-Identifier: BSD-3-Clause
#include "element_step.h"

#include "mechanics/linear_algebra/batch_ldlt.h"
#include "mechanics/material/rivlin_kernels.h"

namespace soft_robot_lab {
namespace {

constexpr double kSmallestPivot = 0.1;  // of I + h^2 M^-1/2 K M^-1/2, which is above 1 where K is positive

// Plain pointers, so that every copy of the code stays self-contained.
struct BatchArrays {
  const int *element, *nodes;
  const Batch *gradients, *weights, *laplacian, *lambda_pa;
};

template <int Nodes, int Points>
inline BatchArrays arrays_of(const BatchArrays& all, int batch) {
  const auto place = static_cast<std::ptrdiff_t>(batch);
  return {all.element + place * kLanes,
          all.nodes + place * Nodes * kLanes,
          all.gradients + place * Points * Nodes * 3,
          all.weights + place * Points,
          all.laplacian + place * Nodes * (Nodes + 1) / 2,
          all.lambda_pa + place};
}

// Unused lanes stay put: their element is in another lane or batch too.
inline void scatter_used(const Batch* in, const BatchArrays& e, int node_count, double* out) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if (e.element[lane] < 0) continue;
    for (int a = 0; a < node_count; ++a)
      for (int i = 0; i < 3; ++i) out[3 * e.nodes[a * kLanes + lane] + i] += in[3 * a + i][lane];
  }
}

// S = I + h^2 M^-1/2 K M^-1/2, lower triangle by columns, from the blocks of K.
template <int Nodes>
inline void scale_hessian(const Batch* blocks, const Batch* s, double h, Batch* matrix) {
  constexpr int kSize = 3 * Nodes;
  int pair = 0;
  for (int a = 0; a < Nodes; ++a) {
    for (int b = 0; b <= a; ++b, ++pair) {
      for (int k = 0; k < 3; ++k) {
        const Batch scale = h * h * s[3 * b + k];
        Batch* column = matrix + column_start(kSize, 3 * b + k);
        for (int i = a == b ? k : 0; i < 3; ++i)
          column[3 * a + i] = scale * s[3 * a + i] * blocks[9 * pair + 3 * k + i];
      }
    }
  }
  for (int i = 0; i < kSize; ++i) matrix[column_start(kSize, i) + i] += 1.0;
}

template <int Nodes, int Points, class Law>
inline void move_batches(const BatchArrays& all, const Law* laws, int first, int last, const ElementStep& step) {
  constexpr int kSize = 3 * Nodes;
  Batch x[kSize], s[kSize], gradient[kSize], volume_gradient[kSize], motion[kSize];
  Batch blocks[9 * Nodes * (Nodes + 1) / 2], matrix[triangle_size(kSize)];
  const double h = step.time_step_s;
  for (int batch = first; batch < last; ++batch) {
    const BatchArrays e = arrays_of<Nodes, Points>(all, batch);
    const Law& law = laws[batch];
    const Batch lambda_pa = *e.lambda_pa;
    Batch* multipliers = step.multipliers + static_cast<std::ptrdiff_t>(batch) * kSize;
    gather(step.positions_m, e.nodes, Nodes, x);
    gather(step.root_inverse_masses, e.nodes, Nodes, s);
    Batch p = splat(0.0);
    for (int lane = 0; lane < kLanes; ++lane)
      if (e.element[lane] >= 0) p[lane] = step.volume_multipliers_pa[e.element[lane]];

    const BatchSums sums = batch_gradient<Nodes, Points>(x, e.gradients, e.weights, law, splat(0.0), gradient);
    const Batch pressure = lambda_pa * (sums.mean_determinant - 1.0);
    for (const bool convex : {false, true}) {
      batch_hessian<Nodes, Points>(x, e.gradients, e.weights, e.laplacian, law, lambda_pa, p, convex, blocks,
                                   volume_gradient);
      scale_hessian<Nodes>(blocks, s, h, matrix);
      const Batch pivot = factorise_ldlt<kSize>(matrix);
      bool positive = true;
      for (int lane = 0; lane < kLanes; ++lane) positive = positive && pivot[lane] > kSmallestPivot;
      if (positive) break;
    }

    for (int i = 0; i < kSize; ++i)
      motion[i] = -h * h * s[i] * (gradient[i] + pressure * volume_gradient[i]) - multipliers[i];
    solve_ldlt<kSize>(matrix, motion);
    Batch volume = splat(0.0), volumetric_strain = splat(0.0);
    for (int q = 0; q < Points; ++q) volume += e.weights[q];
    for (int i = 0; i < kSize; ++i) {
      multipliers[i] += motion[i];
      motion[i] *= s[i];
      volumetric_strain += volume_gradient[i] * motion[i];
    }
    scatter_used(motion, e, Nodes, step.positions_m);
    for (int lane = 0; lane < kLanes; ++lane)
      if (e.element[lane] >= 0)
        step.volume_multipliers_pa[e.element[lane]] =
            pressure[lane] + lambda_pa[lane] * volumetric_strain[lane] / volume[lane];
  }
}

template <int Nodes, int Points, class Law>
inline void measure_batches(const BatchArrays& all, const Law* laws, int count, const double* positions,
                            Batch* energies) {
  Batch x[3 * Nodes], unused[3 * Nodes];
  for (int batch = 0; batch < count; ++batch) {
    const BatchArrays e = arrays_of<Nodes, Points>(all, batch);
    gather(positions, e.nodes, Nodes, x);
    const BatchSums sums = batch_gradient<Nodes, Points>(x, e.gradients, e.weights, laws[batch], splat(0.0), unused);
    Batch volume = splat(0.0);
    for (int q = 0; q < Points; ++q) volume += e.weights[q];
    const Batch volumetric_strain = sums.mean_determinant - 1.0;
    energies[batch] = sums.energy + 0.5 * *e.lambda_pa * volume * volumetric_strain * volumetric_strain;
  }
}

SOFT_ROBOT_LAB_CLONES void move_quadratic(const BatchArrays& all, const NeoHookean* laws, int first, int last,
                                          const ElementStep& step) {
  move_batches<10, 4>(all, laws, first, last, step);
}
SOFT_ROBOT_LAB_CLONES void measure_quadratic(const BatchArrays& all, const NeoHookean* laws, int count,
                                             const double* positions, Batch* energies) {
  measure_batches<10, 4>(all, laws, count, positions, energies);
}
SOFT_ROBOT_LAB_CLONES void move_linear(const BatchArrays& all, const NeoHookean* laws, int first, int last,
                                       const ElementStep& step) {
  move_batches<4, 1>(all, laws, first, last, step);
}
SOFT_ROBOT_LAB_CLONES void measure_linear(const BatchArrays& all, const NeoHookean* laws, int count,
                                          const double* positions, Batch* energies) {
  measure_batches<4, 1>(all, laws, count, positions, energies);
}
SOFT_ROBOT_LAB_CLONES void move_quadratic(const BatchArrays& all, const Rivlin* laws, int first, int last,
                                          const ElementStep& step) {
  move_batches<10, 4>(all, laws, first, last, step);
}
SOFT_ROBOT_LAB_CLONES void measure_quadratic(const BatchArrays& all, const Rivlin* laws, int count,
                                             const double* positions, Batch* energies) {
  measure_batches<10, 4>(all, laws, count, positions, energies);
}
SOFT_ROBOT_LAB_CLONES void move_linear(const BatchArrays& all, const Rivlin* laws, int first, int last,
                                       const ElementStep& step) {
  move_batches<4, 1>(all, laws, first, last, step);
}
SOFT_ROBOT_LAB_CLONES void measure_linear(const BatchArrays& all, const Rivlin* laws, int count,
                                          const double* positions, Batch* energies) {
  measure_batches<4, 1>(all, laws, count, positions, energies);
}

BatchArrays arrays(const ElementBatches& batches) {
  return {batches.element.data(), batches.nodes.data(),     batches.gradients.data(),
          batches.weights.data(), batches.laplacian.data(), batches.lambda_pa.data()};
}

}  // namespace

void move_elements(const ElementBatches& batches, int first, int last, const ElementStep& step) {
  const BatchArrays all = arrays(batches);
  const auto move = [&](const auto& laws) {
    if (batches.node_count == 10)
      move_quadratic(all, laws.data(), first, last, step);
    else
      move_linear(all, laws.data(), first, last, step);
  };
  std::visit(move, batches.laws);
}

void measure_energy(const ElementBatches& batches, const double* positions_m, Batch* energies) {
  const BatchArrays all = arrays(batches);
  const auto measure = [&](const auto& laws) {
    if (batches.node_count == 10)
      measure_quadratic(all, laws.data(), batches.count(), positions_m, energies);
    else
      measure_linear(all, laws.data(), batches.count(), positions_m, energies);
  };
  std::visit(measure, batches.laws);
}

}  // namespace soft_robot_lab
