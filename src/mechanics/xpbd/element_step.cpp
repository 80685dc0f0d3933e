// SPDX-License-Identifier: BSD-3-Clause
#include "element_step.h"

#include <algorithm>
#include <cstring>

#include "mechanics/linear_algebra/batch_inverse.h"
#include "mechanics/elements/rivlin_kernels.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

constexpr double kSmallestPivot = 0.1;  // of I + h^2 M^-1/2 K M^-1/2, which is above 1 where K is positive

// Plain pointers, so that every copy of the code stays self-contained.
struct BatchArrays {
  const int *element, *nodes;
  const Batch *gradients, *weights, *laplacian, *lambda_pa, *mu_pa;
};

template <int Nodes, int Points>
inline BatchArrays arrays_of(const BatchArrays& all, int batch) {
  const auto place = static_cast<std::ptrdiff_t>(batch);
  return {all.element + place * kLanes,
          all.nodes + place * Nodes * kLanes,
          all.gradients + place * Points * Nodes * 3,
          all.weights + place * Points,
          all.laplacian + place * Nodes * (Nodes + 1) / 2,
          all.lambda_pa + place,
          all.mu_pa + place};
}

// One batch's share of ElementSolves.
struct SolveArrays {
  Batch *positions_m, *multipliers_pa, *inverse, *answer, *unstrained;
  const Batch* held;
  char *known, *fresh;
};

template <int Nodes>
inline SolveArrays solves_of(ElementSolves& solves, int batch) {
  const auto place = static_cast<std::ptrdiff_t>(batch);
  return {solves.made.positions_m.data() + place * 3 * Nodes,
          solves.made.multipliers_pa.data() + place,
          solves.inverses.data() + place * 9 * Nodes * (Nodes + 1) / 2,
          solves.answers.data() + place * 3 * Nodes,
          solves.unstrained.data() + place * 9,
          solves.held.data() + place,
          solves.known.data() + place,
          solves.fresh.data() + place};
}

// Unused lanes stay put: their element is in another lane or batch too.
inline void scatter_used(const Batch* in, const BatchArrays& e, int node_count, double* out) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if (e.element[lane] < 0) continue;
    for (int a = 0; a < node_count; ++a)
      for (int i = 0; i < 3; ++i) out[3 * e.nodes[a * kLanes + lane] + i] += in[3 * a + i][lane];
  }
}

// S_0 = I + h^2 M^-1/2 K M^-1/2, lower triangle by columns, from the blocks of K.
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

template <int Nodes>
inline void keep_inverse(const Batch* negated, Batch* blocks) {
  constexpr int kSize = 3 * Nodes;
  int pair = 0;
  for (int a = 0; a < Nodes; ++a)
    for (int b = 0; b <= a; ++b, ++pair)
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) {
          const int row = 3 * a + i, column = 3 * b + k;
          blocks[9 * pair + 3 * k + i] =
              -negated[row < column ? column_start(kSize, row) + column : column_start(kSize, column) + row];
        }
}

// y = A x, from A's blocks a >= b.
template <int Nodes>
inline void multiply_symmetric(const Batch* blocks, const Batch* x, Batch* y) {
  for (int i = 0; i < 3 * Nodes; ++i) y[i] = splat(0.0);
  int pair = 0;
  for (int a = 0; a < Nodes; ++a) {
    Batch sum[3] = {splat(0.0), splat(0.0), splat(0.0)};
    for (int b = 0; b < a; ++b, ++pair) {
      const Batch* block = blocks + 9 * pair;
      for (int k = 0; k < 3; ++k) {
        Batch across = y[3 * b + k];
        for (int i = 0; i < 3; ++i) {
          sum[i] += block[3 * k + i] * x[3 * b + k];
          across += block[3 * k + i] * x[3 * a + i];
        }
        y[3 * b + k] = across;
      }
    }
    const Batch* block = blocks + 9 * pair++;
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) sum[i] += block[3 * k + i] * x[3 * a + k];
    for (int i = 0; i < 3; ++i) y[3 * a + i] = sum[i];
  }
}

inline BatchMatrix identity() {
  BatchMatrix one;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) one.m[i][j] = splat(i == j ? 1.0 : 0.0);
  return one;
}

inline BatchMatrix product(const BatchMatrix& a, const Batch* b) {
  BatchMatrix c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) c.m[i][j] = a.m[i][0] * b[j] + a.m[i][1] * b[3 + j] + a.m[i][2] * b[6 + j];
  return c;
}

// A^T A - I
inline BatchMatrix strain_of(const BatchMatrix& a) {
  BatchMatrix c = identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      c.m[i][j] = a.m[0][i] * a.m[0][j] + a.m[1][i] * a.m[1][j] + a.m[2][i] * a.m[2][j] - c.m[i][j];
  return c;
}

// The rotation nearest to A, which is near one: two steps of Newton and Schulz.
inline BatchMatrix nearest_rotation(const BatchMatrix& a) {
  BatchMatrix r = a;
  for (int step = 0; step < 2; ++step) {
    const BatchMatrix strain = strain_of(r);
    BatchMatrix next;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        next.m[i][j] =
            r.m[i][j] - 0.5 * (r.m[i][0] * strain.m[0][j] + r.m[i][1] * strain.m[1][j] + r.m[i][2] * strain.m[2][j]);
    r = next;
  }
  return r;
}

template <int Nodes>
inline void turn(const BatchMatrix& r, Batch* vectors) {
  for (int a = 0; a < Nodes; ++a) {
    const BatchVector turned = multiply(r, vectors + 3 * a);
    for (int i = 0; i < 3; ++i) vectors[3 * a + i] = turned.v[i];
  }
}

inline BatchMatrix transposed(const BatchMatrix& a) {
  BatchMatrix t;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) t.m[i][j] = a.m[j][i];
  return t;
}

template <int Points>
inline Batch volume_of(const BatchArrays& e) {
  Batch volume = splat(0.0);
  for (int q = 0; q < Points; ++q) volume += e.weights[q];
  return volume > 0.0 ? volume : splat(1.0);
}

// Mean F.
template <int Nodes, int Points>
inline BatchMatrix mean_gradient(const BatchArrays& e, const Batch* x) {
  const Batch share = 1.0 / volume_of<Points>(e);
  Batch gradients[3 * Nodes];
  for (int i = 0; i < 3 * Nodes; ++i) {
    gradients[i] = splat(0.0);
    for (int q = 0; q < Points; ++q) gradients[i] += share * e.weights[q] * e.gradients[3 * Nodes * q + i];
  }
  return deformation_gradient<Nodes>(x, gradients);
}

// What a shape says, in one pass.
template <int Nodes>
struct Shape {
  Batch gradient[3 * Nodes];         // of the energy, with the pressure
  Batch volume_gradient[3 * Nodes];  // g
  BatchMatrix mean;                  // F
  Batch volumetric_strain;           // Jbar - 1
  Batch volume_before;               // the same where the substep began; 0 without dashpots
};

// Stress against the change of the strain since the substep began, 2 mu b / h F (E - E0).
template <int Nodes>
inline void add_dashpot(const BatchMatrix& f, const Batch* start, const Batch* g, Batch stiffness,
                        BatchMatrix& stress) {
  const BatchMatrix here = strain_of(f), before = strain_of(deformation_gradient<Nodes>(start, g));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) stress.m[i][j] += 0.5 * stiffness * f.m[i][k] * (here.m[k][j] - before.m[k][j]);
}

// `start`: null without dashpots, of which the stiffness is.
template <int Nodes, int Points, class Law>
inline void find_shape(const BatchArrays& e, const Law& law, const Batch* x, Batch p, const Batch* start,
                       Batch stiffness, Shape<Nodes>& shape) {
  const Batch share = 1.0 / volume_of<Points>(e);
  for (int i = 0; i < 3 * Nodes; ++i) shape.gradient[i] = shape.volume_gradient[i] = splat(0.0);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) shape.mean.m[i][k] = splat(0.0);
  shape.volumetric_strain = splat(-1.0);
  shape.volume_before = splat(start ? -1.0 : 0.0);
  for (int q = 0; q < Points; ++q) {
    const Batch* g = e.gradients + 3 * Nodes * q;
    const BatchMatrix f = deformation_gradient<Nodes>(x, g), c = cofactor(f);
    const Batch j = determinant(f, c), w = e.weights[q];
    const BatchStress point = stress_of(law, f, c, j);
    shape.volumetric_strain += share * w * j;
    BatchMatrix stress, volume_stress;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        shape.mean.m[i][k] += share * w * f.m[i][k];
        volume_stress.m[i][k] = w * c.m[i][k];
        stress.m[i][k] = w * point.along_f * f.m[i][k] + (point.along_cofactor + p) * volume_stress.m[i][k];
      }
    add_rest_of_stress(law, f, w, stress);
    if (start) {
      add_dashpot<Nodes>(f, start, g, w * stiffness, stress);
      const BatchMatrix before = deformation_gradient<Nodes>(start, g);
      shape.volume_before += share * w * determinant(before, cofactor(before));
    }
    for (int a = 0; a < Nodes; ++a) {
      const BatchVector force = multiply(stress, g + 3 * a), along = multiply(volume_stress, g + 3 * a);
      for (int i = 0; i < 3; ++i) {
        shape.gradient[3 * a + i] += force.v[i];
        shape.volume_gradient[3 * a + i] += along.v[i];
      }
    }
  }
}

// The convex part of their Hessian, w kappa / 2 (grad a . grad b F F^T + b a^T) with a = F grad a.
template <int Nodes, int Points>
inline void add_dashpots(const BatchArrays& e, const Batch* x, Batch stiffness, Batch* blocks) {
  for (int q = 0; q < Points; ++q) {
    const Batch* g = e.gradients + 3 * Nodes * q;
    const BatchMatrix f = deformation_gradient<Nodes>(x, g), b = times_transposed(f);
    const Batch half = 0.5 * stiffness * e.weights[q];
    BatchVector along[Nodes];
    for (int a = 0; a < Nodes; ++a) along[a] = multiply(f, g + 3 * a);
    int pair = 0;
    for (int a = 0; a < Nodes; ++a)
      for (int c = 0; c <= a; ++c, ++pair) {
        const Batch *ga = g + 3 * a, *gc = g + 3 * c;
        const Batch both = half * (ga[0] * gc[0] + ga[1] * gc[1] + ga[2] * gc[2]);
        for (int k = 0; k < 3; ++k)
          for (int i = 0; i < 3; ++i)
            blocks[9 * pair + 3 * k + i] += both * b.m[i][k] + half * along[c].v[i] * along[a].v[k];
      }
  }
}

template <int Nodes, int Points, class Law>
inline void make_solve(const BatchArrays& e, const Law& law, const Batch* s, double h, Batch dashpots,
                       bool any_dashpots, const SolveArrays& kept) {
  constexpr int kSize = 3 * Nodes;
  Batch blocks[9 * Nodes * (Nodes + 1) / 2], matrix[triangle_size(kSize)], volume_gradient[kSize];
  for (const bool convex : {false, true}) {
    batch_hessian<Nodes, Points>(kept.positions_m, e.gradients, e.weights, e.laplacian, law, splat(0.0),
                                 *kept.multipliers_pa, convex, blocks, volume_gradient);
    if (any_dashpots) add_dashpots<Nodes, Points>(e, kept.positions_m, dashpots, blocks);
    scale_hessian<Nodes>(blocks, s, h, matrix);
    const Batch pivot = invert_negated<kSize>(matrix);
    bool positive = true;
    for (int lane = 0; lane < kLanes; ++lane) positive = positive && pivot[lane] > kSmallestPivot;
    if (positive) break;
  }
  keep_inverse<Nodes>(matrix, kept.inverse);
  for (int i = 0; i < kSize; ++i) volume_gradient[i] *= s[i];
  multiply_symmetric<Nodes>(kept.inverse, volume_gradient, kept.answer);
  const BatchMatrix mean = mean_gradient<Nodes, Points>(e, kept.positions_m), c = cofactor(mean);
  const Batch j = determinant(mean, c), share = 1.0 / (j != 0.0 ? j : splat(1.0));
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) kept.unstrained[3 * i + k] = share * c.m[k][i];
}

// Whether what is kept no longer serves; unused lanes have no say.
inline bool is_stale(const BatchArrays& e, const BatchMatrix& since, Batch p, const SolveArrays& kept) {
  const BatchMatrix strain = strain_of(since), one = identity();
  for (int lane = 0; lane < kLanes; ++lane) {
    if (e.element[lane] < 0) continue;
    double worst = 0.0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double off =
            (*kept.held)[lane] > 0.0 ? 2.0 * (since.m[i][j][lane] - one.m[i][j][lane]) : strain.m[i][j][lane];
        worst = std::max(worst, off < 0.0 ? -off : off);
        if (!(off == off)) return true;
      }
    const double risen = p[lane] - (*kept.multipliers_pa)[lane];
    if (worst > constants::kStaleStrain ||
        (risen < 0.0 ? -risen : risen) > constants::kStalePressure * (*e.mu_pa)[lane])
      return true;
  }
  return false;
}

// How the elements have turned since their matrices were made, which are made again where they no longer serve.
template <int Nodes, int Points, class Law>
inline BatchMatrix turn_of(const BatchArrays& e, const Law& law, const Batch* x, const BatchMatrix& mean,
                           const Batch* s, Batch p, const ElementStep& step, const SolveArrays& kept) {
  BatchMatrix since = identity();
  for (bool again = false;;) {
    if (*kept.known == ElementSolves::kNone) {
      for (int i = 0; i < 3 * Nodes; ++i) kept.positions_m[i] = x[i];
      *kept.multipliers_pa = p;
      *kept.fresh = 1;
      again = true;
    }
    if (*kept.known != ElementSolves::kMade)
      make_solve<Nodes, Points>(e, law, s, step.time_step_s, 2.0 * step.dashpot * *e.mu_pa, step.start_m != nullptr,
                                kept);
    *kept.known = ElementSolves::kMade;
    if (again) return identity();
    since = product(mean, kept.unstrained);
    if (!is_stale(e, since, p, kept)) break;
    *kept.known = ElementSolves::kNone;
  }
  const BatchMatrix rotation = nearest_rotation(since);
  BatchMatrix turned = identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) turned.m[i][j] = *kept.held > 0.0 ? turned.m[i][j] : rotation.m[i][j];
  return turned;
}

template <int Nodes, int Points, class Law>
inline void move_batches(const BatchArrays& all, const Law* laws, int first, int last, const ElementStep& step,
                         ElementSolves& solves) {
  constexpr int kSize = 3 * Nodes;
  Batch x[kSize], s[kSize], load[kSize], motion[kSize], answer[kSize], start[kSize];
  Shape<Nodes> shape;
  const double h = step.time_step_s;
  for (int batch = first; batch < last; ++batch) {
    const BatchArrays e = arrays_of<Nodes, Points>(all, batch);
    const SolveArrays kept = solves_of<Nodes>(solves, batch);
    const Law& law = laws[batch];
    Batch* multipliers = step.multipliers + static_cast<std::ptrdiff_t>(batch) * kSize;
    gather(step.positions_m, e.nodes, Nodes, x);
    gather(step.root_inverse_masses, e.nodes, Nodes, s);
    Batch p = splat(0.0);
    for (int lane = 0; lane < kLanes; ++lane)
      if (e.element[lane] >= 0) p[lane] = step.volume_multipliers_pa[e.element[lane]];
    if (step.start_m) gather(step.start_m, e.nodes, Nodes, start);
    find_shape<Nodes, Points>(e, law, x, p, step.start_m ? start : nullptr, 2.0 * step.dashpot * *e.mu_pa, shape);
    const BatchMatrix turned = turn_of<Nodes, Points>(e, law, x, shape.mean, s, p, step, kept);
    for (int i = 0; i < kSize; ++i) {
      load[i] = -h * h * s[i] * shape.gradient[i] - multipliers[i];
      answer[i] = kept.answer[i];
    }
    turn<Nodes>(transposed(turned), load);
    multiply_symmetric<Nodes>(kept.inverse, load, motion);
    turn<Nodes>(turned, motion);
    turn<Nodes>(turned, answer);
    // The pressure's change dp, which follows from p + dp = lambda (Jbar - 1 + g.dx / V), with dashpots of b / h from
    // p + dp = lambda (1 + b / h) (Jbar - 1 - b / (h + b) (Jbar_0 - 1) + g.dx / V).
    Batch by_forces = splat(0.0), by_pressure = splat(0.0);
    for (int i = 0; i < kSize; ++i) {
      by_forces += s[i] * shape.volume_gradient[i] * motion[i];
      by_pressure += s[i] * shape.volume_gradient[i] * answer[i];
    }
    const Batch lambda_pa = (1.0 + step.dashpot) * *e.lambda_pa, stiffness = lambda_pa / volume_of<Points>(e);
    const Batch strain = shape.volumetric_strain - step.dashpot / (1.0 + step.dashpot) * shape.volume_before;
    const Batch rise = (lambda_pa * strain - p + stiffness * by_forces) / (1.0 + h * h * stiffness * by_pressure);
    for (int i = 0; i < kSize; ++i) {
      motion[i] -= h * h * rise * answer[i];
      multipliers[i] += motion[i];
      motion[i] *= s[i];
    }
    scatter_used(motion, e, Nodes, step.positions_m);
    for (int lane = 0; lane < kLanes; ++lane)
      if (e.element[lane] >= 0) step.volume_multipliers_pa[e.element[lane]] = p[lane] + rise[lane];
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
                                          const ElementStep& step, ElementSolves& solves) {
  move_batches<10, 4>(all, laws, first, last, step, solves);
}
SOFT_ROBOT_LAB_CLONES void measure_quadratic(const BatchArrays& all, const NeoHookean* laws, int count,
                                             const double* positions, Batch* energies) {
  measure_batches<10, 4>(all, laws, count, positions, energies);
}
SOFT_ROBOT_LAB_CLONES void move_linear(const BatchArrays& all, const NeoHookean* laws, int first, int last,
                                       const ElementStep& step, ElementSolves& solves) {
  move_batches<4, 1>(all, laws, first, last, step, solves);
}
SOFT_ROBOT_LAB_CLONES void measure_linear(const BatchArrays& all, const NeoHookean* laws, int count,
                                          const double* positions, Batch* energies) {
  measure_batches<4, 1>(all, laws, count, positions, energies);
}
SOFT_ROBOT_LAB_CLONES void move_quadratic(const BatchArrays& all, const Rivlin* laws, int first, int last,
                                          const ElementStep& step, ElementSolves& solves) {
  move_batches<10, 4>(all, laws, first, last, step, solves);
}
SOFT_ROBOT_LAB_CLONES void measure_quadratic(const BatchArrays& all, const Rivlin* laws, int count,
                                             const double* positions, Batch* energies) {
  measure_batches<10, 4>(all, laws, count, positions, energies);
}
SOFT_ROBOT_LAB_CLONES void move_linear(const BatchArrays& all, const Rivlin* laws, int first, int last,
                                       const ElementStep& step, ElementSolves& solves) {
  move_batches<4, 1>(all, laws, first, last, step, solves);
}
SOFT_ROBOT_LAB_CLONES void measure_linear(const BatchArrays& all, const Rivlin* laws, int count,
                                          const double* positions, Batch* energies) {
  measure_batches<4, 1>(all, laws, count, positions, energies);
}

BatchArrays arrays(const ElementBatches& batches) {
  return {batches.element.data(),   batches.nodes.data(),     batches.gradients.data(), batches.weights.data(),
          batches.laplacian.data(), batches.lambda_pa.data(), batches.mu_pa.data()};
}

}  // namespace

ElementSolves::ElementSolves(const ElementBatches& batches, const double* root_inverse_masses)
    : known(static_cast<std::size_t>(batches.count()), 0),
      fresh(known),
      held(known.size(), splat(0.0)),
      inverses(known.size() * static_cast<std::size_t>(9 * batches.pair_count()), splat(0.0)),
      answers(known.size() * static_cast<std::size_t>(3 * batches.node_count), splat(0.0)),
      unstrained(known.size() * 9, splat(0.0)) {
  made.positions_m.assign(answers.size(), splat(0.0));
  made.multipliers_pa.assign(known.size(), splat(0.0));
  for (std::size_t i = 0; i < batches.nodes.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (root_inverse_masses[3 * batches.nodes[i] + axis] == 0.0)
        held[i / kLanes / static_cast<std::size_t>(batches.node_count)][i % kLanes] = 1.0;
}

void move_elements(const ElementBatches& batches, int first, int last, const ElementStep& step, ElementSolves& solves) {
  const BatchArrays all = arrays(batches);
  const auto move = [&](const auto& laws) {
    if (batches.node_count == 10)
      move_quadratic(all, laws.data(), first, last, step, solves);
    else
      move_linear(all, laws.data(), first, last, step, solves);
  };
  std::visit(move, batches.laws);
}

void ElementSolves::restore(const KeptSolves& kept) {
  if (known.empty()) return;
  const std::size_t size = made.positions_m.size() / known.size();
  for (std::size_t batch = 0; batch < known.size(); ++batch) {
    const std::size_t place = batch * size;
    const bool same = std::memcmp(&made.positions_m[place], &kept.positions_m[place], size * sizeof(Batch)) == 0 &&
                      std::memcmp(&made.multipliers_pa[batch], &kept.multipliers_pa[batch], sizeof(Batch)) == 0;
    if (known[batch] != kMade || !same) known[batch] = kAsked;
  }
  made = kept;
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
