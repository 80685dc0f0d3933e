// SPDX-License-Identifier: BSD-3-Clause
#include "frame_gate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

constexpr double kBeforeAll = -std::numeric_limits<double>::infinity();

std::string size_text(const cv::Mat& image) { return std::to_string(image.cols) + " x " + std::to_string(image.rows); }

}  // namespace

void FrameGate::set_camera(const TrackerCamera& camera) {
  camera.model.validate();
  const Eigen::Matrix3d rotation = camera.world_from_camera.linear();
  if (!camera.world_from_camera.matrix().allFinite() ||
      !(rotation * rotation.transpose()).isApprox(Eigen::Matrix3d::Identity(), 1e-6) || rotation.determinant() < 0)
    throw std::invalid_argument("camera '" + camera.name + "': its pose is no rotation and finite translation");
  const auto at = known_.find(camera.name);
  if (at == known_.end())
    known_.emplace(camera.name, Known{camera, kBeforeAll});
  else
    at->second.camera = camera;
}

std::string FrameGate::refuse(const RgbdFrame& frame) {
  const auto at = known_.find(frame.camera);
  if (at == known_.end()) return "no such camera is known (camera_info or its pose is missing)";
  const CameraModel& model = at->second.camera.model;
  if (!std::isfinite(frame.stamp_s)) return "its stamp is not finite";
  if (frame.colour.type() != CV_8UC3) return "its colour image is not rgb8";
  if (frame.depth_m.type() != CV_32FC1) return "its depth image is not 32FC1";
  if (frame.colour.size() != frame.depth_m.size())
    return "colour is " + size_text(frame.colour) + " and depth " + size_text(frame.depth_m) + "; allowed: alike";
  if (frame.colour.cols != model.width_px || frame.colour.rows != model.height_px)
    return "images are " + size_text(frame.colour) + ", not as camera_info says " + std::to_string(model.width_px) +
           " x " + std::to_string(model.height_px);
  if (frame.stamp_s <= at->second.last_stamp_s) {
    ++late_frames_;
    return "it is not newer than the last one";
  }
  return {};
}

std::vector<UsableFrame> FrameGate::pass(const std::vector<RgbdFrame>& frames, std::vector<CameraProblem>& problems) {
  std::vector<UsableFrame> usable;
  for (const RgbdFrame& frame : frames) {
    const std::string reason = refuse(frame);
    if (!reason.empty()) {
      problems.push_back({frame.camera, "a frame of camera '" + frame.camera + "' was left out: " + reason, false});
      continue;
    }
    Known& known = known_.at(frame.camera);
    known.last_stamp_s = frame.stamp_s;
    usable.push_back({&frame, &known.camera});
  }
  return usable;
}

void FrameGate::report_silence(double time_s, double timeout_s, std::vector<CameraProblem>& problems) const {
  for (const auto& [name, known] : known_)
    if (known.last_stamp_s > kBeforeAll && time_s - known.last_stamp_s > timeout_s) {
      std::ostringstream text;
      text << "camera '" << name << "' has sent nothing usable for more than " << timeout_s << " s";
      problems.push_back({name, text.str(), true});
    }
}

void FrameGate::reset() {
  for (auto& [name, known] : known_) known.last_stamp_s = kBeforeAll;
}

}  // namespace soft_robot_lab
