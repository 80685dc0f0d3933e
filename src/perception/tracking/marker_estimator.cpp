// SPDX-License-Identifier: BSD-3-Clause
#include "marker_estimator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

#include "marker_identity.h"

namespace soft_robot_lab {
namespace {

constexpr int kNeighbours = 2;
constexpr double kSpread_m = 1e-3;  // of weights of neighbours in the same place

}  // namespace

MarkerEstimator::MarkerEstimator(const MotionSettings& settings, const std::vector<Eigen::Vector3d>& rest_positions_m,
                                 const std::vector<int>& colours)
    : settings_(settings),
      rest_m_(rest_positions_m),
      colours_(colours),
      neighbours_(nearest_neighbours(rest_positions_m, kNeighbours)),
      reference_m_(rest_positions_m) {
  restart();
}

void MarkerEstimator::restart() {
  time_s_.reset();
  beliefs_.clear();
  for (const Eigen::Vector3d& position_m : reference_m_) {
    const MarkerMotion motion(position_m, settings_.start_sigma_m);
    beliefs_.push_back({motion, 0, -std::numeric_limits<double>::infinity(), {reference_m_, reference_m_}, motion});
  }
}

// Each number of the state in turn, to be read or replaced.
template <typename Visit>
void MarkerEstimator::visit_numbers(const Visit& visit) {
  const auto visit_all = [&](std::vector<Eigen::Vector3d>& points_m) {
    for (Eigen::Vector3d& point_m : points_m) std::for_each(point_m.data(), point_m.data() + point_m.size(), visit);
  };
  double is_started = started() ? 1 : 0, time_s = time_s_.value_or(0), is_simulated = simulated_ ? 1 : 0;
  for (double* number : {&is_started, &time_s, &is_simulated}) visit(*number);
  time_s_ = is_started != 0 ? std::optional(time_s) : std::nullopt;
  simulated_ = is_simulated != 0;
  visit_all(reference_m_);
  for (Belief& belief : beliefs_) {
    double cameras = belief.cameras;
    visit(cameras);
    belief.cameras = static_cast<int>(cameras);
    visit(belief.last_seen_s);
    belief.motion.visit_numbers(visit);
    belief.motion_when_seen.visit_numbers(visit);
    visit_all(belief.shape_when_seen.believed_m);
    visit_all(belief.shape_when_seen.reference_m);
  }
}

std::vector<double> MarkerEstimator::state() const {
  std::vector<double> state;
  MarkerEstimator(*this).visit_numbers([&](double number) { state.push_back(number); });
  return state;
}

void MarkerEstimator::set_state(const std::vector<double>& state) {
  const std::size_t expected = this->state().size();
  if (state.size() != expected)
    throw std::invalid_argument("tracker: a state of " + std::to_string(state.size()) + " numbers; allowed: " +
                                std::to_string(expected) + " for " + std::to_string(rest_m_.size()) + " markers");
  if (std::any_of(state.begin(), state.end(), [](double number) { return std::isnan(number); }))
    throw std::invalid_argument("tracker: a state that holds NaN; allowed: numbers");
  auto next = state.begin();
  visit_numbers([&](double& number) { number = *next++; });
}

bool MarkerEstimator::lost(std::size_t marker) const {
  return !(*time_s_ - beliefs_[marker].last_seen_s <= settings_.lost_after_s);
}

void MarkerEstimator::advance(double to_s) {
  const double duration_s = time_s_ ? std::max(0.0, to_s - *time_s_) : 0;
  const double now_s = time_s_ ? *time_s_ + duration_s : to_s;
  time_s_ = now_s;
  bool all_lost = true;
  for (std::size_t i = 0; i < beliefs_.size(); ++i) all_lost &= lost(i);
  if (all_lost) {
    restart();
    time_s_ = now_s;
  }
  for (Belief& belief : beliefs_) belief.motion.predict(duration_s, settings_.acceleration_m_s2);
  expect_hidden();
}

std::vector<MarkerPrediction> MarkerEstimator::predictions() const {
  std::vector<MarkerPrediction> predictions;
  for (std::size_t i = 0; i < beliefs_.size(); ++i) {
    const MarkerMotion& motion = beliefs_[i].motion;
    MarkerPrediction expected{motion.position_m(), motion.velocity_m_s(), motion.position_covariance_m2(), colours_[i]};
    if (simulated_) {  // a second measurement, that is off by what simulations are off
      const double variance_m2 = settings_.start_sigma_m * settings_.start_sigma_m;
      const Eigen::Matrix3d spread = expected.covariance_m2 + variance_m2 * Eigen::Matrix3d::Identity();
      const Eigen::Matrix3d gain = spread.ldlt().solve(expected.covariance_m2).transpose();
      expected.position_m += gain * (reference_m_[i] - expected.position_m);
      expected.covariance_m2 = variance_m2 * gain;
    }
    predictions.push_back(expected);
  }
  return predictions;
}

void MarkerEstimator::correct(const std::vector<std::vector<MarkerDetection>>& sights) {
  const std::vector<MarkerPrediction> expected = predictions();
  const std::vector<Belief> before = beliefs_;
  std::vector<double> surprises(beliefs_.size(), 0);
  for (std::size_t i = 0; i < beliefs_.size(); ++i) {
    Belief& belief = beliefs_[i];
    belief.cameras = 0;
    for (const FusedSights& fused : fuse_what_agrees(sights[i], expected[i], settings_.gate)) {
      MarkerMotion corrected = belief.motion;
      corrected.correct(fused);
      if (!(corrected.worst_sigma_m() <= settings_.seen_sigma_m)) continue;
      belief.motion = corrected;
      belief.cameras = fused.cameras;
      surprises[i] = surprise(fused, expected[i]);
      break;
    }
  }
  forget_stretched(before, surprises);
  for (Belief& belief : beliefs_) {
    if (belief.cameras == 0) continue;
    belief.last_seen_s = *time_s_;
    belief.shape_when_seen = shape();
    belief.motion_when_seen = belief.motion;
  }
  expect_hidden();
}

// Of two neighbours farther apart, or nearer, than silicone stretches, the one that surprised more was not seen.
void MarkerEstimator::forget_stretched(const std::vector<Belief>& before, const std::vector<double>& surprises) {
  for (std::size_t i = 0; i < beliefs_.size(); ++i)
    for (const int neighbour : neighbours_[i]) {
      const auto j = static_cast<std::size_t>(neighbour);
      if (beliefs_[i].cameras == 0 || beliefs_[j].cameras == 0) continue;
      const double span_m = (beliefs_[i].motion.position_m() - beliefs_[j].motion.position_m()).norm();
      const double usual_m = (reference_m_[i] - reference_m_[j]).norm();
      if (std::abs(span_m - usual_m) <= settings_.max_stretch * usual_m) continue;
      const std::size_t worse = surprises[i] > surprises[j] ? i : j;
      beliefs_[worse] = before[worse];
      beliefs_[worse].cameras = 0;
    }
}

void MarkerEstimator::expect_hidden() {
  const MarkerShape now = shape();
  std::vector<Belief> expected = beliefs_;
  for (std::size_t i = 0; i < beliefs_.size(); ++i)
    if (beliefs_[i].cameras == 0) expected[i] = expected_hidden(i, now);
  beliefs_ = std::move(expected);
}

MarkerEstimator::Belief MarkerEstimator::expected_hidden(std::size_t marker, const MarkerShape& now) const {
  Belief belief = beliefs_[marker];
  const bool ever_seen = std::isfinite(belief.last_seen_s);
  const double hidden_s = ever_seen ? std::min(*time_s_ - belief.last_seen_s, settings_.lost_after_s) : 0;
  std::vector<double> weights(beliefs_.size(), 0);
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
  double sum = 0;
  for (std::size_t j = 0; j < beliefs_.size(); ++j) {
    if (beliefs_[j].cameras == 0) continue;
    weights[j] = 1 / ((rest_m_[marker] - rest_m_[j]).squaredNorm() + kSpread_m * kSpread_m);
    velocity_m_s += weights[j] * beliefs_[j].motion.velocity_m_s();
    sum += weights[j];
  }
  HiddenEstimate estimate =
      estimate_hidden(static_cast<int>(marker), belief.shape_when_seen, now, weights, hidden_s, settings_);
  if (sum > 0) {
    velocity_m_s /= sum;
  } else {  // it coasts to a halt
    const Eigen::Vector3d last_m_s = belief.motion_when_seen.velocity_m_s();
    const double decay_s = settings_.velocity_decay_s;
    estimate.position_m += decay_s * (1 - std::exp(-hidden_s / decay_s)) * last_m_s;
    estimate.sigma_m = std::hypot(estimate.sigma_m, hidden_s * last_m_s.norm());
  }
  const double variance_m2 = estimate.sigma_m * estimate.sigma_m;
  belief.motion.replace(estimate.position_m,
                        belief.motion_when_seen.position_covariance_m2() + variance_m2 * Eigen::Matrix3d::Identity(),
                        velocity_m_s);
  return belief;
}

MarkerShape MarkerEstimator::shape() const {
  MarkerShape shape;
  for (const Belief& belief : beliefs_) shape.believed_m.push_back(belief.motion.position_m());
  shape.reference_m = reference_m_;
  return shape;
}

}  // namespace soft_robot_lab
