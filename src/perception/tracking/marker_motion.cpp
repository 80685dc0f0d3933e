// SPDX-License-Identifier: BSD-3-Clause
#include "marker_motion.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace soft_robot_lab {
namespace {

constexpr double kUnknownVelocity_m_s = 0.1;  // standard deviation

}  // namespace

MarkerMotion::MarkerMotion(const Eigen::Vector3d& position_m, double sigma_m) {
  replace(position_m, sigma_m * sigma_m * Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
}

double MarkerMotion::worst_sigma_m() const {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(position_covariance_m2(), Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, axes.eigenvalues().maxCoeff()));
}

void MarkerMotion::predict(double duration_s, double acceleration_m_s2) {
  const double t = duration_s, variance = acceleration_m_s2 * acceleration_m_s2;
  Covariance step = Covariance::Identity();
  step.topRightCorner<3, 3>() = t * Eigen::Matrix3d::Identity();
  state_ = step * state_;
  covariance_ = step * covariance_ * step.transpose();
  // One acceleration throughout the step.
  covariance_.topLeftCorner<3, 3>().diagonal().array() += variance * t * t * t * t / 4;
  covariance_.topRightCorner<3, 3>().diagonal().array() += variance * t * t * t / 2;
  covariance_.bottomLeftCorner<3, 3>().diagonal().array() += variance * t * t * t / 2;
  covariance_.bottomRightCorner<3, 3>().diagonal().array() += variance * t * t;
}

void MarkerMotion::correct(const FusedSights& measured) {
  // With H = [root, 0] the measurement's errors are independent and of size 1, also where it fixes less than a point.
  Eigen::Matrix<double, 3, 6> gradient = Eigen::Matrix<double, 3, 6>::Zero();
  gradient.leftCols<3>() = measured.information_root;
  const Eigen::Vector3d miss = measured.information_root * (measured.position_m - position_m());
  const Eigen::Matrix3d spread = gradient * covariance_ * gradient.transpose() + Eigen::Matrix3d::Identity();
  const Eigen::Matrix<double, 6, 3> gain = spread.ldlt().solve(gradient * covariance_).transpose();
  state_ += gain * miss;
  // Joseph's form stays positive.
  const Covariance kept = Covariance::Identity() - gain * gradient;
  covariance_ = kept * covariance_ * kept.transpose() + gain * gain.transpose();
}

void MarkerMotion::replace(const Eigen::Vector3d& position_m, const Eigen::Matrix3d& covariance_m2,
                           const Eigen::Vector3d& velocity_m_s) {
  state_ << position_m, velocity_m_s;
  covariance_.setZero();
  covariance_.topLeftCorner<3, 3>() = covariance_m2;
  covariance_.bottomRightCorner<3, 3>().diagonal().setConstant(kUnknownVelocity_m_s * kUnknownVelocity_m_s);
}

}  // namespace soft_robot_lab
