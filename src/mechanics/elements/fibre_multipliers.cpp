// SPDX-License-Identifier: BSD-3-Clause
#include "fibre_multipliers.h"

#include <algorithm>

#include "mechanics/mesh/load_weights.h"

namespace soft_robot_lab {
namespace {

// A group's chords at some positions.
struct Chords {
  Eigen::Matrix3Xd ways;    // unit vectors
  Eigen::VectorXd lengths;  // [m]
  double strain;            // of their sum
};

Chords chords_of(const Eigen::MatrixXd& weights, const Eigen::Matrix3Xd& nodes_m, double rest_length_m) {
  Chords chords;
  chords.ways = nodes_m * weights;
  chords.lengths = chords.ways.colwise().norm().transpose().cwiseMax(1e-12 * rest_length_m);
  chords.ways.array().rowwise() /= chords.lengths.transpose().array();
  chords.strain = chords.lengths.sum() / rest_length_m - 1.0;
  return chords;
}

std::vector<Clique> cliques_of(const Body& body) {
  std::vector<Clique> all;
  for (const FibreGroup& group : body.fibre_groups()) {
    const auto nodes = body.mesh().tets.col(group.tet);
    all.emplace_back(nodes.begin(), nodes.end());
  }
  return all;
}

}  // namespace

FibreMultipliers::FibreMultipliers(const Body& body, const BlockPattern& matrix) : places_(matrix, cliques_of(body)) {
  const auto count = static_cast<Eigen::Index>(body.fibre_groups().size());
  lengths_m_.resize(count);
  stiffnesses_n_.resize(count);
  softnesses_n_.resize(count);
  for (const FibreGroup& group : body.fibre_groups()) {
    const auto index = static_cast<Eigen::Index>(groups_.size());
    const auto nodes = body.mesh().tets.col(group.tet);
    const Fibre& fibre = body.fibres()[static_cast<std::size_t>(group.fibre)];
    groups_.push_back({{nodes.begin(), nodes.end()}, group.weights, fibre.only_tension});
    lengths_m_[index] = group.rest_length_m;
    stiffnesses_n_[index] = fibre.axial_stiffness_n;
    softnesses_n_[index] =
        std::min(fibre.axial_stiffness_n, body.material_of(group.tet).lame_mu_pa() *
                                              rest_volume_m3(body.mesh(), group.tet) / group.rest_length_m);
  }
}

void FibreMultipliers::add_gradient(const Eigen::Matrix3Xd& positions_m, const double* tensions_n,
                                    Eigen::Matrix3Xd& forces_n, double* strains) const {
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const Group& group = groups_[i];
    const auto index = static_cast<Eigen::Index>(i);
    const Chords chords = chords_of(group.weights, positions_m(Eigen::all, group.nodes), lengths_m_[index]);
    strains[i] = taut(index, chords.strain, tensions_n[i]) ? chords.strain : 0.0;
    if (tensions_n[i] == 0.0) continue;
    const Eigen::Matrix3Xd along = chords.ways * group.weights.transpose();
    for (std::size_t a = 0; a < group.nodes.size(); ++a)
      forces_n.col(group.nodes[a]) += tensions_n[i] * along.col(static_cast<Eigen::Index>(a));
  }
}

void FibreMultipliers::add_hessian(const Eigen::Matrix3Xd& positions_m, const double* stiffnesses_n,
                                   const double* tensions_n, bool convex, BlockMatrix& matrix,
                                   Gradients& gradients) const {
  CliqueAdder adder(matrix, places_);
  gradients.ways.resize(groups_.size());
  gradients.slopes.resize(count());
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const Group& group = groups_[i];
    const auto index = static_cast<Eigen::Index>(i);
    const Chords chords = chords_of(group.weights, positions_m(Eigen::all, group.nodes), lengths_m_[index]);
    const double slope = taut(index, chords.strain, tensions_n[i]) ? 1.0 : 0.0;
    const double tension_n = convex ? std::max(0.0, tensions_n[i]) : tensions_n[i];
    gradients.slopes[index] = slope;
    gradients.ways[i] = chords.ways * group.weights.transpose();
    const auto along = gradients.ways[i].reshaped();
    Eigen::MatrixXd block = stiffnesses_n[i] * slope / lengths_m_[index] * along * along.transpose();
    for (Eigen::Index k = 0; k < chords.lengths.size() && tension_n != 0.0; ++k) {
      const Eigen::Vector3d way = chords.ways.col(k);
      const Eigen::Matrix3d across =
          tension_n / chords.lengths[k] * (Eigen::Matrix3d::Identity() - way * way.transpose());
      for (Eigen::Index a = 0; a < group.weights.rows(); ++a)
        for (Eigen::Index b = 0; b < group.weights.rows(); ++b)
          block.block<3, 3>(3 * a, 3 * b) += group.weights(a, k) * group.weights(b, k) * across;
    }
    adder.add_dense(static_cast<int>(i), block);
  }
}

void FibreMultipliers::add_forces(const Gradients& gradients, const Eigen::VectorXd& tensions_n,
                                  Eigen::Matrix3Xd& forces_n) const {
  for (std::size_t i = 0; i < gradients.ways.size(); ++i)
    for (std::size_t a = 0; a < groups_[i].nodes.size(); ++a)
      forces_n.col(groups_[i].nodes[a]) +=
          tensions_n[static_cast<Eigen::Index>(i)] * gradients.ways[i].col(static_cast<Eigen::Index>(a));
}

Eigen::VectorXd FibreMultipliers::changes(const Gradients& gradients, const Eigen::Matrix3Xd& step) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(count());
  for (std::size_t i = 0; i < gradients.ways.size(); ++i) {
    double change_m = 0.0;
    for (std::size_t a = 0; a < groups_[i].nodes.size(); ++a)
      change_m += gradients.ways[i].col(static_cast<Eigen::Index>(a)).dot(step.col(groups_[i].nodes[a]));
    all[static_cast<Eigen::Index>(i)] = gradients.slopes[static_cast<Eigen::Index>(i)] * change_m;
  }
  return all;
}

}  // namespace soft_robot_lab
