#include "element_step.h"

#include "mechanics/linear_algebra/pack_ldlt.h"
#include "mechanics/material/rivlin_kernels.h"

namespace soft_robot_lab {
namespace {

constexpr double kSmallestPivot = 0.1;  // of I + h^2 M^-1/2 K M^-1/2, which is above 1 where K is positive

// Plain pointers, so that every copy of the code stays self-contained.
struct PackArrays {
  const int *element, *nodes;
  const Pack *gradients, *weights, *laplacian;
};

template <int Nodes, int Points>
inline PackArrays arrays_of(const PackArrays& all, int pack) {
  const auto place = static_cast<std::ptrdiff_t>(pack);
  return {all.element + place * kLanes, all.nodes + place * Nodes * kLanes, all.gradients + place * Points * Nodes * 3,
          all.weights + place * Points, all.laplacian + place * Nodes * (Nodes + 1) / 2};
}

// Unused lanes stay put: their element is in another lane or pack too.
inline void scatter_used(const Pack* in, const PackArrays& e, int node_count, double* out) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if (e.element[lane] < 0) continue;
    for (int a = 0; a < node_count; ++a)
      for (int i = 0; i < 3; ++i) out[3 * e.nodes[a * kLanes + lane] + i] += in[3 * a + i][lane];
  }
}

// S = I + h^2 M^-1/2 K M^-1/2, lower triangle by columns, from the blocks of K.
template <int Nodes>
inline void scale_hessian(const Pack* blocks, const Pack* s, double h, Pack* matrix) {
  constexpr int kSize = 3 * Nodes;
  int pair = 0;
  for (int a = 0; a < Nodes; ++a) {
    for (int b = 0; b <= a; ++b, ++pair) {
      for (int k = 0; k < 3; ++k) {
        const Pack scale = h * h * s[3 * b + k];
        Pack* column = matrix + column_start(kSize, 3 * b + k);
        for (int i = a == b ? k : 0; i < 3; ++i)
          column[3 * a + i] = scale * s[3 * a + i] * blocks[9 * pair + 3 * k + i];
      }
    }
  }
  for (int i = 0; i < kSize; ++i) matrix[column_start(kSize, i) + i] += 1.0;
}

template <int Nodes, int Points, class Law>
inline void move_packs(const PackArrays& all, const Law& law, int first, int last, const ElementStep& step) {
  constexpr int kSize = 3 * Nodes;
  Pack x[kSize], s[kSize], gradient[kSize], volume_gradient[kSize], motion[kSize];
  Pack blocks[9 * Nodes * (Nodes + 1) / 2], matrix[triangle_size(kSize)];
  const double h = step.time_step_s;
  for (int pack = first; pack < last; ++pack) {
    const PackArrays e = arrays_of<Nodes, Points>(all, pack);
    Pack* multipliers = step.multipliers + static_cast<std::ptrdiff_t>(pack) * kSize;
    gather(step.positions_m, e.nodes, Nodes, x);
    gather(step.root_inverse_masses, e.nodes, Nodes, s);
    Pack p = splat(0.0);
    for (int lane = 0; lane < kLanes; ++lane)
      if (e.element[lane] >= 0) p[lane] = step.volume_multipliers_pa[e.element[lane]];

    const PackSums sums = pack_gradient<Nodes, Points>(x, e.gradients, e.weights, law, splat(0.0), gradient);
    const Pack pressure = step.lambda_pa * (sums.mean_determinant - 1.0);
    for (const bool convex : {false, true}) {
      pack_hessian<Nodes, Points>(x, e.gradients, e.weights, e.laplacian, law, step.lambda_pa, p, convex, blocks,
                                  volume_gradient);
      scale_hessian<Nodes>(blocks, s, h, matrix);
      const Pack pivot = factorise_ldlt<kSize>(matrix);
      bool positive = true;
      for (int lane = 0; lane < kLanes; ++lane) positive = positive && pivot[lane] > kSmallestPivot;
      if (positive) break;
    }

    for (int i = 0; i < kSize; ++i)
      motion[i] = -h * h * s[i] * (gradient[i] + pressure * volume_gradient[i]) - multipliers[i];
    solve_ldlt<kSize>(matrix, motion);
    Pack volume = splat(0.0), volumetric_strain = splat(0.0);
    for (int q = 0; q < Points; ++q) volume += e.weights[q];
    for (int i = 0; i < kSize; ++i) {
      multipliers[i] += motion[i];
      motion[i] *= s[i];
      volumetric_strain += volume_gradient[i] * motion[i];
    }
    scatter_used(motion, e, Nodes, step.positions_m);
    for (int lane = 0; lane < kLanes; ++lane)
      if (e.element[lane] >= 0)
        step.volume_multipliers_pa[e.element[lane]] = pressure[lane] + step.lambda_pa * volumetric_strain[lane] / volume[lane];
  }
}

template <int Nodes, int Points, class Law>
inline void measure_packs(const PackArrays& all, const Law& law, int count, double lambda, const double* positions,
                          Pack* energies) {
  Pack x[3 * Nodes], unused[3 * Nodes];
  for (int pack = 0; pack < count; ++pack) {
    const PackArrays e = arrays_of<Nodes, Points>(all, pack);
    gather(positions, e.nodes, Nodes, x);
    const PackSums sums = pack_gradient<Nodes, Points>(x, e.gradients, e.weights, law, splat(0.0), unused);
    Pack volume = splat(0.0);
    for (int q = 0; q < Points; ++q) volume += e.weights[q];
    const Pack volumetric_strain = sums.mean_determinant - 1.0;
    energies[pack] = sums.energy + 0.5 * lambda * volume * volumetric_strain * volumetric_strain;
  }
}

SOFT_ROBOT_LAB_CLONES void move_quadratic(const PackArrays& all, const NeoHookean& law, int first, int last,
                                          const ElementStep& step) {
  move_packs<10, 4>(all, law, first, last, step);
}
SOFT_ROBOT_LAB_CLONES void measure_quadratic(const PackArrays& all, const NeoHookean& law, int count, double lambda,
                                             const double* positions, Pack* energies) {
  measure_packs<10, 4>(all, law, count, lambda, positions, energies);
}
SOFT_ROBOT_LAB_CLONES void move_linear(const PackArrays& all, const NeoHookean& law, int first, int last,
                                       const ElementStep& step) {
  move_packs<4, 1>(all, law, first, last, step);
}
SOFT_ROBOT_LAB_CLONES void measure_linear(const PackArrays& all, const NeoHookean& law, int count, double lambda,
                                          const double* positions, Pack* energies) {
  measure_packs<4, 1>(all, law, count, lambda, positions, energies);
}
SOFT_ROBOT_LAB_CLONES void move_quadratic(const PackArrays& all, const Rivlin& law, int first, int last,
                                          const ElementStep& step) {
  move_packs<10, 4>(all, law, first, last, step);
}
SOFT_ROBOT_LAB_CLONES void measure_quadratic(const PackArrays& all, const Rivlin& law, int count, double lambda,
                                             const double* positions, Pack* energies) {
  measure_packs<10, 4>(all, law, count, lambda, positions, energies);
}
SOFT_ROBOT_LAB_CLONES void move_linear(const PackArrays& all, const Rivlin& law, int first, int last,
                                       const ElementStep& step) {
  move_packs<4, 1>(all, law, first, last, step);
}
SOFT_ROBOT_LAB_CLONES void measure_linear(const PackArrays& all, const Rivlin& law, int count, double lambda,
                                          const double* positions, Pack* energies) {
  measure_packs<4, 1>(all, law, count, lambda, positions, energies);
}

PackArrays arrays(const ElementPacks& packs) {
  return {packs.element.data(), packs.nodes.data(), packs.gradients.data(), packs.weights.data(),
          packs.laplacian.data()};
}

}  // namespace

void move_elements(const ElementPacks& packs, int first, int last, const ElementStep& step) {
  const PackArrays all = arrays(packs);
  const auto move = [&](const auto& law) {
    if (packs.node_count == 10)
      move_quadratic(all, law, first, last, step);
    else
      move_linear(all, law, first, last, step);
  };
  std::visit(move, step.law);
}

void measure_energy(const ElementPacks& packs, const MaterialLaw& law, double lambda_pa, const double* positions_m,
                    Pack* energies) {
  const PackArrays all = arrays(packs);
  const auto measure = [&](const auto& chosen) {
    if (packs.node_count == 10)
      measure_quadratic(all, chosen, packs.count(), lambda_pa, positions_m, energies);
    else
      measure_linear(all, chosen, packs.count(), lambda_pa, positions_m, energies);
  };
  std::visit(measure, law);
}

}  // namespace soft_robot_lab
