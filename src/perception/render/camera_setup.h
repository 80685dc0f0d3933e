// SPDX-License-Identifier: BSD-3-Clause
// A rig of rendered cameras as a file says it: config/cameras/*.yaml.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "rendered_camera.h"
#include "perception/calibration/camera_pose.h"

namespace soft_robot_lab {

struct RigCamera {
  CameraPose pose;  // with its name, the topics' first part
  CameraModel model;
  double rate_hz = 30;
  SensorModel sensor;
  int samples_a_side = ExactCamera::most_samples_a_side;  // squared: rays of a pixel at an edge or a sticker
};

struct MarkerLook {
  double diameter_m = Sticker{}.diameter_m;
  Eigen::Vector3d colour = Sticker{}.colour;
};

struct CameraSetup {
  std::vector<RigCamera> cameras;
  Surroundings surroundings;            // box, blocks, balls, lights
  std::vector<Ball> calibration_balls;  // put among them to calibrate
  Eigen::Vector3d robot_colour = SeenRobot{}.colour;
  MarkerLook markers;
  std::map<std::string, MarkerLook> marker_overrides;  // by a marker's name

  std::vector<Sticker> stickers(const std::vector<std::string>& marker_names) const;
};

// cameras:                  # at least one; names unlike
//   - name: camera_left
//     width_px: 848         # 16:9
//     height_px: 480
//     rate_hz: 30
//     position_m: [x, y, z] # within the box; with look_at_m or quaternion_xyzw (of the optical frame)
//     look_at_m: [x, y, z]
//     distortion: [k1, k2, p1, p2, k3]   # optional
//     samples_a_side: 5     # [3, 5]; fewer rays at edges are quicker
//     sensor: exact         # or d415, or a map (read_sensor_model)
// box: {size_m: [x, y, z], center_m: [x, y, z], colour: [r, g, b]}      # seen from inside; optional
// blocks: [{size_m, center_m, colour}, ...]                             # optional
// balls: [{center_m: [x, y, z], radius_m: 0.02, colour: [r, g, b]}]     # optional
// calibration_balls: as balls; not among the surroundings                # optional
// lighting: {shaded: true, ambient: 0.45, lights: [{position_m, strength}]}
// markers: {diameter_m: 0.006, colour: [r, g, b], overrides: {NAME: {diameter_m, colour}}}
// robot_colour: [r, g, b]
// Throws SettingsError.
CameraSetup read_camera_setup(const std::string& path);

// One camera of the rig, filming a scene with the rig's surroundings. Cameras with one seed have unlike noise.
RenderedCamera make_camera(const RigCamera& camera, const RayScene& scene, std::uint64_t seed);

}  // namespace soft_robot_lab
