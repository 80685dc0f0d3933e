// SPDX-License-Identifier: BSD-3-Clause
// An RGB-D camera that films a scene.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "exact_camera.h"
#include "sensor_model.h"
#include "soft_robot_lab/perception/tracking/rgbd_frame.h"

namespace soft_robot_lab {

class ColourSensor;
class DepthSensor;

// Two moments of the robot: how it moves about the frame's stamp.
struct SeenMotion {
  SeenState present;      // at the stamp
  SeenState before;       // as large as `present`
  double interval_s = 0;  // > 0: between the two; 0: at rest, `before` is not looked at
};

class RenderedCamera {
 public:
  // The seed makes the sensor's noise. The scene's surroundings are drawn once. Edges and stickers have
  // samples_a_side^2 rays a pixel.
  RenderedCamera(std::string name, const ExactCamera& camera, const SensorModel& sensor, std::uint64_t seed,
                 int samples_a_side = ExactCamera::most_samples_a_side);
  ~RenderedCamera();
  RenderedCamera(RenderedCamera&&) noexcept;
  RenderedCamera& operator=(RenderedCamera&&) noexcept;

  const std::string& name() const { return name_; }
  const ExactCamera& camera() const { return camera_; }

  // The same seed, frame and motion give the same bytes. Moves the scene, and leaves it at motion.present. Exposure and
  // rolling shutter see the robot go on at the velocity it had from `before` to `present`.
  RgbdFrame take(RayScene& scene, const SeenMotion& motion, double stamp_s, std::uint64_t frame);

 private:
  void draw_moving(RayScene& scene, const SeenMotion& motion);

  int samples_a_side_;
  std::string name_;
  ExactCamera camera_;
  SensorModel model_;
  std::unique_ptr<ColourSensor> colour_;
  std::unique_ptr<DepthSensor> depth_;
  ExactImage canvas_;  // the background outside `drawn_`
  cv::Rect drawn_;
};

}  // namespace soft_robot_lab
