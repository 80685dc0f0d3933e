// SPDX-License-Identifier: BSD-3-Clause
// Finds white balls as what changed between pictures without and with them.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/perception/tracking/camera_model.h"
#include "soft_robot_lab/perception/tracking/rgbd_frame.h"
#include "soft_robot_lab/perception/tracking/tracker_settings.h"

namespace soft_robot_lab {

struct BallFinderSettings {
  double radius_m = 0.02;          // > 0, of every ball
  double radius_tolerance = 0.1;   // (0, 0.5); a sphere is another thing if its radius is off by more than this share
  double colour_change = 0.12;     // (0, 1); of white: less is noise
  double depth_change_m = 0.012;   // > 0; nearer by less is noise
  int min_points = 80;             // >= 10; depths on a ball
  double min_sphere_share = 0.7;   // (0, 1]; of a cluster's points on its sphere
  double min_outline_share = 0.6;  // (0, 1]; of the outline that shows as an edge

  // Standard deviations, of one picture.
  DepthSettings depth;
  double edge_noise_px = 0.1;     // of a place of the outline
  double centre_floor_px = 0.03;  // of the whole outline, by uneven light
  double outline_bias_px = 0.3;   // by which an outline looks too large or too small all round
  double depth_bias = 0.001;      // of the distance, of a whole ball

  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

// Frame: the camera's. The covariance is long along the ray.
struct FoundBall {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Identity();
  double radius_m = 0;             // as measured; the centre is that of a sphere of the known radius
  double depth_residual_m = 0;     // root mean square
  double outline_residual_px = 0;  // root mean square
  int points = 0;                  // depths used
};

struct BallSearch {
  std::vector<FoundBall> balls;       // from left to right in the picture
  std::vector<std::string> rejected;  // what changed and is not a ball: where, and why
};

// Frames of one camera at rest; several of either kind are averaged. Throws std::invalid_argument: no frames, and
// frames of unlike size, of another size than the camera's, or of unknown encoding.
BallSearch find_balls(const std::vector<RgbdFrame>& without_balls, const std::vector<RgbdFrame>& with_balls,
                      const CameraModel& camera, const BallFinderSettings& settings);

}  // namespace soft_robot_lab
