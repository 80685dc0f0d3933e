// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/identification/propose_poses.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include <Eigen/LU>

#include "fit_parameters.h"
#include "fit_statistics.h"
#include "pose_model.h"
#include "pose_walk.h"
#include "settings/limits.h"
#include "settings/require.h"

namespace soft_robot_lab {
namespace {

// Where a walk stands, and what is known there.
struct WalkPlace {
  SimulationState state;
  PoseWalk::Past past;
  DrivePlay play;
  Eigen::MatrixXd information;  // in the widths of the bounds, with what these know
};

// Walks through poses and counts what they say about the parameters.
class InformationWalk {
 public:
  InformationWalk(const std::string& scene, const SceneOptions& asked, const ProposalRequest& request)
      : options_(request.mass_kg ? weighed(scene, asked, *request.mass_kg) : asked),
        parameters_(scene, options_, request.parameters),
        request_(request) {
    require(!parameters_.damping() && parameters_.creep().empty(),
            "parameters: damping and creep are no numbers of rest states, so no poses are proposed for them");
    values_.resize(static_cast<Eigen::Index>(parameters_.numbers().size()));
    for (Eigen::Index i = 0; i < values_.size(); ++i)
      values_[i] = parameters_.numbers()[static_cast<std::size_t>(i)].start;
    widths_ = bound_widths(parameters_.numbers());
    options_.overrides = parameters_.overrides(values_);
    scene_ = load_scene(scene, options_);
    walk_.emplace(simulation(), parameters_.model_parameters(simulation()), true);
    play_.emplace(simulation(), parameters_.backlash_m(values_));
    information_ = Eigen::MatrixXd::Identity(values_.size(), values_.size());
    walk_->go(play_->go(commands_of(simulation(), MeasuredPose{})));
  }

  // Throws std::runtime_error where there is no rest; then go back.
  void go(const std::vector<double>& commands) {
    walk_->go(play_->go(commands));
    const Eigen::MatrixXd& jacobian = walk_->jacobian();
    for (int m = 0; m < static_cast<int>(simulation().markers().size()); ++m) {
      Eigen::Matrix3Xd here =
          parameters_.measured_jacobian(values_, simulation().marker_position(m), jacobian.middleRows<3>(3 * m));
      for (Eigen::Index i = 0; i < values_.size(); ++i)
        here.col(i) *= widths_[i] / parameters_.numbers()[static_cast<std::size_t>(i)].size / request_.deviation_m;
      information_ += here.transpose() * here;
    }
  }

  WalkPlace place() { return {simulation().state(), walk_->past(), *play_, information_}; }
  void go_back(const WalkPlace& place) {
    walk_->go_back(place.state, place.past);
    *play_ = place.play;
    information_ = place.information;
  }

  // The larger the better.
  double worth() const {
    if (request_.criterion == DesignCriterion::trace) return -information_.inverse().trace();
    return information_.ldlt().vectorD().array().log().sum();
  }

  std::vector<FittedValue> expected() const {
    const Eigen::MatrixXd covariance = information_.inverse();
    std::vector<FittedValue> values;
    for (Eigen::Index i = 0; i < values_.size(); ++i) {
      const FitNumber& number = parameters_.numbers()[static_cast<std::size_t>(i)];
      const double deviation = std::sqrt(covariance(i, i)) * widths_[i];
      values.push_back({number.name, number.start, number.start, deviation,
                        std::max(number.min, number.start - kOf95Percent * deviation),
                        std::min(number.max, number.start + kOf95Percent * deviation), number.min, number.max,
                        covariance(i, i) < kUnidentified});
    }
    return values;
  }

  const Simulation& robot() const { return *scene_.simulation; }

 private:
  Simulation& simulation() { return *scene_.simulation; }

  SceneOptions options_;
  FitParameters parameters_;
  const ProposalRequest& request_;
  Eigen::VectorXd values_, widths_;
  Scene scene_;
  std::optional<PoseWalk> walk_;
  std::optional<DrivePlay> play_;
  Eigen::MatrixXd information_;
};

// Between rest and the end that is pulled or filled: beyond rest a cable hangs idle.
std::vector<double> random_commands(const Simulation& robot, std::mt19937& random) {
  std::vector<double> commands;
  for (const auto& actuator : robot.actuators()) {
    const CommandLimits& limits = actuator->limits();
    const double end = limits.min < limits.rest ? limits.min : limits.max;
    commands.push_back(limits.rest + std::ldexp(static_cast<double>(random()), -32) * (end - limits.rest));
  }
  return commands;
}

}  // namespace

void ProposalRequest::validate() const {
  require(!parameters.empty(), "parameters: none are given");
  require(poses >= 1 && poses <= 1000, "poses must be in [1, 1000]");
  require(candidates >= 1 && candidates <= 1000, "candidates must be in [1, 1000]");
  require(std::isfinite(deviation_m) && deviation_m > 0.0, "deviation_m must be in (0, inf)");
  require(!mass_kg || (*mass_kg >= kLeastMass_kg && *mass_kg <= limits::kMass_kg), "mass_kg must be in [1e-06, 1e+06]");
}

PoseProposal propose_poses(const std::string& scene, const SceneOptions& options, const ProposalRequest& request) {
  request.validate();
  InformationWalk walk(scene, options, request);
  std::mt19937 random(request.seed);
  PoseProposal proposal;
  for (const auto& actuator : walk.robot().actuators()) proposal.actuators.push_back(actuator->name());
  for (int pose = 0; pose < request.poses; ++pose) {
    const WalkPlace from = walk.place();
    std::optional<WalkPlace> best;
    double worth = 0.0;
    std::vector<double> there;
    for (int candidate = 0; candidate < request.candidates; ++candidate) {
      const std::vector<double> commands = random_commands(walk.robot(), random);
      walk.go_back(from);
      try {
        walk.go(commands);
      } catch (const std::runtime_error&) {  // no rest there
        continue;
      }
      if (best && walk.worth() <= worth) continue;
      worth = walk.worth();
      best = walk.place();
      there = commands;
    }
    if (!best) throw std::runtime_error("none of the candidates for a pose has a rest state");
    walk.go_back(*best);
    proposal.commands.push_back(there);
  }
  proposal.values = walk.expected();
  return proposal;
}

std::vector<FittedValue> expected_values(const std::string& scene, const SceneOptions& options,
                                         const ProposalRequest& request,
                                         const std::vector<std::vector<double>>& commands) {
  request.validate();
  InformationWalk walk(scene, options, request);
  for (const std::vector<double>& pose : commands) walk.go(pose);
  return walk.expected();
}

}  // namespace soft_robot_lab
