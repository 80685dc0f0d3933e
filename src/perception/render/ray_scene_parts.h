// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "closest_point.h"
#include "geometry/mesh_tree.h"
#include "skin_normals.h"
#include "ray_scene.h"

namespace soft_robot_lab {

struct RayScene::Parts {
  Surroundings surroundings;
  SeenRobot robot;
  SeenState state;
  MeshTree walls, skin;
  SkinNormals normals;
  std::vector<ClosestPoint> closest;  // of the stickers

  Parts(Surroundings seen_surroundings, SeenRobot seen_robot, const SeenState& rest);
  void move(const SeenState& state);

  // Whether a sticker is too far from the skin to be painted on it.
  bool is_ball(std::size_t sticker) const;
  // Whether it is painted on a triangle at a point of it.
  bool paints(std::size_t sticker, const Eigen::Vector3f& point_m, int triangle) const;
  // Depth of its ball; 0 where it is missed, or no ball.
  float ball_depth(std::size_t sticker, const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction) const;

  // Lambert and Blinn-Phong; the normal may point either way.
  Eigen::Vector3f shade(const Eigen::Vector3d& colour, const Eigen::Vector3f& point_m, Eigen::Vector3f normal,
                        const Eigen::Vector3f& direction, float gloss) const;
};

}  // namespace soft_robot_lab
