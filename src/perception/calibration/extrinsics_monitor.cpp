// SPDX-License-Identifier: BSD-3-Clause
#include "extrinsics_monitor.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

constexpr double calm_share = 0.4;     // of the threshold: cameras that differ by less agree
constexpr double settled_share = 0.8;  // of the threshold: below, what was reported is over; no report comes and goes
constexpr double calm_memory_windows = 3;  // how far back "used to be" is, before the first difference
constexpr double clear_ratio = 1.5;        // by which one camera must have gone further than the other, to be named
constexpr double sigma_floor_m = 0.0003;   // of a sight
constexpr double trusted_sigmas = 3;
// Beliefs of a motion, which only matter where markers do not show it, as a turn about the line that they lie on.
constexpr double turn_sigma = 0.05, shift_sigma_m = 0.1;

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

Eigen::Matrix<double, 3, 6> slope_at(const Eigen::Vector3d& arm_m) {
  Eigen::Matrix<double, 3, 6> slope;
  slope << 0, arm_m.z(), -arm_m.y(), 1, 0, 0, -arm_m.z(), 0, arm_m.x(), 0, 1, 0, arm_m.y(), -arm_m.x(), 0, 0, 0, 1;
  return slope;
}

Eigen::Matrix3d weight_of(const Eigen::Matrix3d& covariance_m2) {
  return (covariance_m2 + sigma_floor_m * sigma_floor_m * Eigen::Matrix3d::Identity()).inverse();
}

}  // namespace

void ExtrinsicsMonitorSettings::validate() const {
  const auto require = [](const char* field, double value, const AllowedRange& range) {
    if (!range.contains(value))
      throw std::invalid_argument(std::string(field) + " is " + std::to_string(value) +
                                  "; allowed: " + range.to_string());
  };
  require("window_s", window_s, AllowedRange::positive());
  require("check_period_s", check_period_s, AllowedRange::not_negative());
  require("threshold_m", threshold_m, AllowedRange::positive());
  require("confirm_s", confirm_s, AllowedRange::not_negative());
  require("min_sights", min_sights, {6, 1e9});
}

ExtrinsicsMonitor::ExtrinsicsMonitor(const ExtrinsicsMonitorSettings& settings) : settings_(settings) {
  settings_.validate();
}

void ExtrinsicsMonitor::reset() {
  window_.clear();
  disputes_.clear();
  calm_.clear();
  warnings_.clear();
  watched_.clear();
}

void ExtrinsicsMonitor::add(double stamp_s, const std::vector<CameraObservation>& sights) {
  if (!std::isfinite(stamp_s)) return;
  if (!window_.empty() && stamp_s < window_.back().stamp_s) reset();
  if (window_.empty()) checked_s_ = stamp_s;
  Moment moment{stamp_s, {}};
  std::copy_if(sights.begin(), sights.end(), std::back_inserter(moment.sights), [](const CameraObservation& sight) {
    return sight.measured_m.allFinite() && sight.expected_m.allFinite() && sight.covariance_m2.allFinite();
  });
  window_.push_back(std::move(moment));
  while (window_.front().stamp_s < stamp_s - settings_.window_s) window_.pop_front();
  if (stamp_s - checked_s_ < settings_.check_period_s) return;
  checked_s_ = stamp_s;
  check();
}

std::vector<std::string> ExtrinsicsMonitor::cameras() const {
  std::set<std::string> names;
  for (const Moment& moment : window_)
    for (const CameraObservation& sight : moment.sights) names.insert(sight.camera);
  return {names.begin(), names.end()};
}

std::vector<ExtrinsicsMonitor::Difference> ExtrinsicsMonitor::between(const Pair& cameras) const {
  std::vector<Difference> differences;
  for (const Moment& moment : window_)
    for (const CameraObservation& first : moment.sights)
      for (const CameraObservation& second : moment.sights)
        if (first.camera == cameras.first && second.camera == cameras.second && first.marker == second.marker)
          differences.push_back({first.expected_m, first.measured_m - second.measured_m,
                                 weight_of(first.covariance_m2 + second.covariance_m2)});
  return differences;
}

std::vector<ExtrinsicsMonitor::Difference> ExtrinsicsMonitor::against_expected(const std::string& camera) const {
  std::vector<Difference> differences;
  for (const Moment& moment : window_)
    for (const CameraObservation& sight : moment.sights)
      if (sight.camera == camera)
        differences.push_back({sight.expected_m, sight.measured_m - sight.expected_m, weight_of(sight.covariance_m2)});
  return differences;
}

// Weighted least squares, thrice: outliers of the time before weigh less (Huber).
SmallMotion ExtrinsicsMonitor::fit(const std::vector<Difference>& differences) {
  SmallMotion motion;
  for (const Difference& difference : differences)
    motion.about_m += difference.position_m / static_cast<double>(differences.size());
  for (int round = 0; round < 3; ++round) {
    Vector6d beliefs;
    beliefs << Eigen::Vector3d::Constant(1 / (turn_sigma * turn_sigma)),
        Eigen::Vector3d::Constant(1 / (shift_sigma_m * shift_sigma_m));
    Matrix6d matrix = beliefs.asDiagonal();
    Vector6d right = Vector6d::Zero();
    for (const Difference& difference : differences) {
      const auto slope = slope_at(difference.position_m - motion.about_m);
      const Eigen::Vector3d miss = difference.value_m - motion.at(difference.position_m);
      const double sigmas = std::sqrt(std::max(0.0, miss.dot(difference.weight * miss)));
      const double trust = round == 0 || sigmas <= trusted_sigmas ? 1 : trusted_sigmas / sigmas;
      const Eigen::Matrix<double, 6, 3> weighted = trust * slope.transpose() * difference.weight;
      matrix += weighted * slope;
      right += weighted * difference.value_m;
    }
    const Vector6d solution = matrix.ldlt().solve(right);
    motion.turn = solution.head<3>();
    motion.shift_m = solution.tail<3>();
  }
  return motion;
}

double ExtrinsicsMonitor::size_m(const SmallMotion& motion, const std::vector<Difference>& differences) {
  double sum = 0;
  for (const Difference& difference : differences) sum += motion.at(difference.position_m).squaredNorm();
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, differences.size())));
}

void ExtrinsicsMonitor::check() {
  const double now_s = window_.back().stamp_s;
  const std::vector<std::string> names = cameras();
  std::set<std::string> agreeing(names.begin(), names.end());
  watched_.clear();
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = i + 1; j < names.size(); ++j) {
      const Pair pair{names[i], names[j]};
      const std::vector<Difference> differences = between(pair);
      // Too little shows neither that they differ nor that they do not: what was known stays.
      const bool enough = static_cast<int>(differences.size()) >= settings_.min_sights;
      const double displacement_m = enough ? size_m(fit(differences), differences) : 0;
      if (!enough || displacement_m > calm_share * settings_.threshold_m)
        for (const std::string& name : {pair.first, pair.second}) agreeing.erase(name);
      if (!enough) continue;
      watched_.insert({pair.first, pair.second});
      if (displacement_m <= (is_reported(pair) ? settled_share : 1.0) * settings_.threshold_m)
        disputes_.erase(pair);
      else
        disputes_.emplace(pair, Dispute{now_s, 0}).first->second.displacement_m = displacement_m;
    }
  for (const std::string& name : agreeing) remember_calm(name);
  warn();
}

bool ExtrinsicsMonitor::is_reported(const Pair& pair) const {
  const auto dispute = disputes_.find(pair);
  return dispute != disputes_.end() && window_.back().stamp_s - dispute->second.since_s >= settings_.confirm_s;
}

void ExtrinsicsMonitor::remember_calm(const std::string& camera) {
  const std::vector<Difference> differences = against_expected(camera);
  if (static_cast<int>(differences.size()) < settings_.min_sights) return;
  std::deque<Calm>& calm = calm_[camera];
  calm.push_back({window_.back().stamp_s, fit(differences)});
  while (calm.front().stamp_s < calm.back().stamp_s - calm_memory_windows * settings_.window_s) calm.pop_front();
}

// How far what a camera sees went from where it used to be against what is expected.
double ExtrinsicsMonitor::change_m(const std::string& camera) const {
  const std::vector<Difference> differences = against_expected(camera);
  const SmallMotion now = fit(differences);
  const auto calm = calm_.find(camera);
  const SmallMotion before = calm == calm_.end() || calm->second.empty() ? SmallMotion{} : calm->second.front().motion;
  double sum = 0;
  for (const Difference& difference : differences)
    sum += (now.at(difference.position_m) - before.at(difference.position_m)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, differences.size())));
}

std::vector<std::string> ExtrinsicsMonitor::culprits(const Pair& pair) const {
  const auto disputes_of = [&](const std::string& name) {
    return std::count_if(disputes_.begin(), disputes_.end(),
                         [&](const auto& item) { return item.first.first == name || item.first.second == name; });
  };
  const auto first_count = disputes_of(pair.first), second_count = disputes_of(pair.second);
  if (first_count != second_count) return {first_count > second_count ? pair.first : pair.second};
  const double first_m = change_m(pair.first), second_m = change_m(pair.second);
  if (first_m > clear_ratio * second_m) return {pair.first};
  if (second_m > clear_ratio * first_m) return {pair.second};
  return {pair.first, pair.second};
}

void ExtrinsicsMonitor::warn() {
  warnings_.clear();
  for (const auto& [pair, dispute] : disputes_) {
    if (!is_reported(pair)) continue;
    CameraWarning warning;
    warning.cameras = culprits(pair);
    warning.displacement_m = dispute.displacement_m;
    std::ostringstream difference;
    difference.precision(3);
    difference << pair.first << " and " << pair.second << " see the markers " << 1000 * warning.displacement_m
               << " mm apart; allowed: " << 1000 * settings_.threshold_m << " mm.";
    warning.difference = difference.str();
    warning.message = (warning.cameras.size() == 1 ? warning.cameras[0] : pair.first + " or " + pair.second) +
                      " was moved: " + warning.difference + " Calibrate again.";
    warnings_.push_back(warning);
  }
}

}  // namespace soft_robot_lab
