// SPDX-License-Identifier: BSD-3-Clause
#include "hold_model.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <thread>
#include <utility>

namespace soft_robot_lab {
namespace {

constexpr double kStepOfSize = 0.02;  // of differences

// work(i) of all i < count on as many threads as there are cores; throws what one of them did.
void for_all(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::vector<std::future<void>> threads;
  for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i)
    threads.push_back(std::async(std::launch::async, [&] {
      for (std::size_t mine = next++; mine < count; mine = next++) work(mine);
    }));
  for (std::future<void>& thread : threads) thread.wait();
  for (std::future<void>& thread : threads) thread.get();
}

}  // namespace

HoldModel::HoldModel(std::string scene, SceneOptions options, const std::vector<MeasuredPose>& poses,
                     const FitParameters& parameters)
    : scene_(std::move(scene)), options_(std::move(options)), poses_(poses), parameters_(parameters) {
  const Scene loaded = load_scene(scene_, options_);
  for (const Marker& marker : loaded.simulation->markers())
    markers_[marker.name()] = loaded.simulation->marker_index(marker.name());
}

Overrides HoldModel::overrides(const Eigen::VectorXd& values, const std::set<std::string>& left_out) const {
  const Eigen::Vector2d creep = values.tail<2>().array().exp();
  for (const FitNumber& number : parameters_.creep())  // either says nothing without the other
    if (left_out.count(number.name) > 0) return parameters_.overrides(values, left_out);
  return parameters_.overrides(values, left_out)
      .set({"body", "hysteresis", "stiffness_ratio"}, creep[0])
      .set({"body", "hysteresis", "relaxation_time_s"}, creep[1]);
}

std::vector<SimulatedHold> HoldModel::holds(const Eigen::VectorXd& values) const {
  SceneOptions options = options_;
  options.overrides = overrides(values);
  return simulate_holds(scene_, options, poses_, parameters_.backlash_m(values));
}

Eigen::Matrix3Xd HoldModel::places_of(const std::vector<MeasuredMarker>& markers,
                                      const std::function<Eigen::Vector3d(int marker)>& place) const {
  Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(markers.size()));
  for (std::size_t m = 0; m < markers.size(); ++m)
    all.col(static_cast<Eigen::Index>(m)) = place(markers_.at(markers[m].name));
  return all;
}

std::vector<Eigen::Matrix3Xd> HoldModel::places(const Eigen::VectorXd& values) const {
  const std::vector<SimulatedHold> simulated = holds(values);
  std::vector<Eigen::Matrix3Xd> all;
  for (std::size_t p = 0; p < poses_.size(); ++p)
    all.push_back(places_of(poses_[p].markers, [&](int marker) {
      return simulated[p].mean(marker, poses_[p].rest_from_s, poses_[p].held_s);
    }));
  for (std::size_t p = 0; p < poses_.size(); ++p)
    for (const MarkersAt& seen : poses_[p].seen)
      all.push_back(places_of(seen.markers, [&](int marker) { return simulated[p].at(marker, seen.time_s); }));
  return all;
}

std::vector<PosePrediction> HoldModel::predict(const Eigen::VectorXd& values, bool derivatives) {
  if (last_.at.size() != values.size() || last_.at != values) last_ = {values, places(values)};
  const std::vector<FitNumber> numbers = parameters_.numbers_in_time();
  std::vector<std::size_t> columns;
  if (derivatives) {
    columns = parameters_.model_columns();
    for (std::size_t i = parameters_.numbers().size(); i < numbers.size(); ++i) columns.push_back(i);
  }
  std::vector<std::vector<Eigen::Matrix3Xd>> moved(columns.size());
  std::vector<double> steps(columns.size());
  for_all(moved.size(), [&](std::size_t i) {
    Eigen::VectorXd there = values;
    const FitNumber& number = numbers[columns[i]];
    const double size = kStepOfSize * number.size;
    double& value = there[static_cast<Eigen::Index>(columns[i])];
    steps[i] = value + size > number.max ? -size : size;
    value += steps[i];
    moved[i] = places(there);
  });
  std::vector<PosePrediction> predictions;
  for (std::size_t s = 0; s < last_.places.size(); ++s) {
    PosePrediction prediction{last_.places[s], {}};
    prediction.jacobian.resize(derivatives ? prediction.markers_m.size() : 0, static_cast<Eigen::Index>(steps.size()));
    for (std::size_t i = 0; i < steps.size(); ++i)
      prediction.jacobian.col(static_cast<Eigen::Index>(i)) =
          (moved[i][s] - prediction.markers_m).reshaped() / steps[i];
    predictions.push_back(std::move(prediction));
  }
  return predictions;
}

}  // namespace soft_robot_lab
