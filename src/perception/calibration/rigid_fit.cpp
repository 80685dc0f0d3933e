// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_fit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Eigenvalues>

namespace soft_robot_lab {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double min_width_m = 0.005;
constexpr double default_sigma_m = 0.001;
constexpr int max_iterations = 50;

Eigen::Matrix3Xd firsts(const std::vector<PointPair>& pairs) {
  Eigen::Matrix3Xd points_m(3, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) points_m.col(static_cast<Eigen::Index>(i)) = pairs[i].first_m;
  return points_m;
}

Eigen::Matrix3Xd seconds(const std::vector<PointPair>& pairs) {
  Eigen::Matrix3Xd points_m(3, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) points_m.col(static_cast<Eigen::Index>(i)) = pairs[i].second_m;
  return points_m;
}

void require_shape(const Eigen::Matrix3Xd& points_m) {
  if (!points_m.allFinite()) throw std::invalid_argument("a point is not finite; allowed: positions in metres");
  const Eigen::Matrix3Xd spread = points_m.colwise() - points_m.rowwise().mean();
  const Eigen::Matrix3d scatter_m2 = spread * spread.transpose() / static_cast<double>(points_m.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter_m2, Eigen::EigenvaluesOnly);
  const double width_m = std::sqrt(std::max(axes.eigenvalues()[1], 0.0));
  if (!(width_m >= min_width_m))
    throw std::invalid_argument("the points lie on a line within " + std::to_string(1000 * width_m) +
                                " mm: nothing fixes the turn about it; allowed: " + std::to_string(1000 * min_width_m) +
                                " mm or more to its side");
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

struct NormalEquations {
  Matrix6d matrix = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
};

// Of the step (turn, shift) that moves second points, as the first frame has them, about `middle`.
NormalEquations normal_equations(const std::vector<PointPair>& pairs, const Eigen::Isometry3d& first_from_second,
                                 const Eigen::Vector3d& middle_m) {
  NormalEquations sum;
  for (const PointPair& pair : pairs) {
    const Eigen::Vector3d moved_m = first_from_second * pair.second_m;
    const Eigen::Matrix3d turn = first_from_second.linear();
    Eigen::Matrix3d covariance = pair.first_covariance_m2 + turn * pair.second_covariance_m2 * turn.transpose();
    if (covariance.isZero(0)) covariance = default_sigma_m * default_sigma_m * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d weight = covariance.inverse();
    Eigen::Matrix<double, 3, 6> slope;
    slope << -cross_matrix(moved_m - middle_m), Eigen::Matrix3d::Identity();
    sum.matrix += slope.transpose() * weight * slope;
    sum.right += slope.transpose() * weight * (pair.first_m - moved_m);
  }
  return sum;
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Vector6d& step, const Eigen::Vector3d& middle_m) {
  const Eigen::Vector3d turn = step.head<3>();
  const double angle = turn.norm();
  Eigen::Isometry3d small = Eigen::Isometry3d::Identity();
  if (angle > 0) small.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  return Eigen::Translation3d(middle_m + step.tail<3>()) * small * Eigen::Translation3d(-middle_m) * pose;
}

}  // namespace

RigidFit fit_rigid(const std::vector<PointPair>& pairs) {
  if (pairs.size() < 3)
    throw std::invalid_argument("there are " + std::to_string(pairs.size()) + " points; allowed: 3 or more");
  const Eigen::Matrix3Xd first_m = firsts(pairs), second_m = seconds(pairs);
  require_shape(first_m);
  require_shape(second_m);
  RigidFit fit;
  fit.first_from_second.matrix() = Eigen::umeyama(second_m, first_m, false);
  const Eigen::Vector3d middle_m = first_m.rowwise().mean();
  for (int i = 0; i < max_iterations; ++i) {
    const NormalEquations equations = normal_equations(pairs, fit.first_from_second, middle_m);
    const Eigen::LDLT<Matrix6d> factor(equations.matrix);
    const Vector6d step = factor.solve(equations.right);
    if (!step.allFinite()) throw std::invalid_argument("a point's covariance is not finite and positive");
    fit.first_from_second = moved(fit.first_from_second, step, middle_m);
    fit.covariance = factor.solve(Matrix6d::Identity());
    if (step.norm() < 1e-12) break;
  }
  fit.first_from_second.linear() = Eigen::Quaterniond(fit.first_from_second.linear()).normalized().toRotationMatrix();
  fit.residual_m = std::sqrt((first_m - fit.first_from_second * second_m).colwise().squaredNorm().mean());
  return fit;
}

}  // namespace soft_robot_lab
