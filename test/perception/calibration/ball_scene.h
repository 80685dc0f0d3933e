// SPDX-License-Identifier: BSD-3-Clause
// White balls in a dark room, filmed without and with them.
#pragma once

#include <vector>

#include "perception/render/camera_setup.h"

namespace soft_robot_lab {

// Two series of pictures of one camera.
struct BallPictures {
  std::vector<RgbdFrame> without, with;
};

inline BallPictures film_balls(const RigCamera& camera, Surroundings room, const std::vector<Ball>& balls,
                               std::uint64_t seed, int count = 1) {
  BallPictures pictures;
  const auto film = [&](std::vector<RgbdFrame>& frames, std::uint64_t first_frame) {
    RayScene scene(room, {}, {});
    RenderedCamera filming = make_camera(camera, scene, seed);
    for (int i = 0; i < count; ++i)
      frames.push_back(filming.take(scene, {scene.state(), {}, 0}, 0, first_frame + static_cast<std::uint64_t>(i)));
  };
  film(pictures.without, 0);
  room.balls.insert(room.balls.end(), balls.begin(), balls.end());
  film(pictures.with, 1000);
  return pictures;
}

// A camera of few pixels at y = -0.4 m, which looks along y in a dark room: its x is the world's, its y is -z.
inline RigCamera small_ball_camera(const SensorModel& sensor) {
  RigCamera camera;
  camera.pose = {"camera", look_at({0, -0.4, 0}, {0, 0, 0}), {}};
  camera.model = d415_camera(424, 240);
  camera.sensor = sensor;
  return camera;
}

inline Surroundings dark_room() {
  Surroundings room;
  room.cuboids.push_back({{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, {0.05, 0.05, 0.05}});
  room.lighting.lights.push_back({{-0.3, -0.4, 0.3}, 0.3});
  return room;
}

inline Ball ball_at(double x_m, double y_m, double z_m, double radius_m = 0.02) {
  Ball ball;
  ball.center_m = {x_m, y_m, z_m};
  ball.radius_m = radius_m;
  return ball;
}

}  // namespace soft_robot_lab
