// SPDX-License-Identifier: BSD-3-Clause
#include "marker_identity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "assignment.h"

namespace soft_robot_lab {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kSpanRatio = 0.1;  // standard deviation of a neighbour's distance over the distance

struct PairCost {
  double distance_2 = kNever;
  double log_spread = 0;
};

PairCost pair_cost(const MarkerDetection& sight, const MarkerPrediction& predicted) {
  if (predicted.colour >= 0 && sight.colour >= 0 && predicted.colour != sight.colour) return {};
  const Eigen::Isometry3d camera_from_world = sight.camera->world_from_camera.inverse();
  const Eigen::Vector3d in_camera = camera_from_world * (predicted.position_m + sight.later_s * predicted.velocity_m_s);
  if (!(in_camera.z() > 0)) return {};
  Eigen::Matrix3d gradient;
  gradient.topRows<2>() = sight.camera->model.project_gradient(in_camera) * camera_from_world.linear();
  gradient.row(2) = camera_from_world.linear().row(2);
  Eigen::Vector3d miss, variance;
  miss << sight.pixel - sight.camera->model.project(in_camera), sight.depth_m ? *sight.depth_m - in_camera.z() : 0;
  // A sight without depth says nothing of it: as one with an error like the prediction's own.
  const double unknown_depth = gradient.row(2) * predicted.covariance_m2 * gradient.row(2).transpose();
  variance << Eigen::Vector2d::Constant(sight.pixel_sigma * sight.pixel_sigma),
      sight.depth_m ? sight.depth_sigma_m * sight.depth_sigma_m : unknown_depth;
  Eigen::Matrix3d spread = gradient * predicted.covariance_m2 * gradient.transpose();
  spread.diagonal() += variance;
  const Eigen::LDLT<Eigen::Matrix3d> factor(spread);
  return {miss.dot(factor.solve(miss)), std::log(spread.determinant())};
}

// The costs, and that of no sight: more than that of any pair within the gate.
struct Costs {
  Eigen::MatrixXd of_pairs;  // marker, sight
  double of_none = 0;
};

Costs all_costs(const std::vector<MarkerDetection>& sights, const std::vector<MarkerPrediction>& predictions,
                double gate) {
  Costs costs{Eigen::MatrixXd::Constant(predictions.size(), sights.size(), kNever), -kNever};
  for (std::size_t i = 0; i < predictions.size(); ++i)
    for (std::size_t k = 0; k < sights.size(); ++k) {
      const PairCost pair = pair_cost(sights[k], predictions[i]);
      if (pair.distance_2 > gate) continue;
      costs.of_pairs(i, k) = pair.distance_2 + pair.log_spread;
      costs.of_none = std::max(costs.of_none, gate + pair.log_spread);
    }
  if (costs.of_none == -kNever) costs.of_none = 0;
  return costs;
}

class Spans {
 public:
  Spans(const std::vector<MarkerDetection>& sights, const std::vector<MarkerPrediction>& predictions,
        const std::vector<std::vector<int>>& neighbours)
      : sights_(sights), predictions_(predictions), neighbours_(neighbours) {
    for (const MarkerDetection& sight : sights)
      points_m_.push_back(sight.depth_m ? sight.point_m() : Eigen::Vector3d::Constant(kNever));
  }

  double cost(const std::vector<int>& sight_of) const {
    double sum = 0;
    for (std::size_t i = 0; i < sight_of.size(); ++i)
      for (const int j : neighbours_[i]) sum += cost_of_span(sight_of, static_cast<int>(i), j);
    return sum;
  }

 private:
  double cost_of_span(const std::vector<int>& sight_of, int i, int j) const {
    const int a = sight_of[i], b = sight_of[j];
    if (a < 0 || b < 0 || !sights_[a].depth_m || !sights_[b].depth_m) return 0;
    const double span_m = (points_m_[a] - points_m_[b]).norm();
    const double expected_m = (predictions_[i].position_m - predictions_[j].position_m).norm();
    const double noise_m = std::hypot(sights_[a].depth_sigma_m, sights_[b].depth_sigma_m);
    return std::pow((span_m - expected_m) / std::hypot(kSpanRatio * expected_m, noise_m), 2);
  }

  const std::vector<MarkerDetection>& sights_;
  const std::vector<MarkerPrediction>& predictions_;
  const std::vector<std::vector<int>>& neighbours_;
  std::vector<Eigen::Vector3d> points_m_;
};

double total_cost(const Costs& costs, const Spans& spans, const std::vector<int>& sight_of) {
  double sum = spans.cost(sight_of);
  for (std::size_t i = 0; i < sight_of.size(); ++i)
    sum += sight_of[i] < 0 ? costs.of_none : costs.of_pairs(static_cast<Eigen::Index>(i), sight_of[i]);
  return sum;
}

// Exchanges what two markers have, one of which may be nothing, until nothing gets better.
void exchange(const Costs& costs, const Spans& spans, std::vector<int>& sight_of) {
  double best = total_cost(costs, spans, sight_of);
  for (bool better = true; better;) {
    better = false;
    for (std::size_t i = 0; i < sight_of.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (sight_of[i] == sight_of[j]) continue;
        std::swap(sight_of[i], sight_of[j]);
        const double cost = total_cost(costs, spans, sight_of);
        if (cost < best - 1e-9) {
          best = cost;
          better = true;
        } else {
          std::swap(sight_of[i], sight_of[j]);
        }
      }
  }
}

}  // namespace

std::vector<int> identify(const std::vector<MarkerDetection>& sights, const std::vector<MarkerPrediction>& predictions,
                          const std::vector<std::vector<int>>& neighbours, double gate) {
  const Costs costs = all_costs(sights, predictions, gate);
  std::vector<int> sight_of = assign(costs.of_pairs, costs.of_none);
  exchange(costs, Spans(sights, predictions, neighbours), sight_of);
  return sight_of;
}

std::vector<std::vector<int>> nearest_neighbours(const std::vector<Eigen::Vector3d>& rest_positions_m, int count) {
  const int markers = static_cast<int>(rest_positions_m.size());
  std::vector<std::vector<int>> neighbours;
  for (int i = 0; i < markers; ++i) {
    std::vector<int> others(markers);
    std::iota(others.begin(), others.end(), 0);
    others.erase(others.begin() + i);
    std::stable_sort(others.begin(), others.end(), [&](int a, int b) {
      return (rest_positions_m[a] - rest_positions_m[i]).norm() < (rest_positions_m[b] - rest_positions_m[i]).norm();
    });
    others.resize(std::min<std::size_t>(others.size(), static_cast<std::size_t>(count)));
    neighbours.push_back(others);
  }
  return neighbours;
}

}  // namespace soft_robot_lab
