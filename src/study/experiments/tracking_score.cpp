// SPDX-License-Identifier: BSD-3-Clause
#include "tracking_score.h"

#include <algorithm>
#include <cmath>

#include "session/report/frame_recorder.h"
#include "settings/cpu_time.h"

namespace soft_robot_lab {
namespace {

constexpr double kWrong_m = 0.005;
constexpr double kEnoughSeen = 0.5;  // of a sticker's area

double root_mean(double sum, int count) { return count ? std::sqrt(sum / count) : 0; }

int cameras_that_see(const Capture& capture, std::size_t marker) {
  return static_cast<int>(std::count_if(capture.views.begin(), capture.views.end(), [marker](const auto& views) {
    return views[marker].centre_seen && views[marker].share_seen >= kEnoughSeen;
  }));
}

int nearest(const Eigen::Matrix3Xd& truth_m, const Eigen::Vector3d& at_m) {
  Eigen::Index index = 0;
  (truth_m.colwise() - at_m).colwise().squaredNorm().minCoeff(&index);
  return static_cast<int>(index);
}

void judge(const MarkerObservation& observation, int marker, const Eigen::Matrix3Xd& truth_m, TrackingScore& score) {
  const double error_m = (observation.position_m - truth_m.col(marker)).norm();
  if (observation.source != MarkerSource::seen) {
    ++score.interpolated;
    score.interpolated_squared_error_m2 += error_m * error_m;
    return;
  }
  ++score.seen;
  ++score.marker_seen[static_cast<std::size_t>(marker)];
  score.marker_squared_error_m2[static_cast<std::size_t>(marker)] += error_m * error_m;
  score.squared_error_m2 += error_m * error_m;
  score.worst_error_m = std::max(score.worst_error_m, error_m);
  score.wrong += error_m > kWrong_m;
  score.swaps += nearest(truth_m, observation.position_m) != marker;
}

}  // namespace

double TrackingScore::rms_m() const { return root_mean(squared_error_m2, seen); }
double TrackingScore::interpolated_rms_m() const { return root_mean(interpolated_squared_error_m2, interpolated); }
double TrackingScore::missed_ratio() const { return visible ? double(missed) / visible : 0; }
double TrackingScore::false_ratio() const { return marker_frames ? double(wrong) / marker_frames : 0; }
double TrackingScore::cpu_cores(double rate_hz) const { return frames ? cpu_s / frames * rate_hz : 0; }

std::vector<TrackedMarker> tracked_markers(const Simulation& simulation) {
  std::vector<TrackedMarker> markers;
  for (const Marker& marker : simulation.markers()) markers.push_back({marker.name(), marker.rest_position_m()});
  return markers;
}

TrackingScore track(const std::vector<Moment>& moments, const Simulation& simulation, const CameraSetup& rig,
                    const TrackerSettings& settings, const std::function<void(double)>& progress) {
  const std::vector<TrackedMarker> markers = tracked_markers(simulation);
  FrameRecorder film(simulation, rig);
  Tracker tracker(settings, markers);
  for (const RigCamera& camera : rig.cameras)
    tracker.set_camera({camera.pose.name, camera.model, camera.pose.world_from_camera});
  TrackingScore score;
  score.marker_seen.resize(markers.size());
  score.marker_squared_error_m2.resize(markers.size());
  for (const Moment& moment : moments) {
    progress(double(score.frames) / double(moments.size()));
    const Capture capture = film.take(moment.previous, moment.present, moment.time_s);
    const double start_s = cpu_time_s();
    const TrackerReport report = tracker.update(capture.frames);
    score.latency_s.push_back(cpu_time_s() - start_s);
    score.cpu_s += score.latency_s.back();
    ++score.frames;
    for (std::size_t i = 0; i < markers.size(); ++i) {
      ++score.marker_frames;
      const int cameras = cameras_that_see(capture, i);
      const auto found = std::find_if(report.markers.begin(), report.markers.end(),
                                      [&](const MarkerObservation& one) { return one.name == markers[i].name; });
      const bool seen = found != report.markers.end() && found->source == MarkerSource::seen;
      score.visible += cameras > 0;
      score.hidden_from_one += cameras > 0 && cameras < static_cast<int>(rig.cameras.size());
      score.missed += cameras > 0 && !seen;
      if (found != report.markers.end()) judge(*found, static_cast<int>(i), capture.markers_m, score);
    }
  }
  return score;
}

}  // namespace soft_robot_lab
