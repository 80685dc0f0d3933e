// SPDX-License-Identifier: BSD-3-Clause
// What a scene says about a list of rest states, one after the other, by drives with play.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/control/identification/fit_model.h"

namespace soft_robot_lab {

struct PosePrediction {
  Eigen::Matrix3Xd markers_m;  // as the pose lists them, robot_base
  Eigen::MatrixXd jacobian;    // 3*markers x parameters; empty where it was not asked for
};

// Where the drives stood, of all actuators in their order.
std::vector<double> commands_of(const Simulation& simulation, const MeasuredPose& pose);

class PoseModel {
 public:
  // Throws std::invalid_argument for names that the scene does not know.
  PoseModel(std::string scene, SceneOptions options, const std::vector<MeasuredPose>& poses);

  using Parameters = std::function<std::vector<ModelParameter>(const Simulation&)>;

  // With the changes laid over the scene. `parameters` may be empty: no derivatives; those of key backlash_m are of one
  // cable's drive. Throws std::runtime_error where a pose has no stable equilibrium, std::invalid_argument for backlash
  // of what commands no length.
  std::vector<PosePrediction> predict(const Overrides& overrides, const Parameters& parameters = {},
                                      const std::map<std::string, double>& backlash_m = {});

 private:
  std::string scene_;
  SceneOptions options_;
  const std::vector<MeasuredPose>& poses_;
  std::vector<SimulationState> last_;  // of the poses: where the next prediction starts, unless the past matters
};

}  // namespace soft_robot_lab
