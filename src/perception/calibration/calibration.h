// SPDX-License-Identifier: BSD-3-Clause
// Where cameras stand, by white balls or by the robot's markers.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "ball_finder.h"
#include "camera_pose.h"

namespace soft_robot_lab {

// What was filmed does not show where the camera stands; the message says why, and what to do.
class CalibrationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct PlacedBall {
  std::string name;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // of its centre, in the world
};

struct BallPlacement {
  double radius_m = 0.02;
  double position_sigma_m = 0.00005;  // >= 0; standard deviation of the positions below
  double tolerance_m = 0.004;         // > 0, of positions; placements are ambiguous that differ by less
  std::vector<PlacedBall> balls;
};

// radius_m: 0.02
// position_sigma_m: 0.00005  # optional
// tolerance_m: 0.004         # optional
// balls:                # at least five
//   - {name: low_left, position_m: [x, y, z]}
// Throws SettingsError: what require_unambiguous() refuses too.
BallPlacement read_ball_placement(const std::string& path);

// Throws CalibrationError: fewer than five balls, or balls that another order of them, or a line, could be taken for.
void require_unambiguous(const BallPlacement& placement);

struct BallView {
  std::string camera;
  std::vector<FoundBall> balls;
};

struct CameraCalibration {
  CameraPose pose;
  // Of a small turn [rad] about the world's axes through the points' middle, and of the middle [m].
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<std::string> seen;  // balls or markers it rests on
};

// All throw CalibrationError.
// By balls whose positions are known.
CameraCalibration calibrate_by_balls(const BallView& view, const BallPlacement& placement);
// By balls anywhere, which a camera sees too whose pose is known.
CameraCalibration calibrate_by_camera(const BallView& view, const BallView& other, const CameraPose& other_pose,
                                      double tolerance_m);

struct CalibrationMarker {
  std::string name;
  Eigen::Vector3d in_camera_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
  Eigen::Vector3d expected_m = Eigen::Vector3d::Zero();  // in the world
};

// By at least four of the robot's markers, each within `tolerance_m` of where it is expected.
CameraCalibration calibrate_by_markers(const std::string& camera, const std::vector<CalibrationMarker>& markers,
                                       double tolerance_m);

}  // namespace soft_robot_lab
