// SPDX-License-Identifier: BSD-3-Clause
// How LoadEstimator comes to its estimate: what was seen in standard deviations, loads that the model is solved under,
// and hypotheses weighed.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "load_search.h"
#include "load_estimator.h"

namespace soft_robot_lab {

// What is known of a marker's offset: measured less modelled.
struct MarkerOffset {
  Eigen::Vector3d offset_m, modelled_m;
  Eigen::Matrix3d covariance_m2;
};

struct SeenCoordinates {
  std::vector<int> markers;
  std::vector<Eigen::Vector3d> positions_m;
  std::vector<Eigen::Matrix3d> covariances_m2;
  Eigen::Index coordinates() const { return 3 * static_cast<Eigen::Index>(markers.size()); }
};

// How seen coordinates move where the model stands without loads.
struct UnloadedChanges {
  Eigen::MatrixXd by_modulus;   // coordinates x 1, for all moduli doubled by the tangent
  Eigen::MatrixXd by_commands;  // coordinates x actuators, for the whole range of each command
  std::vector<double> ranges;   // of each command, in its unit
};

struct LoadSolution {
  std::vector<PlacedLoad> loads;
  double log_probability = 0.0;  // of gap and forces, up to a constant
  double chi2 = 0.0;
  LinearisedLoads linear;  // its gap is that of the loads' absence
  SimulationState state;
};

struct LoadHypothesis {
  LoadKind kind;
  double log_evidence;
  double chi2;
  Eigen::VectorXd numbers{};  // of one that is linear
  int actuator = -1;
  std::optional<LoadSolution> solution{};
};

// Beyond it chi^2 of so many coordinates lies by this chance.
double largest_chi2(int coordinates, double chance);

struct LoadEstimator::Parts {
  Parts(Simulation& simulation, const LoadEstimationOptions& chosen);

  LoadPrior prior() const;
  SeenCoordinates check(const std::vector<MeasuredMarker>& measured) const;
  Eigen::VectorXd gap_m(const SeenCoordinates& seen) const;
  // How far markers have moved since offsets were taken: 0 not at all, 1 by options.pose_change_m or more.
  double pose_change(const SeenCoordinates& seen) const;
  UnloadedChanges changes(const SeenCoordinates& seen);
  // `changes` may be absent where the pose has not changed.
  Eigen::MatrixXd whitening(const SeenCoordinates& seen, const std::optional<UnloadedChanges>& changes,
                            const Eigen::VectorXd& moved_m) const;
  LinearisedLoads linearise(const SeenCoordinates& seen, const Eigen::MatrixXd& whitening,
                            const std::vector<LoadPlace>& places, const std::vector<PlacedLoad>& loads);
  std::optional<LoadSolution> solve(const SeenCoordinates& seen, const Eigen::MatrixXd& whitening,
                                    const std::vector<LoadPlace>& places, const std::vector<PlacedLoad>& loads);
  std::vector<PlacedLoad> better(const LoadSolution& at, const std::vector<LoadPlace>& places,
                                 const Eigen::VectorXd& left_out, bool anywhere) const;
  std::optional<LoadSolution> approach(const SeenCoordinates& seen, const Eigen::MatrixXd& whitening,
                                       const LinearisedLoads& unloaded, const std::vector<LoadPlace>& places,
                                       const std::vector<std::size_t>& where);
  std::optional<LoadSolution> follow(const SeenCoordinates& seen, const Eigen::MatrixXd& whitening,
                                     const LinearisedLoads& unloaded, const std::vector<LoadPlace>& places,
                                     const std::vector<std::size_t>& where);
  double log_evidence(const LoadSolution& solution, const std::vector<LoadPlace>& places) const;
  void add_loads(const SeenCoordinates& seen, const Eigen::MatrixXd& whitening, const LinearisedLoads& unloaded,
                 std::vector<LoadHypothesis>& all);
  void add_changes(const SeenCoordinates& seen, const UnloadedChanges& changes, const Eigen::MatrixXd& whitening,
                   const LinearisedLoads& unloaded, std::vector<LoadHypothesis>& all) const;
  EstimatedLoad describe(const LoadSolution& solution, std::size_t load, const std::vector<LoadPlace>& places) const;
  void conclude(const SeenCoordinates& seen, const UnloadedChanges& changes, const std::vector<LoadHypothesis>& all,
                LoadEstimate& result);

  Simulation& model;
  LoadEstimationOptions options;
  std::vector<LoadPlace> skin, hooks;
  std::map<int, MarkerOffset> offsets;
  SimulationState untouched, estimated;
};

}  // namespace soft_robot_lab
