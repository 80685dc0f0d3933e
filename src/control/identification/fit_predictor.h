// SPDX-License-Identifier: BSD-3-Clause
// What a fit predicts of all that was seen.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <ceres/evaluation_callback.h>

#include "fit_parameters.h"
#include "pose_model.h"

namespace soft_robot_lab {

// Predictions at the point where Ceres asks next: all at once, as each pose follows from the one before.
class FitPredictor : public ceres::EvaluationCallback {
 public:
  // May throw std::runtime_error, where a shorter step may do.
  using Predict = std::function<std::vector<PosePrediction>(const Eigen::VectorXd& values, bool derivatives)>;

  // `numbers`: of `parameters` those at rest or in time; `unknowns` are as many, from their start in steps of `size`.
  FitPredictor(const FitParameters& parameters, std::vector<FitNumber> numbers, Predict predict,
               const std::vector<double>& unknowns);

  void PrepareForEvaluation(bool derivatives, bool) override;

  Eigen::VectorXd values() const;
  Eigen::Vector3d measured(std::size_t sight, Eigen::Index marker) const;
  Eigen::Matrix3Xd jacobian(std::size_t sight, Eigen::Index marker) const;  // d measured / d unknown

  // Throws std::runtime_error, `what` before the reason, where nothing is predicted here.
  void require_good(const std::string& what);
  bool good() const { return !now_.sights.empty(); }

  // Where derivatives were last known: the best so far, where a solve failed or was interrupted since.
  const std::vector<double>& last_good() const { return differentiated_.unknowns; }

 private:
  struct Point {
    bool is_at(const Eigen::VectorXd& place) const { return at.size() == place.size() && at == place; }
    Eigen::VectorXd at;
    std::vector<PosePrediction> sights;  // none where there is no equilibrium
    std::vector<double> unknowns = {};
  };

  const FitParameters& parameters_;
  std::vector<FitNumber> numbers_;
  Predict predict_;
  const std::vector<double>& unknowns_;
  Point now_, differentiated_;  // the latter the last with derivatives: where steps in vain come back to
  std::string trouble_;
};

}  // namespace soft_robot_lab
