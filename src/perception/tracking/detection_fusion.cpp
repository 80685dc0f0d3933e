// SPDX-License-Identifier: BSD-3-Clause
#include "detection_fusion.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace soft_robot_lab {
namespace {

struct NormalEquations {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double misfit = 0;
};

// False behind the camera.
bool add(const MarkerDetection& sight, const Eigen::Vector3d& position_m, NormalEquations& equations) {
  const Eigen::Matrix3d camera_from_world = sight.camera->world_from_camera.linear().transpose();
  const Eigen::Vector3d in_camera = camera_from_world * (position_m - sight.camera->world_from_camera.translation());
  constexpr double kNearest_m = 1e-3;
  if (!(in_camera.z() > kNearest_m)) return false;
  const CameraModel& model = sight.camera->model;
  const Eigen::Vector2d miss = (sight.pixel - model.project(in_camera)) / sight.pixel_sigma;
  const Eigen::Matrix<double, 2, 3> gradient =
      model.project_gradient(in_camera) * camera_from_world / sight.pixel_sigma;
  equations.information += gradient.transpose() * gradient;
  equations.right += gradient.transpose() * miss;
  equations.misfit += miss.squaredNorm();
  if (!sight.depth_m) return true;
  const double depth_miss = (*sight.depth_m - in_camera.z()) / sight.depth_sigma_m;
  const Eigen::RowVector3d depth_gradient = camera_from_world.row(2) / sight.depth_sigma_m;
  equations.information += depth_gradient.transpose() * depth_gradient;
  equations.right += depth_gradient.transpose() * depth_miss;
  equations.misfit += depth_miss * depth_miss;
  return true;
}

// The information's axes and the lengths along them; lengths too small to mean anything are 0.
struct Axes {
  Eigen::Matrix3d directions;
  Eigen::Vector3d informations;

  explicit Axes(const Eigen::Matrix3d& information) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(information);
    directions = solver.eigenvectors();
    const double least = 1e-7 * solver.eigenvalues().maxCoeff();
    informations = solver.eigenvalues().unaryExpr([least](double value) { return value > least ? value : 0; });
  }
  Eigen::Vector3d step(const Eigen::Vector3d& right) const {
    const Eigen::Vector3d inverse = informations.unaryExpr([](double value) { return value > 0 ? 1 / value : 0; });
    return directions * inverse.cwiseProduct(directions.transpose() * right);
  }
  Eigen::Matrix3d root() const { return informations.cwiseSqrt().asDiagonal() * directions.transpose(); }
};

struct Choice {
  FusedSights fused;
  double score;
};

void add_choice(const std::vector<MarkerDetection>& sights, const MarkerPrediction& predicted, double handicap,
                std::vector<Choice>& choices) {
  if (sights.empty()) return;
  if (const auto fused = fuse(sights, predicted))
    choices.push_back({*fused, fused->misfit + surprise(*fused, predicted) + handicap});
}

}  // namespace

std::optional<FusedSights> fuse(const std::vector<MarkerDetection>& sights, const MarkerPrediction& predicted) {
  constexpr double kStill_m = 1e-8;
  FusedSights fused;
  fused.position_m = predicted.position_m;
  fused.cameras = static_cast<int>(sights.size());
  for (int iteration = 0; iteration < 15; ++iteration) {
    NormalEquations equations;
    for (const MarkerDetection& sight : sights)
      if (!add(sight, fused.position_m + sight.later_s * predicted.velocity_m_s, equations)) return std::nullopt;
    const Axes axes(equations.information);
    const Eigen::Vector3d step_m = axes.step(equations.right);
    if (!step_m.allFinite()) return std::nullopt;
    if (step_m.norm() < kStill_m) {
      fused.misfit = equations.misfit;
      fused.information_root = axes.root();
      return fused;
    }
    fused.position_m += step_m;
  }
  return std::nullopt;
}

double surprise(const FusedSights& fused, const MarkerPrediction& predicted) {
  const Eigen::Vector3d miss = fused.information_root * (fused.position_m - predicted.position_m);
  const Eigen::Matrix3d spread = fused.information_root * predicted.covariance_m2 * fused.information_root.transpose() +
                                 Eigen::Matrix3d::Identity();
  return miss.dot(spread.ldlt().solve(miss));
}

std::vector<FusedSights> fuse_what_agrees(const std::vector<MarkerDetection>& sights, const MarkerPrediction& predicted,
                                          double gate) {
  std::vector<Choice> choices;
  add_choice(sights, predicted, 0, choices);
  if (!choices.empty() && choices.front().score <= gate) return {choices.front().fused};
  // Fewer measurements contradict each other less: leaving one out has to gain more than its usual part.
  constexpr double kDepthHandicap = 4, kPixelHandicap = 5;
  for (std::size_t left_out = 0; left_out < sights.size(); ++left_out) {
    std::vector<MarkerDetection> fewer = sights;
    if (fewer[left_out].depth_m) {
      fewer[left_out].depth_m.reset();
      add_choice(fewer, predicted, kDepthHandicap, choices);
    }
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(left_out));
    add_choice(fewer, predicted, kPixelHandicap + (sights[left_out].depth_m ? kDepthHandicap : 0), choices);
  }
  std::stable_sort(choices.begin(), choices.end(), [](const Choice& a, const Choice& b) { return a.score < b.score; });
  std::vector<FusedSights> agreeing;
  for (const Choice& choice : choices)
    if (choice.score <= gate) agreeing.push_back(choice.fused);
  return agreeing;
}

}  // namespace soft_robot_lab
