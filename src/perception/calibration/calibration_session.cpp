// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_session.h"

#include <stdexcept>

namespace soft_robot_lab {

CalibrationSession::CalibrationSession(const BallPlacement& placement, const BallFinderSettings& finder,
                                       int frame_count)
    : placement_(placement), finder_(finder), frame_count_(static_cast<std::size_t>(frame_count)) {
  if (frame_count < 1 || frame_count > 1000)
    throw std::invalid_argument("frame_count is " + std::to_string(frame_count) + "; allowed: [1, 1000]");
  finder_.radius_m = placement.radius_m;
  finder_.validate();
}

void CalibrationSession::set_camera(const TrackerCamera& camera) {
  camera.model.validate();
  series_[camera.name].camera = camera;
}

void CalibrationSession::add(const RgbdFrame& frame) {
  const auto found = series_.find(frame.camera);
  if (found == series_.end()) return;
  found->second.latest.push_back(frame);
  if (found->second.latest.size() > frame_count_) found->second.latest.pop_front();
}

void CalibrationSession::require_pictures() const {
  if (series_.empty()) throw CalibrationError("no camera is known yet; is its camera_info published?");
  for (const auto& [name, series] : series_)
    if (series.latest.size() < frame_count_)
      throw CalibrationError(name + " has sent " + std::to_string(series.latest.size()) +
                             " pictures; needed: " + std::to_string(frame_count_));
}

void CalibrationSession::remember_without_balls() {
  require_pictures();
  for (auto& [name, series] : series_) {
    series.without_balls.assign(series.latest.begin(), series.latest.end());
    series.latest.clear();
  }
}

std::vector<CameraCalibration> CalibrationSession::calibrate() const {
  require_pictures();
  std::vector<CameraCalibration> calibrations;
  for (const auto& [name, series] : series_) {
    if (series.without_balls.empty()) throw CalibrationError(name + " has no pictures without balls; film those first");
    calibrations.push_back(calibrate(series));
  }
  return calibrations;
}

CameraCalibration CalibrationSession::calibrate(const Series& series) const {
  BallSearch search;
  try {
    search =
        find_balls(series.without_balls, {series.latest.begin(), series.latest.end()}, series.camera.model, finder_);
    return calibrate_by_balls({series.camera.name, search.balls}, placement_);
  } catch (const CalibrationError& error) {
    std::string message = error.what();
    for (const std::string& reason : search.rejected) message += "; " + reason;
    throw CalibrationError(message);
  } catch (const std::invalid_argument& error) {
    throw CalibrationError(error.what());
  }
}

}  // namespace soft_robot_lab
