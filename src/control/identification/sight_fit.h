// SPDX-License-Identifier: BSD-3-Clause
// Least squares of sights of markers, at rest or in time.
#pragma once

#include <string>
#include <vector>

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include "fit_predictor.h"

namespace soft_robot_lab {

// A marker as predicted at one sight.
struct SeenAt {
  std::size_t sight;
  Eigen::Index marker;
};

class SightFit {
 public:
  // As FitPredictor. `unknowns` are where it starts, and then what it found.
  SightFit(const FitParameters& parameters, std::vector<FitNumber> numbers, FitPredictor::Predict predict,
           std::vector<double>& unknowns);

  // Asks that the parts, each with its share, sum up to `measured_m`; `weight` makes what they miss one of unit
  // deviation.
  void add(std::vector<SeenAt> parts, Eigen::VectorXd shares, const Eigen::Vector3d& measured_m,
           const Eigen::Matrix3d& weight);

  // Without values and overrides; the first sights are of the poses' markers. Throws std::invalid_argument where too
  // little was added, std::runtime_error where the start or the end predicts nothing.
  FitResult solve(const std::vector<MeasuredPose>& poses, const FitRequest& request);

  // At the end, in standard deviations by `size`.
  const Eigen::MatrixXd& jacobian() const { return jacobian_; }
  const std::vector<double>& residuals() const { return residuals_; }
  // By how much each residual counts there, in (0, 1]: less where it lies far beyond the others.
  const Eigen::VectorXd& robust_shares() const { return robust_shares_; }
  Eigen::VectorXd values() const { return predictor_.values(); }

 private:
  std::vector<FitNumber> numbers_;
  std::vector<double>& unknowns_;
  FitPredictor predictor_;
  ceres::LossFunctionWrapper loss_{nullptr, ceres::TAKE_OWNERSHIP};
  ceres::Problem problem_;
  Eigen::MatrixXd jacobian_;
  std::vector<double> residuals_;
  Eigen::VectorXd robust_shares_;
};

}  // namespace soft_robot_lab
