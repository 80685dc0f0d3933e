// SPDX-License-Identifier: BSD-3-Clause
#include "swing_choice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

#include <Eigen/QR>

#include "measured_weight.h"

namespace soft_robot_lab {
namespace {

constexpr double kMostDelay_s = 1.0, kDelayStep_s = 0.01;  // looked for
constexpr std::size_t kMostSwings = 3;                     // each is simulated some twenty times
constexpr std::size_t kSamples = 8;                        // of a marker in a swing, at least
constexpr double kMotion = 1.0;                            // in deviations of its noise: a marker swings

// Root mean square of what a parabola in time leaves of the places.
double motion_m(const SwingTrack& track, const std::function<Eigen::Vector3d(std::size_t)>& position_m) {
  const auto count = static_cast<Eigen::Index>(track.times_s.size());
  Eigen::MatrixX3d line(count, 3);
  Eigen::MatrixX3d places(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double fraction = track.fraction(track.times_s[static_cast<std::size_t>(i)]);
    line.row(i) << 1.0, fraction, fraction * fraction;
    places.row(i) = position_m(static_cast<std::size_t>(i)).transpose();
  }
  const Eigen::MatrixX3d left = places - line * line.colPivHouseholderQr().solve(places);
  return std::sqrt(left.squaredNorm() / static_cast<double>(count));
}

double deviation_m(const SwingTrack& track, double model_error_m) {
  double variance = 0.0;
  for (const MeasuredMarker& one : track.measured) variance += one.covariance_m2.trace();
  return std::sqrt(variance / static_cast<double>(track.measured.size()) + 3.0 * model_error_m * model_error_m);
}

// At which the simulated motion is nearest to the measured one, on its way and in its first swings.
double delay_of(const MeasuredSwing& swing, const SimulatedSwing& simulated, const Simulation& simulation) {
  double best_s = 0.0, least = std::numeric_limits<double>::infinity();
  for (double delay_s = 0.0; delay_s <= kMostDelay_s; delay_s += kDelayStep_s) {
    std::map<std::string, std::vector<Eigen::Vector3d>> apart;
    for (const MarkersAt& at : swing.seen) {
      if (at.time_s > simulated.free_s() + kMostDelay_s) break;
      for (const MeasuredMarker& marker : at.markers)
        apart[marker.name].push_back(marker.position_m -
                                     simulated.deflection_m(simulation.marker_index(marker.name), at.time_s - delay_s));
    }
    double squares = 0.0;
    for (const auto& [name, all] : apart) {
      const Eigen::Vector3d mean =
          std::accumulate(all.begin(), all.end(), Eigen::Vector3d(Eigen::Vector3d::Zero())) / all.size();
      for (const Eigen::Vector3d& one : all) squares += (one - mean).squaredNorm();
    }
    if (squares < least) {
      least = squares;
      best_s = delay_s;
    }
  }
  return best_s;
}

std::vector<SwingTrack> tracks_of(const MeasuredSwing& swing, double delay_s, const SimulatedSwing& simulated,
                                  const Simulation& simulation) {
  const double start_s = simulated.free_s() + delay_s + kSwingDelayMargin_s;
  std::map<std::string, SwingTrack> by_marker;
  for (const MarkersAt& at : swing.seen) {
    if (at.time_s < start_s || at.time_s > start_s + kSwingWindow_s) continue;
    for (const MeasuredMarker& marker : at.markers) {
      SwingTrack& track = by_marker[marker.name];
      track.times_s.push_back(at.time_s);
      track.measured.push_back(marker);
    }
  }
  std::vector<SwingTrack> tracks;
  for (auto& [name, track] : by_marker) {
    if (track.times_s.size() < kSamples) continue;
    track.marker = simulation.marker_index(name);
    track.free_s = simulated.free_s();
    track.middle_s = start_s + 0.5 * kSwingWindow_s;
    tracks.push_back(std::move(track));
  }
  return tracks;
}

// Of the marker that swings farthest, measured and simulated: the lesser of both, in deviations of its noise.
double motion_of(const std::vector<SwingTrack>& tracks, double delay_s, const SimulatedSwing& simulated,
                 double model_error_m) {
  double largest = 0.0;
  for (const SwingTrack& track : tracks) {
    const double seen = motion_m(track, [&](std::size_t i) { return track.measured[i].position_m; });
    const double expected = motion_m(
        track, [&](std::size_t i) { return simulated.deflection_m(track.marker, track.times_s[i] - delay_s); });
    largest = std::max(largest, std::min(seen, expected) / deviation_m(track, model_error_m));
  }
  return largest;
}

}  // namespace

ChosenSwings choose_swings(Simulation& simulation, const std::vector<MeasuredSwing>& swings, double model_error_m) {
  std::vector<MeasuredSwing> seen;
  for (const MeasuredSwing& swing : swings) {
    for (const MarkersAt& at : swing.seen) {
      if (!std::isfinite(at.time_s)) throw std::invalid_argument("swing: a time is not finite");
      for (const MeasuredMarker& marker : at.markers) require_finite(marker);
    }
    if (!swing.commands.empty() && swing.seen.size() >= kSamples) seen.push_back(swing);
  }
  const std::vector<SimulatedSwing> simulated = simulate_swings(simulation, seen, kSwingWindow_s + kSwingDelayMargin_s);
  struct Candidate {
    double motion, delay_s;
    const MeasuredSwing* swing;
    std::vector<SwingTrack> tracks;
  };
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const double delay_s = delay_of(seen[i], simulated[i], simulation);
    std::vector<SwingTrack> tracks = tracks_of(seen[i], delay_s, simulated[i], simulation);
    const double motion = motion_of(tracks, delay_s, simulated[i], model_error_m);
    if (motion >= kMotion) candidates.push_back({motion, delay_s, &seen[i], std::move(tracks)});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& one, const Candidate& other) { return one.motion > other.motion; });
  ChosenSwings chosen;
  for (std::size_t i = 0; i < std::min(candidates.size(), kMostSwings); ++i) {
    for (SwingTrack& track : candidates[i].tracks) {
      track.swing = i;
      chosen.tracks.push_back(std::move(track));
    }
    chosen.swings.push_back(*candidates[i].swing);
    chosen.delays_s.push_back(candidates[i].delay_s);
  }
  return chosen;
}

}  // namespace soft_robot_lab
