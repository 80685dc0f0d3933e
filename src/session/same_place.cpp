// SPDX-License-Identifier: BSD-3-Clause
#include "same_place.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace soft_robot_lab {
namespace {

constexpr double kDeviations = 3.5;

// Coordinate by coordinate.
Eigen::Vector3d of_rank(size_t rank, const SeenPlaces& places_m) {
  Eigen::Vector3d found_m;
  std::vector<double> values(places_m.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::transform(places_m.begin(), places_m.end(), values.begin(), [axis](const auto& one) { return one[axis]; });
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(values.begin(), at, values.end());
    found_m[axis] = *at;
  }
  return found_m;
}

// Of a few frames, one that missed says nothing about motion.
Eigen::Vector3d median_of(const SeenPlaces& places_m) {
  return 0.5 * (of_rank((places_m.size() - 1) / 2, places_m) + of_rank(places_m.size() / 2, places_m));
}

// Standard deviation of a frame, from the median of second differences, which steady motion does not change. Of its
// two middle ones the lower, as a jump is in two differences, and few frames have but four.
double noise_of(const SeenPlaces& early, const SeenPlaces& late) {
  constexpr double from_median_deviation = 1.4826;
  SeenPlaces all = early, bends_m;
  all.insert(all.end(), late.begin(), late.end());
  for (size_t i = 2; i < all.size(); ++i)
    bends_m.push_back((all[i] - 2.0 * all[i - 1] + all[i - 2]).cwiseAbs() / std::sqrt(6.0));
  return bends_m.empty() ? 0.0 : from_median_deviation * of_rank((bends_m.size() - 1) / 2, bends_m).norm();
}

}  // namespace

void add_seen(const MarkerFrame& frame, SeenMarkers& seen) {
  for (const SeenMarker& marker : frame.seen) seen[marker.name].push_back(marker.position_m);
}

void require_observations(int observations, SeenMarkers& seen) {
  for (auto marker = seen.begin(); marker != seen.end();) {
    const bool enough = marker->second.size() >= static_cast<size_t>(observations);
    marker = enough ? std::next(marker) : seen.erase(marker);
  }
}

Eigen::Vector3d mean_of(const SeenPlaces& places_m) {
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& one : places_m) sum_m += one;
  return sum_m / static_cast<double>(places_m.size());
}

Eigen::Vector3d place_of(const SeenPlaces& before, const SeenPlaces& now, double motion_m) {
  const Eigen::Vector3d mean_m = mean_of(now), median_m = median_of(now);
  const double noise_m = kDeviations * noise_of(before, now) / std::sqrt(static_cast<double>(now.size()));
  return (mean_m - median_m).norm() > motion_m + noise_m ? median_m : mean_m;
}

bool same_place(const SeenMarkers& before, const SeenMarkers& now, double motion_m) {
  constexpr double of_median = 1.25;
  bool compared = false;
  for (const auto& [name, late] : now) {
    const auto seen = before.find(name);
    if (seen == before.end()) continue;
    const SeenPlaces& early = seen->second;
    const double frames = 1.0 / (1.0 / static_cast<double>(early.size()) + 1.0 / static_cast<double>(late.size()));
    const double noise_m = kDeviations * of_median * noise_of(early, late) / std::sqrt(frames);
    if ((median_of(late) - median_of(early)).norm() > motion_m + noise_m) return false;
    compared = true;
  }
  return compared;
}

}  // namespace soft_robot_lab
