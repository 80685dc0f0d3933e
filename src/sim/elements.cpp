#include "elements.h"

#include <algorithm>
#include <array>
#include <numeric>

#include <Eigen/LU>

#include "shape_functions.h"

// One copy of each kernel for processors with AVX2 and fused multiply-add, one for all others; chosen at start.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define SOFT_ROBOT_LAB_CLONES __attribute__((target_clones("arch=haswell", "default"), flatten))
#else
#define SOFT_ROBOT_LAB_CLONES
#endif

namespace soft_robot_lab {
namespace {

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
inline PackSums pack_gradient(const Pack* x, const Pack* gradients, const Pack* weights, double mu, Pack p, Pack* forces) {
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

// Condensed Hessian blocks of four elements: pairs a >= b in rows, 9 numbers each (column-major). With g = d(V0 Jbar)/dx the block (a, b) is
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
        const Pack cross[3] = {ga[1] * gb[2] - ga[2] * gb[1], ga[2] * gb[0] - ga[0] * gb[2], ga[0] * gb[1] - ga[1] * gb[0]};
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

// The kernels over all packs; plain pointers so that every copy of the code stays self-contained.
struct ElementArrays {
  int packs, count;
  const int *nodes, *slots;
  const Pack *gradients, *weights, *laplacian;
  double mu, lambda;
};

template <int Nodes, int Points>
inline void all_gradients(const ElementArrays& e, const double* positions, const double* multipliers, double* forces,
                          ElementSums* sums) {
  Pack x[3 * Nodes], f[3 * Nodes];
  for (int pack = 0; pack < e.packs; ++pack) {
    const int* nodes = e.nodes + static_cast<std::ptrdiff_t>(pack) * Nodes * kLanes;
    const Pack* weights = e.weights + static_cast<std::ptrdiff_t>(pack) * Points;
    const int lanes = std::min(kLanes, e.count - pack * kLanes);
    Pack p = splat(0.0);
    for (int lane = 0; lane < lanes; ++lane) p[lane] = multipliers[pack * kLanes + lane];
    gather(positions, nodes, Nodes, x);
    const PackSums result = pack_gradient<Nodes, Points>(
        x, e.gradients + static_cast<std::ptrdiff_t>(pack) * Points * Nodes * 3, weights, e.mu, p, f);
    scatter_add(f, nodes, Nodes, forces);
    for (int lane = 0; lane < lanes; ++lane) {
      sums->elastic_energy += result.energy[lane];
      sums->growth[pack * kLanes + lane] = result.mean_determinant[lane] - 1.0;
      if (!(result.smallest_determinant[lane] > 0.0)) ++sums->inverted;
      if (result.smallest_determinant[lane] < sums->smallest_determinant) {
        sums->smallest_determinant = result.smallest_determinant[lane];
        sums->worst_element = pack * kLanes + lane;
      }
    }
  }
}

template <int Nodes, int Points>
inline void all_hessians(const ElementArrays& e, const double* positions, const double* multipliers, bool convex,
                         double* values, Pack* volume_gradients) {
  constexpr int kPairs = Nodes * (Nodes + 1) / 2;
  Pack x[3 * Nodes], blocks[9 * kPairs];
  for (int pack = 0; pack < e.packs; ++pack) {
    const int* nodes = e.nodes + static_cast<std::ptrdiff_t>(pack) * Nodes * kLanes;
    const int* slots = e.slots + static_cast<std::ptrdiff_t>(pack) * kPairs * kLanes;
    const int lanes = std::min(kLanes, e.count - pack * kLanes);
    Pack p = splat(0.0);
    for (int lane = 0; lane < lanes; ++lane) p[lane] = multipliers[pack * kLanes + lane];
    gather(positions, nodes, Nodes, x);
    pack_hessian<Nodes, Points>(x, e.gradients + static_cast<std::ptrdiff_t>(pack) * Points * Nodes * 3,
                                e.weights + static_cast<std::ptrdiff_t>(pack) * Points,
                                e.laplacian + static_cast<std::ptrdiff_t>(pack) * kPairs, e.mu, e.lambda, p, convex, blocks,
                                volume_gradients + static_cast<std::ptrdiff_t>(pack) * 3 * Nodes);
    for (int pair = 0; pair < kPairs; ++pair) {
      for (int lane = 0; lane < lanes; ++lane) {
        double* target = values + static_cast<std::ptrdiff_t>(9) * slots[pair * kLanes + lane];
        for (int i = 0; i < 9; ++i) target[i] += blocks[9 * pair + i][lane];
      }
    }
  }
}

SOFT_ROBOT_LAB_CLONES void quadratic_gradients(const ElementArrays& e, const double* x, const double* p, double* forces,
                                               ElementSums* sums) {
  all_gradients<10, 4>(e, x, p, forces, sums);
}
SOFT_ROBOT_LAB_CLONES void linear_gradients(const ElementArrays& e, const double* x, const double* p, double* forces,
                                            ElementSums* sums) {
  all_gradients<4, 1>(e, x, p, forces, sums);
}
SOFT_ROBOT_LAB_CLONES void quadratic_hessians(const ElementArrays& e, const double* x, const double* p, bool convex,
                                              double* values, Pack* volume_gradients) {
  all_hessians<10, 4>(e, x, p, convex, values, volume_gradients);
}
SOFT_ROBOT_LAB_CLONES void linear_hessians(const ElementArrays& e, const double* x, const double* p, bool convex,
                                           double* values, Pack* volume_gradients) {
  all_hessians<4, 1>(e, x, p, convex, values, volume_gradients);
}

}  // namespace

Elements::Elements(const Body& body, const BlockMatrix& matrix)
    : count_(body.mesh().tet_count()),
      node_count_(static_cast<int>(body.mesh().tets.rows())),
      point_count_(body.mesh().quadratic() ? 4 : 1),
      mu_(body.material().lame_mu_pa()),
      // The multiplier needs some bulk to stand for: at a Poisson's ratio of zero this little, which no one can measure.
      lambda_(std::max(body.material().lame_lambda_pa(), 1e-6 * body.material().lame_mu_pa())) {
  const TetMesh& mesh = body.mesh();
  std::vector<ShapeFunctions> shapes;
  std::vector<double> weights;
  if (mesh.quadratic()) {
    for (const auto& point : tet_quadrature_points()) shapes.push_back(shape_functions(10, point));
    weights.assign(4, 1.0 / 24.0);
  } else {
    shapes.push_back(shape_functions(4, Eigen::Vector3d::Constant(0.25)));
    weights.assign(1, 1.0 / 6.0);
  }

  const int packs = pack_count();
  nodes_.resize(static_cast<std::size_t>(packs) * node_count_ * kLanes);
  slots_.resize(static_cast<std::size_t>(packs) * pair_count() * kLanes);
  gradients_.assign(static_cast<std::size_t>(packs) * point_count_ * node_count_ * 3, splat(0.0));
  weights_.assign(static_cast<std::size_t>(packs) * point_count_, splat(0.0));
  laplacian_.assign(static_cast<std::size_t>(packs) * pair_count(), splat(0.0));
  volume_gradients_.assign(static_cast<std::size_t>(packs) * node_count_ * 3, splat(0.0));
  rest_volumes_ = Eigen::VectorXd::Zero(count_);

  for (int slot = 0; slot < packs * kLanes; ++slot) {
    const int pack = slot / kLanes, lane = slot % kLanes;
    const int element = std::min(slot, count_ - 1);  // the unused lanes repeat the last element, with no weight
    std::vector<int> local(node_count_);
    std::iota(local.begin(), local.end(), 0);
    std::sort(local.begin(), local.end(), [&](int a, int b) {
      return matrix.position(mesh.tets(a, element)) < matrix.position(mesh.tets(b, element));
    });
    int pair = 0;
    for (int a = 0; a < node_count_; ++a) {
      const int node = mesh.tets(local[a], element);
      nodes_[(static_cast<std::size_t>(pack) * node_count_ + a) * kLanes + lane] = node;
      for (int b = 0; b <= a; ++b, ++pair)
        slots_[(static_cast<std::size_t>(pack) * pair_count() + pair) * kLanes + lane] =
            matrix.slot(matrix.position(node), matrix.position(mesh.tets(local[b], element)));
    }
    for (int q = 0; q < point_count_; ++q) {
      Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
      for (int a = 0; a < node_count_; ++a)
        jacobian += mesh.nodes_m.col(mesh.tets(a, element)) * shapes[q].gradients.col(a).transpose();
      const Eigen::Matrix<double, 3, Eigen::Dynamic> rest = jacobian.inverse().transpose() * shapes[q].gradients;
      const double weight = slot < count_ ? jacobian.determinant() * weights[q] : 0.0;
      weights_[static_cast<std::size_t>(pack) * point_count_ + q][lane] = weight;
      if (slot < count_) rest_volumes_[element] += weight;
      int p = 0;
      for (int a = 0; a < node_count_; ++a) {
        for (int i = 0; i < 3; ++i)
          gradients_[((static_cast<std::size_t>(pack) * point_count_ + q) * node_count_ + a) * 3 + i][lane] =
              rest(i, local[a]);
        for (int b = 0; b <= a; ++b, ++p)
          laplacian_[static_cast<std::size_t>(pack) * pair_count() + p][lane] +=
              mu_ * weight * rest.col(local[a]).dot(rest.col(local[b]));
      }
    }
  }
}

ElementSums Elements::add_gradient(const Eigen::Matrix3Xd& positions, const Eigen::VectorXd& multipliers,
                                   Eigen::Matrix3Xd& forces) const {
  const ElementArrays arrays{pack_count(), count_, nodes_.data(), slots_.data(), gradients_.data(), weights_.data(),
                             laplacian_.data(), mu_, lambda_};
  ElementSums sums;
  sums.growth.resize(count_);
  (node_count_ == 10 ? quadratic_gradients : linear_gradients)(arrays, positions.data(), multipliers.data(), forces.data(),
                                                               &sums);
  return sums;
}

void Elements::add_hessian(const Eigen::Matrix3Xd& positions, const Eigen::VectorXd& multipliers, bool convex,
                           BlockMatrix& matrix) {
  const ElementArrays arrays{pack_count(), count_, nodes_.data(), slots_.data(), gradients_.data(), weights_.data(),
                             laplacian_.data(), mu_, lambda_};
  (node_count_ == 10 ? quadratic_hessians : linear_hessians)(arrays, positions.data(), multipliers.data(), convex,
                                                             matrix.block(0), volume_gradients_.data());
}

void Elements::add_mismatch_forces(const Eigen::VectorXd& mismatch, Eigen::Matrix3Xd& forces) const {
  for (int element = 0; element < count_; ++element) {
    const int pack = element / kLanes, lane = element % kLanes;
    const double pressure = lambda_ * mismatch[element];
    for (int a = 0; a < node_count_; ++a) {
      const std::size_t place = static_cast<std::size_t>(pack) * node_count_ + a;
      const int node = nodes_[place * kLanes + lane];
      for (int i = 0; i < 3; ++i) forces(i, node) += pressure * volume_gradients_[place * 3 + i][lane];
    }
  }
}

Eigen::VectorXd Elements::updated_multipliers(const Eigen::VectorXd& growth, const Eigen::Matrix3Xd& step) const {
  Eigen::VectorXd result(count_);
  for (int element = 0; element < count_; ++element) {
    const int pack = element / kLanes, lane = element % kLanes;
    double change = 0.0;
    for (int a = 0; a < node_count_; ++a) {
      const std::size_t place = static_cast<std::size_t>(pack) * node_count_ + a;
      const int node = nodes_[place * kLanes + lane];
      for (int i = 0; i < 3; ++i) change += volume_gradients_[place * 3 + i][lane] * step(i, node);
    }
    result[element] = lambda_ * (growth[element] + change / rest_volumes_[element]);
  }
  return result;
}

}  // namespace soft_robot_lab
