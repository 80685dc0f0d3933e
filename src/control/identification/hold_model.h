// SPDX-License-Identifier: BSD-3-Clause
// What a scene says about poses in time: it goes through them as the robot did, and creeps while commands are held.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "creep_model.h"
#include "fit_parameters.h"
#include "pose_model.h"

namespace soft_robot_lab {

class HoldModel {
 public:
  HoldModel(std::string scene, SceneOptions options, const std::vector<MeasuredPose>& poses,
            const FitParameters& parameters);

  // `values` of FitParameters::numbers_in_time. Predictions of all poses' markers, then of what was seen meanwhile,
  // pose by pose. Derivatives are differences, as whether a cable sticks depends on the whole way. Throws
  // std::runtime_error where a step does not converge.
  std::vector<PosePrediction> predict(const Eigen::VectorXd& values, bool derivatives);

  std::vector<SimulatedHold> holds(const Eigen::VectorXd& values) const;
  // Without numbers of these names.
  Overrides overrides(const Eigen::VectorXd& values, const std::set<std::string>& left_out = {}) const;

 private:
  std::vector<Eigen::Matrix3Xd> places(const Eigen::VectorXd& values) const;  // of each prediction
  Eigen::Matrix3Xd places_of(const std::vector<MeasuredMarker>& markers,
                             const std::function<Eigen::Vector3d(int marker)>& place) const;

  std::string scene_;
  SceneOptions options_;
  const std::vector<MeasuredPose>& poses_;
  const FitParameters& parameters_;
  std::map<std::string, int> markers_;
  struct Point {
    Eigen::VectorXd at;
    std::vector<Eigen::Matrix3Xd> places;
  };
  Point last_;  // predicted: derivatives are asked for where the gap was looked at before
};

}  // namespace soft_robot_lab
