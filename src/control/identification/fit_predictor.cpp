// SPDX-License-Identifier: BSD-3-Clause
#include "fit_predictor.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace soft_robot_lab {

FitPredictor::FitPredictor(const FitParameters& parameters, std::vector<FitNumber> numbers, Predict predict,
                           const std::vector<double>& unknowns)
    : parameters_(parameters), numbers_(std::move(numbers)), predict_(std::move(predict)), unknowns_(unknowns) {}

void FitPredictor::PrepareForEvaluation(bool derivatives, bool) {
  const Eigen::VectorXd asked = values();
  if (differentiated_.is_at(asked)) now_ = differentiated_;
  if (now_.is_at(asked) && (!derivatives || differentiated_.is_at(asked))) return;
  now_ = {asked, {}, unknowns_};
  try {
    now_.sights = predict_(asked, derivatives);
    if (derivatives) differentiated_ = now_;
  } catch (const std::runtime_error& error) {
    trouble_ = error.what();
  }
}

Eigen::VectorXd FitPredictor::values() const {
  Eigen::VectorXd all(static_cast<Eigen::Index>(numbers_.size()));
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    const FitNumber& number = numbers_[i];
    all[static_cast<Eigen::Index>(i)] = std::clamp(number.start + unknowns_[i] * number.size, number.min, number.max);
  }
  return all;
}

Eigen::Vector3d FitPredictor::measured(std::size_t sight, Eigen::Index marker) const {
  return parameters_.measured_from_base(now_.at) * now_.sights[sight].markers_m.col(marker);
}

Eigen::Matrix3Xd FitPredictor::jacobian(std::size_t sight, Eigen::Index marker) const {
  const PosePrediction& here = now_.sights[sight];
  return parameters_.measured_jacobian(now_.at, here.markers_m.col(marker), here.jacobian.middleRows<3>(3 * marker));
}

void FitPredictor::require_good(const std::string& what) {
  PrepareForEvaluation(true, true);
  if (!good()) throw std::runtime_error(what + trouble_);
}

}  // namespace soft_robot_lab
