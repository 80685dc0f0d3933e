// SPDX-License-Identifier: BSD-3-Clause
// Small things to film, and a camera at y = -distance that looks along y: its x is the world's, its y is -z.
#pragma once

#include "perception/render/exact_camera.h"
#include "perception/calibration/camera_pose.h"

namespace soft_robot_lab {

struct Seen {
  Surroundings surroundings;
  SeenRobot robot;
  SeenState state;

  RayScene scene() const { return RayScene(surroundings, robot, state); }
};

inline void add_rectangle(Seen& seen, const Eigen::Vector3d& corner_m, const Eigen::Vector3d& first_side_m,
                          const Eigen::Vector3d& second_side_m) {
  const int first = static_cast<int>(seen.state.vertices_m.cols()),
            triangle = static_cast<int>(seen.robot.triangles.cols());
  seen.state.vertices_m.conservativeResize(3, first + 4);
  seen.state.vertices_m.rightCols(4) << corner_m, corner_m + first_side_m, corner_m + first_side_m + second_side_m,
      corner_m + second_side_m;
  seen.robot.triangles.conservativeResize(3, triangle + 2);
  seen.robot.triangles.rightCols(2) << first, first, first + 1, first + 2, first + 2, first + 3;
}

inline void add_sticker(Seen& seen, const Eigen::Vector3d& position_m, double diameter_m = 0.006) {
  Sticker sticker;
  sticker.name = "sticker_" + std::to_string(seen.robot.stickers.size());
  sticker.diameter_m = diameter_m;
  sticker.colour.setZero();
  seen.robot.stickers.push_back(sticker);
  seen.state.stickers_m.conservativeResize(3, seen.state.stickers_m.cols() + 1);
  seen.state.stickers_m.rightCols(1) = position_m;
}

// A white wall in the plane y = 0 that faces the camera; unshaded.
inline Seen facing_wall(double width_m = 2, double height_m = 2) {
  Seen seen;
  seen.surroundings.lighting.shaded = false;
  seen.robot.colour.setOnes();
  add_rectangle(seen, {-0.5 * width_m, 0, -0.5 * height_m}, {width_m, 0, 0}, {0, 0, height_m});
  return seen;
}

inline CameraModel small_camera() {
  CameraModel camera = d415_camera(848, 480);
  camera.width_px = 212, camera.height_px = 120;
  camera.centre_x_px = 105.5, camera.centre_y_px = 59.5;
  return camera;
}

inline Eigen::Isometry3d facing_pose(double distance_m) { return look_at({0, -distance_m, 0}, {0, 0, 0}); }

inline ExactImage exact_picture(const ExactCamera& camera, const RayScene& scene) {
  ExactImage image{camera.background().colour.clone(), camera.background().depth.clone()};
  camera.draw(scene, camera.robot_bounds(scene.robot(), scene.state()), 0, image);
  return image;
}

}  // namespace soft_robot_lab
