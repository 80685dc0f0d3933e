// SPDX-License-Identifier: BSD-3-Clause
#include "load_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/LU>

#include "push_cone.h"

namespace soft_robot_lab {
namespace {

ForceQuadratic quadratic_of(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap) {
  return {compliance * compliance.transpose(), compliance * gap};
}

ForceQuadratic with_scale(const ForceQuadratic& quadratic, double scale_n) {
  return {quadratic.h + Eigen::Matrix3d::Identity() / (scale_n * scale_n), quadratic.g};
}

double log_normal(const Eigen::Vector3d& force_n, double scale_n, int components) {
  return -0.5 * force_n.squaredNorm() / (scale_n * scale_n) - components * std::log(std::sqrt(2.0 * M_PI) * scale_n);
}

double log_mean_exp(const std::vector<double>& logs) {
  const double most = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double one : logs) sum += std::exp(one - most);
  return most + std::log(sum / static_cast<double>(logs.size()));
}

Eigen::Vector3d best_force(const ForceQuadratic& quadratic, const LoadPlace& place, const LinearisedLoads& linear,
                           const LoadPrior& prior) {
  if (!place.skin) return best_along(quadratic, prior.down);
  return best_push(quadratic, normal_at(prior.mesh, linear.positions_m, *place.skin), prior.friction_coefficient);
}

}  // namespace

Eigen::MatrixXd LinearisedLoads::compliance_at(const EmbeddedPoint& at) const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3, compliance.cols());
  for (std::size_t k = 0; k < at.nodes.size(); ++k) sum += at.weights[k] * compliance.middleRows<3>(3 * at.nodes[k]);
  return sum;
}

double LoadPrior::log_density(const Eigen::Vector3d& force_n, int components) const {
  std::vector<double> logs;
  for (const double scale_n : force_scales_n) logs.push_back(log_normal(force_n, scale_n, components));
  return log_mean_exp(logs);
}

double LoadPrior::scale_of(const Eigen::Vector3d& force_n, int components) const {
  return *std::max_element(force_scales_n.begin(), force_scales_n.end(), [&](double a, double b) {
    return log_normal(force_n, a, components) < log_normal(force_n, b, components);
  });
}

std::vector<PlaceFit> fit_places(const LinearisedLoads& linear, const Eigen::VectorXd& gap,
                                 const std::vector<LoadPlace>& places, const LoadPrior& prior) {
  std::vector<PlaceFit> fits;
  fits.reserve(places.size());
  std::vector<double> logs(prior.force_scales_n.size());
  for (const LoadPlace& place : places) {
    const ForceQuadratic of_markers = quadratic_of(linear.compliance_at(place.at), gap);
    PlaceFit fit;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < logs.size(); ++i) {
      const double scale_n = prior.force_scales_n[i], variance_n2 = scale_n * scale_n;
      const ForceQuadratic quadratic = with_scale(of_markers, scale_n);
      const Eigen::Vector3d force_n = best_force(quadratic, place, linear, prior);
      const double stiffness = prior.down.dot(quadratic.h * prior.down);
      logs[i] = quadratic.gain(force_n) -
                0.5 * std::log(place.skin ? (variance_n2 * quadratic.h).determinant() : variance_n2 * stiffness);
      if (!(logs[i] > most)) continue;
      most = logs[i];
      fit.force_n = force_n;
      fit.covariance_n2 = quadratic.h.inverse();
      if (!place.skin) fit.covariance_n2 = prior.down * prior.down.transpose() / stiffness;
    }
    fit.log_evidence = log_mean_exp(logs);
    fits.push_back(fit);
  }
  return fits;
}

std::vector<std::size_t> best_apart(const std::vector<PlaceFit>& fits, const std::vector<LoadPlace>& places,
                                    const TetMesh& mesh, double apart_m, std::size_t count) {
  std::vector<std::size_t> order(fits.size()), chosen;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return fits[a].log_evidence > fits[b].log_evidence; });
  for (const std::size_t candidate : order) {
    if (chosen.size() == count) break;
    const Eigen::Vector3d at_m = places[candidate].at.at(mesh.nodes_m);
    const bool near = std::any_of(chosen.begin(), chosen.end(), [&](std::size_t other) {
      return (places[other].at.at(mesh.nodes_m) - at_m).norm() < apart_m;
    });
    if (!near) chosen.push_back(candidate);
  }
  return chosen;
}

double log_mean_evidence(const std::vector<PlaceFit>& fits, const std::vector<LoadPlace>& places) {
  double most = -std::numeric_limits<double>::infinity(), sum = 0.0;
  for (const PlaceFit& fit : fits) most = std::max(most, fit.log_evidence);
  for (std::size_t i = 0; i < fits.size(); ++i) sum += places[i].share * std::exp(fits[i].log_evidence - most);
  return most + std::log(sum);
}

std::vector<double> place_probabilities(const std::vector<PlaceFit>& fits, const std::vector<LoadPlace>& places) {
  const double log_sum = log_mean_evidence(fits, places);
  std::vector<double> probabilities;
  for (std::size_t i = 0; i < fits.size(); ++i)
    probabilities.push_back(places[i].share * std::exp(fits[i].log_evidence - log_sum));
  return probabilities;
}

std::vector<std::size_t> best_pair(const LinearisedLoads& linear, const std::vector<LoadPlace>& places,
                                   const std::vector<std::size_t>& firsts, std::size_t stride, const LoadPrior& prior) {
  constexpr int kSweeps = 4;  // in turns, each force given the other
  struct First {
    std::size_t place;
    Eigen::MatrixXd compliance;
    ForceQuadratic quadratic;
  };
  const double largest_n = *std::max_element(prior.force_scales_n.begin(), prior.force_scales_n.end());
  std::vector<First> ones;
  for (const std::size_t first : firsts) {
    const Eigen::MatrixXd compliance = linear.compliance_at(places[first].at);
    ones.push_back({first, compliance, with_scale(quadratic_of(compliance, linear.gap), largest_n)});
  }
  std::vector<std::size_t> best;
  double most = 0.0;
  for (std::size_t second = 0; second < places.size(); second += stride) {
    const Eigen::MatrixXd of_second = linear.compliance_at(places[second].at);
    const ForceQuadratic two = with_scale(quadratic_of(of_second, linear.gap), largest_n);
    for (const First& one : ones) {
      if (one.place == second) continue;
      const Eigen::Matrix3d coupling = one.compliance * of_second.transpose();
      Eigen::Vector3d f_one = Eigen::Vector3d::Zero(), f_two = Eigen::Vector3d::Zero();
      for (int sweep = 0; sweep < kSweeps; ++sweep) {
        f_one = best_force({one.quadratic.h, one.quadratic.g - coupling * f_two}, places[one.place], linear, prior);
        f_two = best_force({two.h, two.g - coupling.transpose() * f_one}, places[second], linear, prior);
      }
      const double gain = one.quadratic.gain(f_one) + two.gain(f_two) - f_one.dot(coupling * f_two);
      if (!(gain > most)) continue;
      most = gain;
      best = {one.place, second};
    }
  }
  return best;
}

}  // namespace soft_robot_lab
