#include "experiment/tracking_score.h"

#include <algorithm>
#include <cmath>

#include "soft_robot_lab/settings/cpu_time.h"

namespace soft_robot_lab {
namespace {

constexpr double kWrong_m = 0.005;
constexpr double kEnoughSeen = 0.5;  // of a sticker's area

double root_mean(double sum, int count) { return count ? std::sqrt(sum / count) : 0; }

int cameras_that_see(const Stage& stage, const CameraRig& rig, int marker) {
  int count = 0;
  for (const RigCamera& camera : rig.cameras) {
    const StickerSight sight = stage.sight(marker, camera.pose.world_from_camera.translation());
    count += sight.centre_seen && sight.share_seen >= kEnoughSeen;
  }
  return count;
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

TrackingScore track(const std::vector<FilmMoment>& film, const CameraRig& rig, const SeenRobot& robot,
                    const SeenState& rest, const TrackerSettings& settings, const std::vector<TrackedMarker>& markers,
                    const std::function<void(double)>& progress) {
  constexpr std::uint64_t kSeed = 6;
  FilmCrew crew(rig, robot, rest, kSeed);
  Tracker tracker(settings, markers);
  for (const TrackerCamera& camera : tracker_cameras(rig)) tracker.set_camera(camera);
  TrackingScore score;
  score.marker_seen.resize(markers.size());
  score.marker_squared_error_m2.resize(markers.size());
  for (const FilmMoment& moment : film) {
    progress(double(score.frames) / double(film.size()));
    const std::vector<RgbdFrame> frames = crew.take(moment);
    const double start_s = cpu_time_s();
    const TrackerReport report = tracker.update(frames);
    score.latency_s.push_back(cpu_time_s() - start_s);
    score.cpu_s += score.latency_s.back();
    ++score.frames;
    for (std::size_t i = 0; i < markers.size(); ++i) {
      ++score.marker_frames;
      const int marker = static_cast<int>(i), cameras = cameras_that_see(crew.stage(), rig, marker);
      const auto found = std::find_if(report.markers.begin(), report.markers.end(),
                                      [&](const MarkerObservation& one) { return one.name == markers[i].name; });
      const bool seen = found != report.markers.end() && found->source == MarkerSource::seen;
      score.visible += cameras > 0;
      score.hidden_from_one += cameras > 0 && cameras < static_cast<int>(rig.cameras.size());
      score.missed += cameras > 0 && !seen;
      if (found != report.markers.end()) judge(*found, marker, moment.motion.present.stickers_m, score);
    }
  }
  return score;
}

}  // namespace soft_robot_lab
