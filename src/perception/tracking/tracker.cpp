// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/perception/tracking/tracker.h"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "camera_observations.h"
#include "frame_gate.h"
#include "marker_estimator.h"
#include "marker_identity.h"
#include "search_region.h"

namespace soft_robot_lab {
namespace {

std::vector<Eigen::Vector3d> rest_positions(const std::vector<TrackedMarker>& markers) {
  if (markers.empty()) throw std::invalid_argument("tracker: there are no markers; allowed: at least one");
  std::set<std::string> names;
  std::vector<Eigen::Vector3d> positions_m;
  for (const TrackedMarker& marker : markers) {
    if (!names.insert(marker.name).second)
      throw std::invalid_argument("tracker: two markers are named '" + marker.name + "'");
    if (!marker.rest_position_m.allFinite())
      throw std::invalid_argument("tracker: the rest position of '" + marker.name + "' is not finite");
    positions_m.push_back(marker.rest_position_m);
  }
  return positions_m;
}

// Of each marker the place of its colour in the detector's list, or -1.
std::vector<int> colours_of(const std::vector<TrackedMarker>& markers, const TrackerSettings& settings) {
  std::vector<int> colours(markers.size(), -1);
  for (const auto& [name, colour_name] : settings.marker_colours) {
    const auto marker = std::find_if(markers.begin(), markers.end(),
                                     [&, wanted = name](const TrackedMarker& one) { return one.name == wanted; });
    if (marker == markers.end())
      throw std::invalid_argument("tracker: marker_colours names '" + name + "', which is no marker");
    const auto& known = settings.detector.colours;
    const auto colour = std::find_if(known.begin(), known.end(),
                                     [&, wanted = colour_name](const MarkerColour& one) { return one.name == wanted; });
    if (colour == known.end())
      throw std::invalid_argument("tracker: the colour '" + colour_name + "' of '" + name + "' is not described");
    colours[static_cast<std::size_t>(marker - markers.begin())] = static_cast<int>(colour - known.begin());
  }
  return colours;
}

}  // namespace

struct Tracker::Parts {
  TrackerSettings settings;
  std::vector<TrackedMarker> markers;
  FrameGate gate;
  MarkerEstimator beliefs;

  std::vector<std::vector<MarkerDetection>> find_markers(const std::vector<UsableFrame>& frames,
                                                         std::vector<CameraObservation>& by_camera) const;
  TrackerReport report() const;
};

Tracker::Tracker(const TrackerSettings& settings, const std::vector<TrackedMarker>& markers)
    : parts_(new Parts{
          settings, markers, {}, {settings.motion, rest_positions(markers), colours_of(markers, settings)}}) {}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

void Tracker::set_camera(const TrackerCamera& camera) { parts_->gate.set_camera(camera); }

void Tracker::set_simulated(const std::vector<Eigen::Vector3d>& positions_m) {
  if (positions_m.size() != parts_->markers.size())
    throw std::invalid_argument("tracker: " + std::to_string(positions_m.size()) + " simulated positions for " +
                                std::to_string(parts_->markers.size()) + " markers");
  for (const Eigen::Vector3d& position_m : positions_m)
    if (!position_m.allFinite()) throw std::invalid_argument("tracker: a simulated position is not finite");
  parts_->beliefs.set_reference(positions_m);
}

TrackerReport Tracker::update(const std::vector<RgbdFrame>& frames) {
  std::vector<CameraProblem> problems;
  std::vector<CameraObservation> by_camera;
  const std::vector<UsableFrame> usable = parts_->gate.pass(frames, problems);
  if (!usable.empty()) {
    const auto newest = std::max_element(usable.begin(), usable.end(), [](const UsableFrame& a, const UsableFrame& b) {
      return a.frame->stamp_s < b.frame->stamp_s;
    });
    parts_->beliefs.advance(newest->frame->stamp_s);
    parts_->beliefs.correct(parts_->find_markers(usable, by_camera));
    parts_->gate.report_silence(parts_->beliefs.time_s(), parts_->settings.camera_timeout_s, problems);
  }
  TrackerReport report = parts_->report();
  report.updated = !usable.empty();
  for (const UsableFrame& each : usable) report.cameras.push_back(each.frame->camera);
  report.problems = std::move(problems);
  report.sights = std::move(by_camera);
  return report;
}

void Tracker::reset() {
  parts_->gate.reset();
  parts_->beliefs.restart();
}

std::vector<double> Tracker::state() const { return parts_->beliefs.state(); }

void Tracker::set_state(const std::vector<double>& state) {
  parts_->beliefs.set_state(state);
  parts_->gate.reset();
}

// What each marker's sights are in these frames, camera by camera.
std::vector<std::vector<MarkerDetection>> Tracker::Parts::find_markers(
    const std::vector<UsableFrame>& frames, std::vector<CameraObservation>& by_camera) const {
  const std::vector<MarkerPrediction> expected = beliefs.predictions();
  const double gate_2 = settings.motion.gate;
  std::vector<std::vector<MarkerDetection>> sights_of(markers.size());
  for (const UsableFrame& each : frames) {
    const cv::Rect region = search_region(*each.camera, expected, settings);
    const std::vector<MarkerDetection> sights = look(*each.frame, *each.camera, region, beliefs.time_s(), settings);
    const std::vector<int> chosen = identify(sights, expected, beliefs.neighbours(), gate_2);
    for (std::size_t i = 0; i < chosen.size(); ++i)
      if (chosen[i] >= 0) sights_of[i].push_back(sights[static_cast<std::size_t>(chosen[i])]);
    const auto alone = camera_observations(sights, chosen, expected, beliefs.neighbours(), gate_2);
    for (std::size_t i = 0; i < alone.size(); ++i) {
      if (!alone[i]) continue;
      by_camera.push_back(*alone[i]);
      by_camera.back().marker = markers[i].name;
      by_camera.back().expected_m = beliefs.reference_m()[i];
    }
  }
  return sights_of;
}

TrackerReport Tracker::Parts::report() const {
  TrackerReport report;
  report.late_frames = gate.late_frames();
  if (beliefs.started()) report.stamp_s = beliefs.time_s();
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (!beliefs.started() || beliefs.lost(i)) {
      report.lost.push_back(markers[i].name);
      continue;
    }
    const MarkerMotion& motion = beliefs.motion(i);
    const int cameras = beliefs.cameras(i);
    report.markers.push_back({markers[i].name, motion.position_m(), motion.position_covariance_m2(),
                              cameras > 0 ? MarkerSource::seen : MarkerSource::interpolated, cameras});
  }
  return report;
}

}  // namespace soft_robot_lab
