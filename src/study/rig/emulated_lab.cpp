// SPDX-License-Identifier: BSD-3-Clause
#include "emulated_lab.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hardware/testbench/emulated_session.h"
#include "hardware/plant/same_commands.h"
#include "perception/calibration/calibration_session.h"
#include "soft_robot_lab/perception/tracking/tracker.h"

namespace soft_robot_lab {
namespace {

constexpr double kFrame_s = 1.0 / 30.0;
constexpr double kStep_s = 1.0 / 60.0;  // robot and rig exchange where they are so often
constexpr double kLook_s = 0.5;         // at rest: no marker moved by kStill_m in this time
constexpr double kStill_m = 5.0e-5;
constexpr double kLimit_s = 60.0;
const Eigen::Vector3d kWhite(0.9, 0.9, 0.9);

std::vector<TrackedMarker> tracked(const Simulation& simulation) {
  std::vector<TrackedMarker> markers;
  for (const Marker& marker : simulation.markers()) markers.push_back({marker.name(), marker.rest_position_m()});
  return markers;
}

void give_backlash(const PlantSettings& plant, const RigSettings& rig, Testbench& board) {
  for (const auto& [actuator, steps] : plant.backlash_steps) {
    const auto motor = std::find_if(rig.motors.begin(), rig.motors.end(),
                                    [&name = actuator](const MotorSettings& one) { return one.name == name; });
    if (motor == rig.motors.end())
      throw std::invalid_argument("backlash_steps: the rig has no motor named '" + actuator + "'");
    board.ask("backlash " + std::to_string(motor - rig.motors.begin()) + " " + std::to_string(steps));
  }
}

MeasuredMarker mean_of(const std::string& name, const std::vector<MarkerObservation>& sights) {
  MeasuredMarker mean{name, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  for (const MarkerObservation& sight : sights) {
    mean.position_m += sight.position_m;
    mean.covariance_m2 += sight.covariance_m2;
  }
  mean.position_m /= static_cast<double>(sights.size());
  mean.covariance_m2 /= static_cast<double>(sights.size());
  return mean;
}

}  // namespace

double farthest_m(const MarkerPlaces& one, const MarkerPlaces& other) {
  double most_m = 0.0;
  for (const auto& [name, position_m] : one) most_m = std::max(most_m, (other.at(name) - position_m).norm());
  return most_m;
}

double rms_m(const MarkerPlaces& places, const MarkerPlaces& others) {
  double sum_m2 = 0.0, count = 0.0;
  for (const auto& [name, position_m] : places) {
    const auto other = others.find(name);
    if (other == others.end()) continue;
    sum_m2 += (position_m - other->second).squaredNorm();
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum_m2 / count) : 0.0;
}

EmulatedLab::EmulatedLab(const EmulatedLabSettings& settings, const SceneOptions& options)
    : settings_(settings),
      plant_(settings.plant, options),
      real_cameras_(settings.plant.shifted(settings.cameras)),
      recorder_(plant_.simulation(), real_cameras_, settings.film) {
  if (settings.frames < 1 || settings.frames > 1000)
    throw std::invalid_argument("frames: " + std::to_string(settings.frames) + " is out of range [1, 1000]");
  require_same_commands(plant_.simulation(), settings.plant.robot.source(), settings.rig, "the rig");
  for (const RigCamera& camera : settings.cameras.cameras) believed_[camera.pose.name] = camera.pose.world_from_camera;
  session_ = std::make_unique<EmulatedSession>(settings.rig, settings.film.seed, settings.emulator);
  give_backlash(settings.plant, settings.rig, session_->rig);
  if (!session_->run_until_ready()) throw std::runtime_error("the emulated rig does not get ready");
}

EmulatedLab::~EmulatedLab() = default;

double EmulatedLab::time_s() const { return session_->rig.time_s(); }

void EmulatedLab::pass(double duration_s) {
  std::vector<std::string> names;
  for (const MotorSettings& motor : settings_.rig.motors) names.push_back(motor.name);
  for (const double end_s = time_s() + duration_s; time_s() < end_s;) {
    const double start_s = time_s();
    session_->run(std::min(kStep_s, end_s - start_s));
    const std::vector<ShaftTruth> shafts = session_->rig.shafts();
    std::vector<double> values;
    for (std::size_t i = 0; i < names.size(); ++i)
      values.push_back(value_of(settings_.rig.motors[i], shafts.at(i).spool_steps));
    plant_.advance(time_s() - start_s, names, values);
  }
}

void EmulatedLab::command(const std::vector<std::string>& names, const std::vector<double>& commands) {
  session_->command(names, commands);
}

void EmulatedLab::wait(double duration_s) {
  pass(duration_s);
  for (const MotorStatus& motor : session_->driver().motors())
    if (!motor.fault.empty()) throw std::runtime_error("a motor faults: " + motor.fault);
}

void EmulatedLab::go(const std::vector<std::string>& names, const std::vector<double>& commands) {
  command(names, commands);
  settle();
}

void EmulatedLab::settle() {
  MarkerPlaces before_m = plant_.markers_m();
  for (const double limit_s = time_s() + kLimit_s; time_s() < limit_s;) {
    wait(kLook_s);
    const MarkerPlaces now_m = plant_.markers_m();
    if (session_->at_rest() && farthest_m(before_m, now_m) < kStill_m) return;
    before_m = now_m;
  }
  throw std::runtime_error("the emulated robot does not come to rest");
}

Capture EmulatedLab::take(FrameRecorder& film) {
  pass(kFrame_s);
  return film.take(plant_.present(), plant_.present(), time_s());
}

void EmulatedLab::calibrate(const BallPlacement& placement) {
  CalibrationSession calibration(placement, {}, settings_.frames);
  for (const RigCamera& camera : settings_.cameras.cameras)
    calibration.set_camera({camera.pose.name, camera.model, believed_.at(camera.pose.name)});
  CameraSetup with_balls = real_cameras_;
  for (const PlacedBall& ball : placement.balls)
    with_balls.surroundings.balls.push_back({ball.position_m, placement.radius_m, kWhite});
  FrameRecorder recorder_of_balls(plant_.simulation(), with_balls, settings_.film);
  for (int i = 0; i < settings_.frames; ++i)
    for (const RgbdFrame& frame : take(recorder_).frames) calibration.add(frame);
  calibration.remember_without_balls();
  for (int i = 0; i < settings_.frames; ++i)
    for (const RgbdFrame& frame : take(recorder_of_balls).frames) calibration.add(frame);
  for (const CameraCalibration& found : calibration.calibrate())
    believed_[found.pose.name] = found.pose.world_from_camera;
}

std::unique_ptr<Tracker> EmulatedLab::new_tracker(const MarkerPlaces& expected_m) const {
  auto tracker = std::make_unique<Tracker>(settings_.tracker, tracked(plant_.simulation()));
  for (const RigCamera& camera : settings_.cameras.cameras)
    tracker->set_camera({camera.pose.name, camera.model, believed_.at(camera.pose.name)});
  std::vector<Eigen::Vector3d> expected;
  for (const Marker& marker : plant_.simulation().markers()) expected.push_back(expected_m.at(marker.name()));
  tracker->set_simulated(expected);
  return tracker;
}

void EmulatedLab::start_tracking(const MarkerPlaces& expected_m) { tracker_ = new_tracker(expected_m); }

MeasuredMarkers EmulatedLab::track() {
  if (!tracker_) throw std::logic_error("track: start_tracking comes first");
  MeasuredMarkers seen_m;
  const Capture capture = recorder_.take(plant_.previous(), plant_.present(), time_s());
  for (const MarkerObservation& marker : tracker_->update(capture.frames).markers)
    if (marker.source == MarkerSource::seen) seen_m[marker.name] = marker.position_m;
  return seen_m;
}

std::vector<MeasuredMarker> EmulatedLab::observe(const MarkerPlaces& expected_m) {
  const std::unique_ptr<Tracker> tracker = new_tracker(expected_m);
  std::map<std::string, std::vector<MarkerObservation>> seen;
  for (int i = 0; i < settings_.frames; ++i)
    for (MarkerObservation& marker : tracker->update(take(recorder_).frames).markers)
      if (marker.source == MarkerSource::seen) seen[marker.name].push_back(std::move(marker));
  std::vector<MeasuredMarker> means;
  for (const auto& [name, sights] : seen) means.push_back(mean_of(name, sights));
  return means;
}

MeasuredMarkers EmulatedLab::measure(const MarkerPlaces& expected_m) {
  MeasuredMarkers positions_m;
  for (const MeasuredMarker& marker : observe(expected_m)) positions_m[marker.name] = marker.position_m;
  return positions_m;
}

}  // namespace soft_robot_lab
