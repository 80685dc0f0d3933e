// SPDX-License-Identifier: BSD-3-Clause
// Which places and forces explain a gap between measured and modelled markers, where the model has been linearised.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "push_places.h"

namespace soft_robot_lab {

// A place where a load may act: of the skin, where it pushes, or a point at which a weight hangs.
struct LoadPlace {
  EmbeddedPoint at;
  double share = 0.0;               // of all places together, 1
  std::optional<PushPlace> skin{};  // absent: a weight
  int marker = -1;                  // of a weight
};

// Coordinates of seen markers in standard deviations ("whitened").
struct LinearisedLoads {
  Eigen::Matrix3Xd positions_m;
  Eigen::MatrixXd compliance;  // 3*nodes x coordinates, per N: of a force at a node
  Eigen::VectorXd gap;         // measured less modelled

  Eigen::MatrixXd compliance_at(const EmbeddedPoint& at) const;  // 3 x coordinates
};

// Forces of several orders of magnitude are alike probable: a mixture of normal distributions about zero.
struct LoadPrior {
  const TetMesh& mesh;
  Eigen::Vector3d down;  // unit vector; zero where nothing weighs
  double friction_coefficient;
  std::vector<double> force_scales_n;  // standard deviations

  // Of a load with so many free components (1 for a weight, 3 for a push).
  double log_density(const Eigen::Vector3d& force_n, int components) const;
  // The standard deviation of which such a force is most probable.
  double scale_of(const Eigen::Vector3d& force_n, int components) const;
};

struct PlacedLoad {
  std::size_t place = 0;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
};

struct PlaceFit {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_n2 = Eigen::Matrix3d::Zero();  // of a load without its cone
  double log_evidence = 0.0;                                // relative to no load
};

// For each place the force that explains `gap` best; `gap` in place of that of `linear`.
std::vector<PlaceFit> fit_places(const LinearisedLoads& linear, const Eigen::VectorXd& gap,
                                 const std::vector<LoadPlace>& places, const LoadPrior& prior);

// The best fits whose rest places lie at least `apart_m` from one another, best first, at most `count`.
std::vector<std::size_t> best_apart(const std::vector<PlaceFit>& fits, const std::vector<LoadPlace>& places,
                                    const TetMesh& mesh, double apart_m, std::size_t count);

// log of the sum over places of share * evidence.
double log_mean_evidence(const std::vector<PlaceFit>& fits, const std::vector<LoadPlace>& places);

// Of each place the probability that the load acts there.
std::vector<double> place_probabilities(const std::vector<PlaceFit>& fits, const std::vector<LoadPlace>& places);

// The places of two loads that explain the gap together; the first is one of `firsts`. Every `stride`-th place is tried
// for the second. Empty where none explains any of it.
std::vector<std::size_t> best_pair(const LinearisedLoads& linear, const std::vector<LoadPlace>& places,
                                   const std::vector<std::size_t>& firsts, std::size_t stride, const LoadPrior& prior);

}  // namespace soft_robot_lab
