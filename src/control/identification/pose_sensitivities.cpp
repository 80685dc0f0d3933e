// SPDX-License-Identifier: BSD-3-Clause
#include "pose_sensitivities.h"

namespace soft_robot_lab {

PoseSensitivities::PoseSensitivities(std::vector<ModelParameter> parameters)
    : count_(static_cast<Eigen::Index>(parameters.size())), parameters_(std::move(parameters)) {
  for (Eigen::Index column = 0; column < count_; ++column) {
    ModelParameter& parameter = parameters_[static_cast<std::size_t>(column)];
    if (parameter.key != "backlash_m") continue;
    parameter.key = "length_offset_m";
    backlashes_.push_back(
        {column, static_cast<Eigen::Index>(parameters_.size()), static_cast<std::size_t>(parameter.actuators.front())});
    const ModelParameter offset = parameter;
    parameters_.push_back(offset);
  }
}

// With D by the length now and H by what slipped before, d marker / d backlash = slope D + H d slipped / d backlash.
// Its column comes as that of a length offset, D + H ..., and the one without a past as D.
void PoseSensitivities::update(Simulation& simulation, const std::vector<double>& slopes) {
  Eigen::MatrixXd all = simulation.parameter_sensitivities(parameters_, slipped_m_);
  for (const Backlash& backlash : backlashes_) {
    const double less = slopes[backlash.actuator] - 1.0;
    all.col(backlash.column) += less * all.col(backlash.offset);
    slipped_m_.col(backlash.column) += less * slipped_m_.col(backlash.offset);
    slipped_m_.col(backlash.offset).setZero();
  }
  jacobian_ = all.leftCols(count_);
}

void PoseSensitivities::forget() { slipped_m_.resize(0, 0); }

}  // namespace soft_robot_lab
