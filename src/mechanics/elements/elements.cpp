// SPDX-License-Identifier: BSD-3-Clause
#include "elements.h"

#include <algorithm>
#include <numeric>

#include "rivlin_kernels.h"

namespace soft_robot_lab {
namespace {

// The kernels over all batches; plain pointers so that every copy of the code stays self-contained.
struct ElementArrays {
  int batches, count;
  const int *nodes, *slots;
  const Batch *gradients, *weights, *laplacian, *lambdas;
};

template <int Nodes, int Points, class Law>
inline void all_gradients(const ElementArrays& e, const Law* laws, const double* positions, const double* multipliers,
                          double* forces, ElementSums* sums) {
  Batch x[3 * Nodes], f[3 * Nodes];
  for (int batch = 0; batch < e.batches; ++batch) {
    const int* nodes = e.nodes + static_cast<std::ptrdiff_t>(batch) * Nodes * kLanes;
    const Batch* weights = e.weights + static_cast<std::ptrdiff_t>(batch) * Points;
    const int lanes = std::min(kLanes, e.count - batch * kLanes);
    Batch p = splat(0.0);
    for (int lane = 0; lane < lanes; ++lane) p[lane] = multipliers[batch * kLanes + lane];
    gather(positions, nodes, Nodes, x);
    const BatchSums result = batch_gradient<Nodes, Points>(
        x, e.gradients + static_cast<std::ptrdiff_t>(batch) * Points * Nodes * 3, weights, laws[batch], p, f);
    scatter_add(f, nodes, Nodes, forces);
    for (int lane = 0; lane < lanes; ++lane) {
      sums->elastic_energy += result.energy[lane];
      sums->volumetric_strain[batch * kLanes + lane] = result.mean_determinant[lane] - 1.0;
      if (!(result.smallest_determinant[lane] > 0.0)) ++sums->inverted;
      if (result.smallest_determinant[lane] < sums->smallest_determinant) {
        sums->smallest_determinant = result.smallest_determinant[lane];
        sums->worst_element = batch * kLanes + lane;
      }
    }
  }
}

template <int Nodes, int Points, class Law>
inline void all_hessians(const ElementArrays& e, const Law* laws, const double* positions, const double* multipliers,
                         bool convex, double* values, Batch* volume_gradients) {
  constexpr int kPairs = Nodes * (Nodes + 1) / 2;
  Batch x[3 * Nodes], blocks[9 * kPairs];
  for (int batch = 0; batch < e.batches; ++batch) {
    const int* nodes = e.nodes + static_cast<std::ptrdiff_t>(batch) * Nodes * kLanes;
    const int* slots = e.slots + static_cast<std::ptrdiff_t>(batch) * kPairs * kLanes;
    const int lanes = std::min(kLanes, e.count - batch * kLanes);
    Batch p = splat(0.0);
    for (int lane = 0; lane < lanes; ++lane) p[lane] = multipliers[batch * kLanes + lane];
    gather(positions, nodes, Nodes, x);
    batch_hessian<Nodes, Points>(x, e.gradients + static_cast<std::ptrdiff_t>(batch) * Points * Nodes * 3,
                                 e.weights + static_cast<std::ptrdiff_t>(batch) * Points,
                                 e.laplacian + static_cast<std::ptrdiff_t>(batch) * kPairs, laws[batch],
                                 e.lambdas[batch], p, convex, blocks,
                                 volume_gradients + static_cast<std::ptrdiff_t>(batch) * 3 * Nodes);
    for (int pair = 0; pair < kPairs; ++pair) {
      for (int lane = 0; lane < lanes; ++lane) {
        double* target = values + static_cast<std::ptrdiff_t>(9) * slots[pair * kLanes + lane];
        for (int i = 0; i < 9; ++i) target[i] += blocks[9 * pair + i][lane];
      }
    }
  }
}

SOFT_ROBOT_LAB_CLONES void quadratic_gradients(const ElementArrays& e, const NeoHookean* laws, const double* x,
                                               const double* p, double* forces, ElementSums* sums) {
  all_gradients<10, 4>(e, laws, x, p, forces, sums);
}
SOFT_ROBOT_LAB_CLONES void quadratic_hessians(const ElementArrays& e, const NeoHookean* laws, const double* x,
                                              const double* p, bool convex, double* values, Batch* volume_gradients) {
  all_hessians<10, 4>(e, laws, x, p, convex, values, volume_gradients);
}
SOFT_ROBOT_LAB_CLONES void linear_gradients(const ElementArrays& e, const NeoHookean* laws, const double* x,
                                            const double* p, double* forces, ElementSums* sums) {
  all_gradients<4, 1>(e, laws, x, p, forces, sums);
}
SOFT_ROBOT_LAB_CLONES void linear_hessians(const ElementArrays& e, const NeoHookean* laws, const double* x,
                                           const double* p, bool convex, double* values, Batch* volume_gradients) {
  all_hessians<4, 1>(e, laws, x, p, convex, values, volume_gradients);
}
SOFT_ROBOT_LAB_CLONES void quadratic_gradients(const ElementArrays& e, const Rivlin* laws, const double* x,
                                               const double* p, double* forces, ElementSums* sums) {
  all_gradients<10, 4>(e, laws, x, p, forces, sums);
}
SOFT_ROBOT_LAB_CLONES void quadratic_hessians(const ElementArrays& e, const Rivlin* laws, const double* x,
                                              const double* p, bool convex, double* values, Batch* volume_gradients) {
  all_hessians<10, 4>(e, laws, x, p, convex, values, volume_gradients);
}
SOFT_ROBOT_LAB_CLONES void linear_gradients(const ElementArrays& e, const Rivlin* laws, const double* x,
                                            const double* p, double* forces, ElementSums* sums) {
  all_gradients<4, 1>(e, laws, x, p, forces, sums);
}
SOFT_ROBOT_LAB_CLONES void linear_hessians(const ElementArrays& e, const Rivlin* laws, const double* x, const double* p,
                                           bool convex, double* values, Batch* volume_gradients) {
  all_hessians<4, 1>(e, laws, x, p, convex, values, volume_gradients);
}

std::vector<int> mesh_order(int count) {
  std::vector<int> lanes(static_cast<std::size_t>((count + kLanes - 1) / kLanes * kLanes), ~(count - 1));
  std::iota(lanes.begin(), lanes.begin() + count, 0);
  return lanes;
}

std::vector<int> positions_in(const BlockPattern& matrix, int node_count) {
  std::vector<int> positions;
  positions.reserve(static_cast<std::size_t>(node_count));
  for (int node = 0; node < node_count; ++node) positions.push_back(matrix.position(node));
  return positions;
}

ElementArrays arrays(const ElementBatches& batches, const std::vector<int>& slots, int count, const Batches& lambdas) {
  return {batches.count(),          count,
          batches.nodes.data(),     slots.data(),
          batches.gradients.data(), batches.weights.data(),
          batches.laplacian.data(), lambdas.data()};
}

}  // namespace

ElementTables::ElementTables(const Body& body, const BlockPattern& matrix)
    : count(body.mesh().tet_count()),
      one_material(body.one_material()),
      batches(body, mesh_order(count), positions_in(matrix, body.mesh().node_count())) {
  const auto place = [&](int batch, int a, int lane) {
    return matrix.position(batches.nodes[(static_cast<std::size_t>(batch) * batches.node_count + a) * kLanes + lane]);
  };
  for (int batch = 0; batch < batches.count(); ++batch)
    for (int a = 0; a < batches.node_count; ++a)
      for (int b = 0; b <= a; ++b)
        for (int lane = 0; lane < kLanes; ++lane)
          slots.push_back(matrix.slot(place(batch, a, lane), place(batch, b, lane)));
  element_volumes = Eigen::VectorXd::Zero(count);
  for (int e = 0; e < count; ++e)
    for (int q = 0; q < batches.point_count; ++q)
      element_volumes[e] += batches.weights[static_cast<std::size_t>(e / kLanes) * batches.point_count + q][e % kLanes];
  if (body.linear_volume() == LinearVolume::vertex_averaged) patches.emplace(batches, element_volumes, matrix);
  volumes = element_volumes;
  if (body.fibre_groups().empty()) return;
  fibres.emplace(body, matrix);
  volumes.conservativeResize(count + fibres->count());
  volumes.tail(fibres->count()) = fibres->lengths_m();
}

Elements::Elements(std::shared_ptr<const ElementTables> tables)
    : tables_(std::move(tables)),
      count_(tables_->count),
      batches_(tables_->batches),
      slots_(tables_->slots),
      element_volumes_(tables_->element_volumes),
      patches_(tables_->patches),
      lambdas_(batches_.lambda_pa),
      volume_gradients_(static_cast<std::size_t>(batches_.count()) * batches_.node_count * 3, splat(0.0)) {
  const Eigen::Index multipliers = rest_volumes_m3().size();
  lambda_pa_.resize(multipliers);
  mu_pa_.resize(multipliers);
  if (fibre_count() > 0) {
    lambda_pa_.tail(fibre_count()) = tables_->fibres->stiffnesses_n();
    mu_pa_.tail(fibre_count()) = tables_->fibres->soft_stiffnesses_n();
  }
  for (Eigen::Index i = 0; i < multipliers - fibre_count(); ++i) {
    const std::size_t slot = patches_ ? 0 : static_cast<std::size_t>(i);
    lambda_pa_[i] = batches_.lambda_pa[slot / kLanes][slot % kLanes];
    mu_pa_[i] = batches_.mu_pa[slot / kLanes][slot % kLanes];
  }
  set_lambda_pa(lambda_pa_);
}

void Elements::set_lambda_pa(const Eigen::VectorXd& lambda_pa) {
  lambda_pa_ = lambda_pa;
  for (int element = 0; element < count_; ++element)
    lambdas_[element / kLanes][element % kLanes] = patches_ ? 0.0 : lambda_pa_[element];
}

double Elements::sum_of_squares(const Eigen::VectorXd& factors, const Eigen::VectorXd& c) const {
  if (tables_->one_material && !tables_->fibres) return factors[0] * c.cwiseAbs2().dot(rest_volumes_m3());
  return factors.cwiseProduct(c.cwiseAbs2()).dot(rest_volumes_m3());
}

ElementSums Elements::add_gradient(const Eigen::Matrix3Xd& positions, const Eigen::VectorXd& multipliers,
                                   Eigen::Matrix3Xd& forces) const {
  const ElementArrays all = arrays(batches_, slots_, count_, lambdas_);
  const Eigen::VectorXd averaged = patches_ ? patches_->on_elements(multipliers) : Eigen::VectorXd();
  const double* p = patches_ ? averaged.data() : multipliers.data();
  ElementSums sums;
  sums.volumetric_strain.resize(count_ + fibre_count());
  const auto add = [&](const auto& laws) {
    if (batches_.node_count == 10)
      quadratic_gradients(all, laws.data(), positions.data(), p, forces.data(), &sums);
    else
      linear_gradients(all, laws.data(), positions.data(), p, forces.data(), &sums);
  };
  std::visit(add, batches_.laws);
  if (tables_->fibres)
    tables_->fibres->add_gradient(positions, multipliers.data() + count_, forces,
                                  sums.volumetric_strain.data() + count_);
  if (patches_)
    sums.volumetric_strain =
        patches_->on_vertices(sums.volumetric_strain.cwiseProduct(element_volumes_)).cwiseQuotient(rest_volumes_m3());
  return sums;
}

Eigen::Matrix3Xd Elements::pressure_forces_n(const Eigen::Matrix3Xd& positions, const Eigen::VectorXd& p_pa) const {
  Eigen::Matrix3Xd with = Eigen::Matrix3Xd::Zero(3, positions.cols()), without = with;
  add_gradient(positions, p_pa, with);
  add_gradient(positions, Eigen::VectorXd::Zero(p_pa.size()), without);
  return with - without;
}

void Elements::add_hessian(const Eigen::Matrix3Xd& positions, const Eigen::VectorXd& multipliers, bool convex,
                           BlockMatrix& matrix) {
  const ElementArrays all = arrays(batches_, slots_, count_, lambdas_);
  const Eigen::VectorXd averaged = patches_ ? patches_->on_elements(multipliers) : Eigen::VectorXd();
  const double* p = patches_ ? averaged.data() : multipliers.data();
  double* values = matrix.block(0);
  const auto add = [&](const auto& laws) {
    if (batches_.node_count == 10)
      quadratic_hessians(all, laws.data(), positions.data(), p, convex, values, volume_gradients_.data());
    else
      linear_hessians(all, laws.data(), positions.data(), p, convex, values, volume_gradients_.data());
  };
  std::visit(add, batches_.laws);
  if (patches_) patches_->add_hessian(volume_gradients_, lambda_pa_[0], matrix);
  if (tables_->fibres)
    tables_->fibres->add_hessian(positions, lambda_pa_.data() + count_, multipliers.data() + count_, convex, matrix,
                                 fibre_gradients_);
}

void Elements::add_mismatch_forces(const Eigen::VectorXd& mismatch, Eigen::Matrix3Xd& forces) const {
  if (tables_->fibres)
    tables_->fibres->add_forces(fibre_gradients_, lambda_pa_.cwiseProduct(mismatch).tail(fibre_count()), forces);
  const Eigen::VectorXd averaged = patches_ ? patches_->on_elements(mismatch) : Eigen::VectorXd();
  const Eigen::VectorXd& of_elements = patches_ ? averaged : mismatch;
  for (int element = 0; element < count_; ++element) {
    const int batch = element / kLanes, lane = element % kLanes;
    const double pressure = lambda_of(element) * of_elements[element];
    for (int a = 0; a < batches_.node_count; ++a) {
      const std::size_t place = static_cast<std::size_t>(batch) * batches_.node_count + a;
      const int node = batches_.nodes[place * kLanes + lane];
      for (int i = 0; i < 3; ++i) forces(i, node) += pressure * volume_gradients_[place * 3 + i][lane];
    }
  }
}

Eigen::VectorXd Elements::updated_multipliers(const Eigen::VectorXd& volumetric_strain,
                                              const Eigen::Matrix3Xd& step) const {
  Eigen::VectorXd change(count_ + fibre_count());  // of V0 Jbar
  if (tables_->fibres) change.tail(fibre_count()) = tables_->fibres->changes(fibre_gradients_, step);
  for (int element = 0; element < count_; ++element) {
    const int batch = element / kLanes, lane = element % kLanes;
    double sum = 0.0;
    for (int a = 0; a < batches_.node_count; ++a) {
      const std::size_t place = static_cast<std::size_t>(batch) * batches_.node_count + a;
      const int node = batches_.nodes[place * kLanes + lane];
      for (int i = 0; i < 3; ++i) sum += volume_gradients_[place * 3 + i][lane] * step(i, node);
    }
    change[element] = sum;
  }
  if (patches_) change = patches_->on_vertices(change);
  return lambda_pa_.cwiseProduct(volumetric_strain + change.cwiseQuotient(rest_volumes_m3()));
}

}  // namespace soft_robot_lab
