// SPDX-License-Identifier: BSD-3-Clause
#include "perception/calibration/rigid_fit.h"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

Eigen::Isometry3d motion_of_a_camera() {
  return Eigen::Translation3d(0.1, -0.4, 0.6) * Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized());
}

std::vector<PointPair> exact_pairs(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> coordinate(-0.15, 0.15);
  std::vector<PointPair> pairs(static_cast<std::size_t>(count));
  for (PointPair& pair : pairs) {
    pair.second_m = Eigen::Vector3d(0, 0, 0.6) + Eigen::Vector3d::NullaryExpr([&] { return coordinate(random); });
    pair.first_m = motion_of_a_camera() * pair.second_m;
  }
  return pairs;
}

// Five times as uncertain along z as across.
void add_depth_noise(std::vector<PointPair>& pairs, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::Vector3d sigma_m(0.0002, 0.0002, 0.002);
  for (PointPair& pair : pairs) {
    pair.second_m += sigma_m.cwiseProduct(Eigen::Vector3d::NullaryExpr([&] { return normal(random); }));
    pair.second_covariance_m2 = sigma_m.cwiseAbs2().asDiagonal();
  }
}

double turn_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

TEST(RigidFit, RecoversAnExactMotion) {
  std::mt19937 random(1);
  for (int count : {3, 5, 9}) {
    const RigidFit fit = fit_rigid(exact_pairs(random, count));
    EXPECT_TRUE(fit.first_from_second.isApprox(motion_of_a_camera(), 1e-12));
    EXPECT_LT(fit.residual_m, 1e-12);
  }
}

TEST(RigidFit, TrustsDepthLessThanDirection) {
  std::mt19937 random(2);
  double weighted = 0, unweighted = 0;
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<PointPair> pairs = exact_pairs(random, 5);
    add_depth_noise(pairs, random);
    weighted += std::pow(turn_between(fit_rigid(pairs).first_from_second, motion_of_a_camera()), 2);
    for (PointPair& pair : pairs) pair.second_covariance_m2.setZero();
    unweighted += std::pow(turn_between(fit_rigid(pairs).first_from_second, motion_of_a_camera()), 2);
  }
  EXPECT_LT(weighted, 0.25 * unweighted);
}

TEST(RigidFit, KnowsHowWrongItIs) {
  std::mt19937 random(3);
  double sum = 0;
  constexpr int trials = 200;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<PointPair> pairs = exact_pairs(random, 5);
    Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
    for (const PointPair& pair : pairs) middle_m += pair.first_m / static_cast<double>(pairs.size());
    add_depth_noise(pairs, random);
    const RigidFit fit = fit_rigid(pairs);
    const Eigen::Isometry3d miss = fit.first_from_second * motion_of_a_camera().inverse();
    const Eigen::AngleAxisd turn(miss.linear());
    Eigen::Matrix<double, 6, 1> error;
    error << turn.angle() * turn.axis(), miss * middle_m - middle_m;
    sum += error.dot(fit.covariance.inverse() * error);
  }
  EXPECT_NEAR(sum / trials, 6, 0.8);  // chi-square of six degrees of freedom
}

TEST(RigidFit, NeverMirrors) {
  std::mt19937 random(4);
  std::vector<PointPair> pairs = exact_pairs(random, 5);
  for (PointPair& pair : pairs) pair.first_m.x() *= -1;
  const RigidFit fit = fit_rigid(pairs);
  EXPECT_NEAR(fit.first_from_second.linear().determinant(), 1, 1e-12);
  EXPECT_GT(fit.residual_m, 0.01);
}

TEST(RigidFit, DoesPointsInAPlane) {
  std::mt19937 random(5);
  std::vector<PointPair> pairs = exact_pairs(random, 4);
  for (PointPair& pair : pairs) {
    pair.second_m.z() = 0.6;
    pair.first_m = motion_of_a_camera() * pair.second_m;
  }
  EXPECT_TRUE(fit_rigid(pairs).first_from_second.isApprox(motion_of_a_camera(), 1e-9));
}

TEST(RigidFit, RefusesWhatTellsNoMotion) {
  std::mt19937 random(6);
  std::vector<PointPair> line = exact_pairs(random, 5), few = exact_pairs(random, 2), absurd = exact_pairs(random, 5);
  for (std::size_t i = 0; i < line.size(); ++i) {
    line[i].second_m = Eigen::Vector3d(0.05 * static_cast<double>(i), 0.001 * static_cast<double>(i % 2), 0.6);
    line[i].first_m = motion_of_a_camera() * line[i].second_m;
  }
  absurd[2].first_m.x() = std::numeric_limits<double>::quiet_NaN();
  for (const auto& pairs : {line, few, absurd}) EXPECT_THROW(fit_rigid(pairs), std::invalid_argument);
  std::vector<PointPair> wrong_covariance = exact_pairs(random, 5);
  wrong_covariance[0].first_covariance_m2.setConstant(std::numeric_limits<double>::infinity());
  EXPECT_THROW(fit_rigid(wrong_covariance), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
