// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include <Eigen/Core>

#include "soft_robot_lab/perception/tracking/tracker_settings.h"
#include "detection_fusion.h"

namespace soft_robot_lab {

// Where a marker is believed to be: a Kalman filter of position and velocity, in the world.
class MarkerMotion {
 public:
  using State = Eigen::Matrix<double, 6, 1>;
  using Covariance = Eigen::Matrix<double, 6, 6>;

  MarkerMotion(const Eigen::Vector3d& position_m, double sigma_m);

  Eigen::Vector3d position_m() const { return state_.head<3>(); }
  Eigen::Vector3d velocity_m_s() const { return state_.tail<3>(); }
  Eigen::Matrix3d position_covariance_m2() const { return covariance_.topLeftCorner<3, 3>(); }
  double worst_sigma_m() const;

  // Each of its numbers in turn, to be read or replaced.
  template <typename Visit>
  void visit_numbers(const Visit& visit) {
    std::for_each(state_.data(), state_.data() + state_.size(), visit);
    std::for_each(covariance_.data(), covariance_.data() + covariance_.size(), visit);
  }

  // Time passes: constant velocity, with accelerations nobody foresaw.
  void predict(double duration_s, double acceleration_m_s2);
  // A measurement; what it does not fix keeps the belief.
  void correct(const FusedSights& measured);
  // The belief is replaced by one from elsewhere; the velocity starts anew around the given one.
  void replace(const Eigen::Vector3d& position_m, const Eigen::Matrix3d& covariance_m2,
               const Eigen::Vector3d& velocity_m_s);

 private:
  State state_ = State::Zero();
  Covariance covariance_ = Covariance::Zero();
};

}  // namespace soft_robot_lab
