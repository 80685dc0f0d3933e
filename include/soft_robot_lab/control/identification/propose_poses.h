// SPDX-License-Identifier: BSD-3-Clause
// Which poses to drive, so that a fit finds its parameters best: optimal experiment design (Atkinson, Donev and Tobias
// 2007, Optimum Experimental Designs) on the sensitivities of the equilibria, pose by pose in the order of driving, as
// friction and backlash depend on the way.
#pragma once

#include <string>
#include <vector>

#include "fit_model.h"

namespace soft_robot_lab {

enum class DesignCriterion {
  determinant,  // D: least volume of the parameters' ellipsoid
  trace         // A: least sum of their variances, each in the width of its bounds
};

struct ProposalRequest {
  std::vector<FitParameter> parameters;  // of fit_model, but damping and creep; what they are expected to be: `start`
  int poses = 12;                        // [1, 1000]
  int candidates = 16;                   // of which each next pose is the best [1, 1000]
  double deviation_m = 2.0e-4;           // > 0, of a marker's coordinate at a pose, with what the model may miss
  DesignCriterion criterion = DesignCriterion::determinant;
  unsigned int seed = 1;          // of the candidates
  std::optional<double> mass_kg;  // as in FitRequest
  void validate() const;          // throws std::invalid_argument: field, value, allowed range
};

struct PoseProposal {
  std::vector<std::string> actuators;
  std::vector<std::vector<double>> commands;  // of each pose, one an actuator
  std::vector<FittedValue> values;            // as expected: deviation, interval, whether the poses identify it
};

// Throws as fit_model. Candidates without a rest state are passed over.
PoseProposal propose_poses(const std::string& scene, const SceneOptions& options, const ProposalRequest& request);

// The same statement for given poses.
std::vector<FittedValue> expected_values(const std::string& scene, const SceneOptions& options,
                                         const ProposalRequest& request,
                                         const std::vector<std::vector<double>>& commands);

}  // namespace soft_robot_lab
