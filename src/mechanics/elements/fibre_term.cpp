// SPDX-License-Identifier: BSD-3-Clause
#include "fibre_term.h"

#include <algorithm>

namespace soft_robot_lab {
namespace {

constexpr double kBuckles = 1e-4;  // strain at which a thread that is pushed has given way

// A group's chords at some positions.
struct Chords {
  Eigen::Matrix3Xd ways;    // unit vectors
  Eigen::VectorXd lengths;  // [m]
  double strain;            // of their sum
};

Chords chords_of(const FibreGroup& group, const Eigen::Matrix3Xd& nodes_m) {
  Chords chords;
  chords.ways = nodes_m * group.weights;
  chords.lengths = chords.ways.colwise().norm().transpose().cwiseMax(1e-12 * group.rest_length_m);
  chords.ways.array().rowwise() /= chords.lengths.transpose().array();
  chords.strain = chords.lengths.sum() / group.rest_length_m - 1.0;
  return chords;
}

}  // namespace

ThreadLaw thread_law(double strain, bool only_tension) {
  if (!only_tension || strain >= 0.0) return {0.5 * strain * strain, strain, 1.0};
  if (strain > -kBuckles)
    return {strain * strain * (0.5 + strain / (6.0 * kBuckles)), strain * (1.0 + 0.5 * strain / kBuckles),
            1.0 + strain / kBuckles};
  return {-0.5 * kBuckles * strain - kBuckles * kBuckles / 6.0, -0.5 * kBuckles, 0.0};
}

std::vector<Clique> FibreTerm::cliques() const {
  std::vector<Clique> all;
  for (const FibreGroup& group : body_.fibre_groups()) {
    const auto nodes = body_.mesh().tets.col(group.tet);
    all.emplace_back(nodes.begin(), nodes.end());
  }
  return all;
}

double FibreTerm::add_gradient(const Eigen::Matrix3Xd& positions_m, const DriveState& /*unused*/,
                               Eigen::Matrix3Xd& gradient_n) const {
  double energy_j = 0.0;
  for (const FibreGroup& group : body_.fibre_groups()) {
    const Fibre& fibre = body_.fibres()[static_cast<std::size_t>(group.fibre)];
    const auto nodes = body_.mesh().tets.col(group.tet);
    const Chords chords = chords_of(group, positions_m(Eigen::all, nodes));
    const ThreadLaw law = thread_law(chords.strain, fibre.only_tension);
    energy_j += fibre.axial_stiffness_n * group.rest_length_m * law.energy;
    const Eigen::Matrix3Xd forces_n = fibre.axial_stiffness_n * law.tension * chords.ways * group.weights.transpose();
    for (Eigen::Index i = 0; i < nodes.size(); ++i) gradient_n.col(nodes[i]) += forces_n.col(i);
  }
  return energy_j;
}

void FibreTerm::add_hessian(const Eigen::Matrix3Xd& positions_m, const DriveState& /*unused*/, bool convex,
                            CliqueSink& hessian) const {
  int clique = 0;
  for (const FibreGroup& group : body_.fibre_groups()) {
    const Fibre& fibre = body_.fibres()[static_cast<std::size_t>(group.fibre)];
    const Chords chords = chords_of(group, positions_m(Eigen::all, body_.mesh().tets.col(group.tet)));
    const ThreadLaw law = thread_law(chords.strain, fibre.only_tension);
    const double tension_n = fibre.axial_stiffness_n * (convex ? std::max(0.0, law.tension) : law.tension);
    const Eigen::Matrix3Xd along = chords.ways * group.weights.transpose();
    Eigen::MatrixXd block =
        fibre.axial_stiffness_n * law.slope / group.rest_length_m * along.reshaped() * along.reshaped().transpose();
    for (Eigen::Index k = 0; k < chords.lengths.size(); ++k) {
      const Eigen::Vector3d way = chords.ways.col(k);
      const Eigen::Matrix3d across =
          tension_n / chords.lengths[k] * (Eigen::Matrix3d::Identity() - way * way.transpose());
      for (Eigen::Index a = 0; a < group.weights.rows(); ++a)
        for (Eigen::Index b = 0; b < group.weights.rows(); ++b)
          block.block<3, 3>(3 * a, 3 * b) += group.weights(a, k) * group.weights(b, k) * across;
    }
    hessian.add_dense(clique++, block);
  }
}

}  // namespace soft_robot_lab
