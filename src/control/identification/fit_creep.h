// SPDX-License-Identifier: BSD-3-Clause
// Creep from how markers go on moving while commands are held, with all other numbers as a fit has found them.
#pragma once

#include <string>
#include <vector>

#include "fit_parameters.h"

namespace soft_robot_lab {

class CreepFit {
 public:
  // `numbers`: FitParameters::creep(). Throws std::invalid_argument where the time that commands were held is not
  // known, or too few markers were seen meanwhile.
  CreepFit(std::string scene, SceneOptions options, const std::vector<MeasuredPose>& poses,
           std::vector<FitNumber> numbers);

  // Finds both numbers for the scene and the backlash that `result` has; goes on from those found before.
  void run(const FitRequest& request, const FitResult& result);

  // The poses as they would be measured after a long time, without creep and without swings on the way.
  std::vector<MeasuredPose> as_at_rest(const FitResult& result) const;

  // Appends the numbers to the values, and writes them into the overrides.
  void finish(FitResult& result) const;

 private:
  std::string scene_;
  SceneOptions options_;
  const std::vector<MeasuredPose>& poses_;
  std::vector<FitNumber> numbers_;
  Eigen::VectorXd values_;
  Eigen::MatrixXd information_;  // of the logarithms
  bool converged_ = false;
  std::string message_;
};

}  // namespace soft_robot_lab
