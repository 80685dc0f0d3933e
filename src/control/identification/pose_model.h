// SPDX-License-Identifier: BSD-3-Clause
// What a scene says about a list of rest states, one after the other.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/control/identification/fit_model.h"

namespace soft_robot_lab {

struct PosePrediction {
  Eigen::Matrix3Xd markers_m;  // as the pose lists them, robot_base
  Eigen::MatrixXd jacobian;    // 3*markers x parameters; empty where it was not asked for
};

class PoseModel {
 public:
  // Throws std::invalid_argument for names that the scene does not know.
  PoseModel(std::string scene, SceneOptions options, const std::vector<MeasuredPose>& poses);

  using Parameters = std::function<std::vector<ModelParameter>(const Simulation&)>;

  // With the changes laid over the scene. `parameters` may be empty: no derivatives. Throws std::runtime_error where a
  // pose has no stable equilibrium.
  std::vector<PosePrediction> predict(const std::string& overrides, const Parameters& parameters = {});

 private:
  std::string scene_;
  SceneOptions options_;
  const std::vector<MeasuredPose>& poses_;
  std::vector<SimulationState> last_;  // of the poses: where the next prediction starts, unless the past matters
};

}  // namespace soft_robot_lab
