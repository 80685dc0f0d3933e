// SPDX-License-Identifier: BSD-3-Clause
#include "ball_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <ceres/ceres.h>

namespace soft_robot_lab {
namespace {

// Parameters: centre (3), radius, outline bias.
constexpr int centre_at = 0, radius_at = 3, bias_at = 4, parameter_count = 5;
constexpr double outlier_sigmas = 2.5;

template <typename T>
T dot(const Eigen::Vector3d& ray, const T* centre) {
  return ray.x() * centre[0] + ray.y() * centre[1] + ray.z() * centre[2];
}

template <typename T>
T squared_norm(const T* centre) {
  return centre[0] * centre[0] + centre[1] * centre[1] + centre[2] * centre[2];
}

struct DepthMiss {
  Eigen::Vector3d point_m;
  double sigma_m;

  template <typename T>
  bool operator()(const T* parameters, T* residual) const {
    const Eigen::Vector3d ray = point_m / point_m.z();
    const T along = dot(ray, parameters + centre_at), radius = parameters[radius_at];
    const T root2 = along * along - ray.squaredNorm() * (squared_norm(parameters + centre_at) - radius * radius);
    // A ray that misses the sphere is given the depth where it comes nearest.
    const T root = root2 > T(1e-12) ? sqrt(root2) : T(0);
    residual[0] = ((along - root) / ray.squaredNorm() - point_m.z()) / sigma_m;
    return true;
  }
};

struct OutlineMiss {
  Eigen::Vector3d ray;  // of unit length
  double sigma;

  template <typename T>
  bool operator()(const T* parameters, T* residual) const {
    const T distance = sqrt(squared_norm(parameters + centre_at));
    const T along = dot(ray, parameters + centre_at);
    const T aside = sqrt(distance * distance - along * along);
    residual[0] = (atan2(aside, along) - asin(parameters[radius_at] / distance) - parameters[bias_at]) / sigma;
    return true;
  }
};

struct Belief {
  int parameter;
  double value, sigma;

  template <typename T>
  bool operator()(const T* parameters, T* residual) const {
    residual[0] = (parameters[parameter] - value) / sigma;
    return true;
  }
};

template <typename Miss>
ceres::CostFunction* cost(const Miss& miss) {
  return new ceres::AutoDiffCostFunction<Miss, 1, parameter_count>(new Miss(miss));
}

template <typename Miss>
double evaluate(const Miss& miss, const double* parameters) {
  double residual;
  miss(parameters, &residual);
  return residual;
}

double root_mean_square(double sum, Eigen::Index count) {
  return std::sqrt(sum / static_cast<double>(std::max<Eigen::Index>(1, count)));
}

Eigen::Matrix3d centre_covariance(ceres::Problem& problem) {
  ceres::CRSMatrix sparse;
  problem.Evaluate({}, nullptr, nullptr, nullptr, &sparse);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, parameter_count, Eigen::RowMajor>;
  const Eigen::Map<const RowMajor> jacobian(sparse.values.data(), sparse.num_rows, parameter_count);
  const Eigen::Matrix<double, parameter_count, parameter_count> normal = jacobian.transpose() * jacobian;
  return normal.inverse().topLeftCorner<3, 3>();
}

}  // namespace

BallFit fit_ball(const BallMeasurement& measured, const Eigen::Vector3d& center_m, double radius_m,
                 double radius_sigma_m) {
  double parameters[parameter_count] = {center_m.x(), center_m.y(), center_m.z(), radius_m, 0};
  ceres::Problem problem;
  auto* robust = new ceres::HuberLoss(outlier_sigmas);  // the problem owns it, once
  for (Eigen::Index i = 0; i < measured.points_m.cols(); ++i)
    problem.AddResidualBlock(cost(DepthMiss{measured.points_m.col(i), measured.depth_sigmas_m[i]}), robust, parameters);
  for (const auto& ray : measured.outline.colwise())
    problem.AddResidualBlock(cost(OutlineMiss{ray.normalized(), measured.outline_sigma}), robust, parameters);
  problem.AddResidualBlock(cost(Belief{radius_at, radius_m, radius_sigma_m}), nullptr, parameters);
  problem.AddResidualBlock(cost(Belief{bias_at, 0, measured.outline_bias_sigma}), nullptr, parameters);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-10;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  BallFit fit;
  fit.center_m = Eigen::Map<const Eigen::Vector3d>(parameters);
  fit.radius_m = parameters[radius_at];
  fit.covariance_m2 = centre_covariance(problem);
  double depth_sum = 0, outline_sum = 0;
  for (const auto& point : measured.points_m.colwise())
    depth_sum += std::pow(evaluate(DepthMiss{point, 1}, parameters), 2);
  for (const auto& ray : measured.outline.colwise())
    outline_sum += std::pow(evaluate(OutlineMiss{ray.normalized(), 1}, parameters), 2);
  fit.depth_residual_m = root_mean_square(depth_sum, measured.points_m.cols());
  fit.outline_residual = root_mean_square(outline_sum, measured.outline.cols());
  return fit;
}

}  // namespace soft_robot_lab
