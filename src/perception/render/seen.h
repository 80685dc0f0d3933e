// SPDX-License-Identifier: BSD-3-Clause
// What cameras see, as plain data. Lengths in metres, frame: world. Colours are red, green, blue from 0 to 1, as they
// stand in the image (no gamma).
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// Flat and round, on the skin: what of the skin lies within diameter/2 of its position and does not turn away from the
// skin under it by more than 50 degrees is painted, so that no sticker wraps round a sharp edge. A ball of that
// diameter where no skin is that near.
struct Sticker {
  std::string name;
  double diameter_m = 0.006;
  Eigen::Vector3d colour{0.05, 0.15, 0.75};
};

struct Ball {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  double radius_m = 0.02;
  Eigen::Vector3d colour{0.9, 0.9, 0.9};
};

// Seen from inside as a room, from outside as a block.
struct Cuboid {
  Eigen::Vector3d min_m, max_m;
  Eigen::Vector3d colour{0.03, 0.03, 0.03};
};

// Lambert's law without falloff with distance; lights cast no shadows.
struct Light {
  Eigen::Vector3d position_m{0, 0, 0};
  double strength = 0;
};

struct Lighting {
  bool shaded = true;  // else everything has its own colour
  double ambient = 0.45;
  std::vector<Light> lights;
};

struct Surroundings {
  std::vector<Cuboid> cuboids;
  std::vector<Ball> balls;
  Lighting lighting;
};

// The look of a robot and the triangles of its skin, which index the columns of SeenState::vertices_m.
struct SeenRobot {
  Eigen::Matrix3Xi triangles;
  Eigen::Vector3d colour{0.78, 0.76, 0.72};
  std::vector<Sticker> stickers;
};

// Where the robot is.
struct SeenState {
  Eigen::Matrix3Xd vertices_m;
  Eigen::Matrix3Xd stickers_m;  // one column a sticker, in the order of SeenRobot::stickers
};

}  // namespace soft_robot_lab
