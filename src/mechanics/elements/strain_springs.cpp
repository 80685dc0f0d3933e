// SPDX-License-Identifier: BSD-3-Clause
#include "strain_springs.h"

#include <cmath>

namespace soft_robot_lab {
namespace {

constexpr int kComponents = 6;
constexpr int kFirst[kComponents] = {0, 1, 2, 0, 0, 1}, kSecond[kComponents] = {0, 1, 2, 1, 2, 2};

// Plain pointers, so that every copy of the code stays self-contained.
struct SpringArrays {
  int batches;
  const int *element, *nodes, *slots;
  const Batch *gradients, *weights, *mu_ratio;
};

template <int Nodes, int Points>
inline SpringArrays one_batch(const SpringArrays& all, int batch) {
  const auto place = static_cast<std::ptrdiff_t>(batch);
  return {1,
          all.element + place * kLanes,
          all.nodes + place * Nodes * kLanes,
          all.slots + place * (Nodes * (Nodes + 1) / 2) * kLanes,
          all.gradients + place * Points * Nodes * 3,
          all.weights + place * Points,
          all.mu_ratio + place};
}

inline void strain_of(const BatchMatrix& f, Batch* strain) {
  for (int c = 0; c < kComponents; ++c) {
    const int i = kFirst[c], j = kSecond[c];
    strain[c] = 0.5 * (f.m[0][i] * f.m[0][j] + f.m[1][i] * f.m[1][j] + f.m[2][i] * f.m[2][j] - (i == j ? 1.0 : 0.0));
  }
}

// E - E* as a matrix.
inline BatchMatrix stretch_of(const BatchMatrix& f, const Batch* target) {
  Batch strain[kComponents];
  strain_of(f, strain);
  BatchMatrix stretch;
  for (int c = 0; c < kComponents; ++c)
    stretch.m[kFirst[c]][kSecond[c]] = stretch.m[kSecond[c]][kFirst[c]] = strain[c] - target[c];
  return stretch;
}

template <int Nodes, int Points>
inline void all_strains(const SpringArrays& all, const double* positions, Batch* strains) {
  Batch x[3 * Nodes];
  for (int batch = 0; batch < all.batches; ++batch) {
    const SpringArrays e = one_batch<Nodes, Points>(all, batch);
    gather(positions, e.nodes, Nodes, x);
    for (int q = 0; q < Points; ++q)
      strain_of(deformation_gradient<Nodes>(x, e.gradients + 3 * Nodes * q),
                strains + (static_cast<std::ptrdiff_t>(batch) * Points + q) * kComponents);
  }
}

// dE/dF contracted: kappa F (E - E*).
template <int Nodes, int Points>
inline double all_gradients(const SpringArrays& all, const double* positions, double kappa, const Batch* targets,
                            double* forces) {
  Batch x[3 * Nodes], force[3 * Nodes];
  double energy = 0.0;
  for (int batch = 0; batch < all.batches; ++batch) {
    const SpringArrays e = one_batch<Nodes, Points>(all, batch);
    gather(positions, e.nodes, Nodes, x);
    for (int i = 0; i < 3 * Nodes; ++i) force[i] = splat(0.0);
    Batch sum = splat(0.0);
    for (int q = 0; q < Points; ++q) {
      const Batch* g = e.gradients + 3 * Nodes * q;
      const BatchMatrix f = deformation_gradient<Nodes>(x, g);
      const BatchMatrix d = stretch_of(f, targets + (static_cast<std::ptrdiff_t>(batch) * Points + q) * kComponents);
      const Batch weight = kappa * (*e.mu_ratio * e.weights[q]);
      sum += 0.5 * weight * squared_norm(d);
      for (int a = 0; a < Nodes; ++a) {
        const BatchVector along = multiply(d, g + 3 * a);
        const BatchVector node_force = multiply(f, along.v);
        for (int i = 0; i < 3; ++i) force[3 * a + i] += weight * node_force.v[i];
      }
    }
    scatter_add(force, e.nodes, Nodes, forces);
    for (int lane = 0; lane < kLanes; ++lane) energy += sum[lane];
  }
  return energy;
}

// Block (a, b), with a = F grad a and ab = grad a . grad b:
//   sum_q w kappa { [grad a . (E - E*) grad b] I + 1/2 (ab F F^T + b a^T) }
template <int Nodes, int Points>
inline void all_hessians(const SpringArrays& all, const double* positions, double kappa, const Batch* targets,
                         bool convex, double* values) {
  Batch x[3 * Nodes], along_f[Points][3 * Nodes], along_d[Points][3 * Nodes], weights[Points];
  BatchMatrix b[Points];
  for (int batch = 0; batch < all.batches; ++batch) {
    const SpringArrays e = one_batch<Nodes, Points>(all, batch);
    gather(positions, e.nodes, Nodes, x);
    for (int q = 0; q < Points; ++q) {
      const Batch* g = e.gradients + 3 * Nodes * q;
      const BatchMatrix f = deformation_gradient<Nodes>(x, g);
      BatchMatrix d = stretch_of(f, targets + (static_cast<std::ptrdiff_t>(batch) * Points + q) * kComponents);
      weights[q] = kappa * (*e.mu_ratio * e.weights[q]);
      b[q] = times_transposed(f);
      if (convex) {
        const Batch norm = squared_norm(d);
        Batch shift;
        for (int lane = 0; lane < kLanes; ++lane) shift[lane] = std::sqrt(norm[lane]);
        for (int i = 0; i < 3; ++i) d.m[i][i] += shift;
      }
      for (int a = 0; a < Nodes; ++a) {
        const BatchVector fa = multiply(f, g + 3 * a), da = multiply(d, g + 3 * a);
        for (int i = 0; i < 3; ++i) {
          along_f[q][3 * a + i] = fa.v[i];
          along_d[q][3 * a + i] = da.v[i];
        }
      }
    }
    int pair = 0;
    for (int a = 0; a < Nodes; ++a) {
      for (int c = 0; c <= a; ++c, ++pair) {
        Batch block[9];
        for (Batch& entry : block) entry = splat(0.0);
        for (int q = 0; q < Points; ++q) {
          const Batch *ga = e.gradients + 3 * (Nodes * q + a), *gc = e.gradients + 3 * (Nodes * q + c);
          const Batch *fa = along_f[q] + 3 * a, *fc = along_f[q] + 3 * c, *da = along_d[q] + 3 * a;
          const Batch half = 0.5 * weights[q], both = half * (ga[0] * gc[0] + ga[1] * gc[1] + ga[2] * gc[2]);
          const Batch isotropic = weights[q] * (da[0] * gc[0] + da[1] * gc[1] + da[2] * gc[2]);
          for (int k = 0; k < 3; ++k) {
            for (int i = 0; i < 3; ++i) block[3 * k + i] += both * b[q].m[i][k] + half * fc[i] * fa[k];
            block[4 * k] += isotropic;
          }
        }
        for (int lane = 0; lane < kLanes; ++lane) {
          if (e.element[lane] < 0) continue;
          double* target = values + static_cast<std::ptrdiff_t>(9) * e.slots[pair * kLanes + lane];
          for (int i = 0; i < 9; ++i) target[i] += block[i][lane];
        }
      }
    }
  }
}

SOFT_ROBOT_LAB_CLONES void quadratic_strains(const SpringArrays& e, const double* x, Batch* strains) {
  all_strains<10, 4>(e, x, strains);
}
SOFT_ROBOT_LAB_CLONES void linear_strains(const SpringArrays& e, const double* x, Batch* strains) {
  all_strains<4, 1>(e, x, strains);
}
SOFT_ROBOT_LAB_CLONES double quadratic_gradients(const SpringArrays& e, const double* x, double kappa,
                                                 const Batch* targets, double* forces) {
  return all_gradients<10, 4>(e, x, kappa, targets, forces);
}
SOFT_ROBOT_LAB_CLONES double linear_gradients(const SpringArrays& e, const double* x, double kappa,
                                              const Batch* targets, double* forces) {
  return all_gradients<4, 1>(e, x, kappa, targets, forces);
}
SOFT_ROBOT_LAB_CLONES void quadratic_hessians(const SpringArrays& e, const double* x, double kappa,
                                              const Batch* targets, bool convex, double* values) {
  all_hessians<10, 4>(e, x, kappa, targets, convex, values);
}
SOFT_ROBOT_LAB_CLONES void linear_hessians(const SpringArrays& e, const double* x, double kappa, const Batch* targets,
                                           bool convex, double* values) {
  all_hessians<4, 1>(e, x, kappa, targets, convex, values);
}

SpringArrays arrays(const ElementBatches& batches, const std::vector<int>& slots) {
  return {batches.count(),          batches.element.data(), batches.nodes.data(),   slots.data(),
          batches.gradients.data(), batches.weights.data(), batches.mu_ratio.data()};
}

}  // namespace

Eigen::VectorXd numbers_of(const Strains& strains) {
  Eigen::VectorXd numbers(static_cast<Eigen::Index>(strains.size()) * kLanes);
  for (std::size_t i = 0; i < strains.size(); ++i)
    for (int lane = 0; lane < kLanes; ++lane) numbers[static_cast<Eigen::Index>(i) * kLanes + lane] = strains[i][lane];
  return numbers;
}

Strains strains_of(const Eigen::VectorXd& numbers) {
  Strains result(static_cast<std::size_t>(numbers.size()) / kLanes);
  for (std::size_t i = 0; i < result.size(); ++i)
    for (int lane = 0; lane < kLanes; ++lane) result[i][lane] = numbers[static_cast<Eigen::Index>(i) * kLanes + lane];
  return result;
}

Strains StrainSprings::strains(const Eigen::Matrix3Xd& positions_m) const {
  Strains result(static_cast<std::size_t>(batches_.count()) * batches_.point_count * kComponents);
  (batches_.node_count == 10 ? quadratic_strains : linear_strains)(arrays(batches_, slots_), positions_m.data(),
                                                                   result.data());
  return result;
}

double StrainSprings::add_gradient(const Eigen::Matrix3Xd& positions_m, const StrainTarget& strain_target,
                                   Eigen::Matrix3Xd& forces_n) const {
  return (batches_.node_count == 10 ? quadratic_gradients : linear_gradients)(
      arrays(batches_, slots_), positions_m.data(), strain_target.stiffness_pa, strain_target.target.data(),
      forces_n.data());
}

void StrainSprings::add_hessian(const Eigen::Matrix3Xd& positions_m, const StrainTarget& strain_target, bool convex,
                                BlockMatrix& matrix) const {
  (batches_.node_count == 10 ? quadratic_hessians : linear_hessians)(
      arrays(batches_, slots_), positions_m.data(), strain_target.stiffness_pa, strain_target.target.data(), convex,
      matrix.block(0));
}

}  // namespace soft_robot_lab
