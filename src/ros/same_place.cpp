#include "ros/same_place.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "soft_robot_lab/ros/conversions.h"

namespace soft_robot_lab {
namespace {

// Coordinate by coordinate: of a few frames, one that missed says nothing about motion.
Eigen::Vector3d median_of(const std::vector<Eigen::Vector3d>& places_m) {
  Eigen::Vector3d median;
  std::vector<double> sorted(places_m.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::transform(places_m.begin(), places_m.end(), sorted.begin(), [axis](const auto& one) { return one[axis]; });
    std::sort(sorted.begin(), sorted.end());
    median[axis] = 0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]);
  }
  return median;
}

// Of a frame's position, from second differences, which no steady motion changes; all axes together.
double noise_of(const std::vector<Eigen::Vector3d>& all) {
  double sum_m2 = 0.0;
  for (size_t i = 2; i < all.size(); ++i) sum_m2 += (all[i] - 2.0 * all[i - 1] + all[i - 2]).squaredNorm() / 6.0;
  return all.size() < 3 ? 0.0 : std::sqrt(sum_m2 / static_cast<double>(all.size() - 2));
}

}  // namespace

bool add_seen(const MarkerObservations& markers, SeenMarkers& seen) {
  bool any = false;
  for (size_t i = 0; i < markers.names.size(); ++i) {
    if (markers.sources.at(i) != MarkerObservations::SEEN) continue;
    seen[markers.names[i]].push_back(from_message(markers.positions.at(i), "positions"));
    any = true;
  }
  return any;
}

void require_observations(int observations, SeenMarkers& seen) {
  for (auto marker = seen.begin(); marker != seen.end();) {
    const bool enough = marker->second.size() >= static_cast<size_t>(observations);
    marker = enough ? std::next(marker) : seen.erase(marker);
  }
}

Eigen::Vector3d mean_of(const std::vector<Eigen::Vector3d>& places_m) {
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& one : places_m) sum_m += one;
  return sum_m / static_cast<double>(places_m.size());
}

bool same_place(const SeenMarkers& before, const SeenMarkers& now, double motion_m) {
  constexpr double of_median = 1.25, deviations = 3.0;
  bool compared = false;
  for (const auto& [name, late] : now) {
    const auto early = before.find(name);
    if (early == before.end()) continue;
    std::vector<Eigen::Vector3d> all = early->second;
    all.insert(all.end(), late.begin(), late.end());
    const double frames =
        1.0 / (1.0 / static_cast<double>(early->second.size()) + 1.0 / static_cast<double>(late.size()));
    const double noise_m = deviations * of_median * noise_of(all) / std::sqrt(frames);
    if ((median_of(late) - median_of(early->second)).norm() > motion_m + noise_m) return false;
    compared = true;
  }
  return compared;
}

}  // namespace soft_robot_lab
