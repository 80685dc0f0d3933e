// SPDX-License-Identifier: BSD-3-Clause
#include "ray_scene_parts.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "ball_depth.h"

namespace soft_robot_lab {
namespace {

const float flat_cosine = std::cos(50.0f * static_cast<float>(M_PI) / 180);  // how far a sticker follows an edge

// Two triangles to a side; bit k of a corner's number says whether it is at the maximum of axis k.
constexpr int cuboid_triangles[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                         {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

Eigen::Matrix3Xd corners_of(const std::vector<Cuboid>& cuboids) {
  Eigen::Matrix3Xd corners(3, 8 * cuboids.size());
  for (Eigen::Index i = 0; i < corners.cols(); ++i) {
    const Cuboid& cuboid = cuboids[static_cast<std::size_t>(i / 8)];
    for (int axis = 0; axis < 3; ++axis)
      corners(axis, i) = (i % 8) >> axis & 1 ? cuboid.max_m[axis] : cuboid.min_m[axis];
  }
  return corners;
}

Eigen::Matrix3Xi triangles_of(const std::vector<Cuboid>& cuboids) {
  Eigen::Matrix3Xi triangles(3, 12 * cuboids.size());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) triangles(k, t) = static_cast<int>(t / 12) * 8 + cuboid_triangles[t % 12][k];
  return triangles;
}

// To the power 80: spots about 10 degrees wide.
float spot(float cosine) {
  float power = cosine;
  for (int i = 0; i < 4; ++i) power *= power;  // 16
  const float of_16 = power;
  power *= power;  // 32
  return power * power * of_16;
}

}  // namespace

RayScene::Parts::Parts(Surroundings seen_surroundings, SeenRobot seen_robot, const SeenState& rest)
    : surroundings(std::move(seen_surroundings)),
      robot(std::move(seen_robot)),
      walls(corners_of(surroundings.cuboids), triangles_of(surroundings.cuboids), MeshTree::Use::still),
      skin(rest.vertices_m, robot.triangles, MeshTree::Use::moving),
      normals(rest.vertices_m, robot.triangles) {
  move(rest);
}

void RayScene::Parts::move(const SeenState& next) {
  state = next;
  skin.move(state.vertices_m);
  normals.update(state.vertices_m);
  closest.resize(robot.stickers.size());
  for (std::size_t i = 0; i < closest.size(); ++i)
    closest[i] = closest_point(state.stickers_m.col(static_cast<Eigen::Index>(i)), state.vertices_m, robot.triangles,
                               closest[i].triangle);
}

bool RayScene::Parts::is_ball(std::size_t sticker) const {
  return closest[sticker].triangle < 0 || closest[sticker].distance_m > 0.5 * robot.stickers[sticker].diameter_m;
}

bool RayScene::Parts::paints(std::size_t sticker, const Eigen::Vector3f& point_m, int triangle) const {
  const auto center_m = state.stickers_m.col(static_cast<Eigen::Index>(sticker));
  const double radius_m = 0.5 * robot.stickers[sticker].diameter_m;
  return (point_m.cast<double>() - center_m).squaredNorm() <= radius_m * radius_m && !is_ball(sticker) &&
         normals.of_face(triangle).dot(normals.of_face(closest[sticker].triangle)) > flat_cosine;
}

float RayScene::Parts::ball_depth(std::size_t sticker, const Eigen::Vector3f& origin_m,
                                  const Eigen::Vector3f& direction) const {
  if (!is_ball(sticker)) return 0;
  return soft_robot_lab::ball_depth(state.stickers_m.col(static_cast<Eigen::Index>(sticker)),
                                    0.5 * robot.stickers[sticker].diameter_m, origin_m, direction);
}

Eigen::Vector3f RayScene::Parts::shade(const Eigen::Vector3d& colour, const Eigen::Vector3f& point_m,
                                       Eigen::Vector3f normal, const Eigen::Vector3f& direction, float gloss) const {
  if (!surroundings.lighting.shaded) return colour.cast<float>();
  const Eigen::Vector3f towards_eye = -direction.normalized();
  if (normal.dot(towards_eye) < 0) normal = -normal;
  float matt = static_cast<float>(surroundings.lighting.ambient), mirrored = 0;
  for (const Light& light : surroundings.lighting.lights) {
    const Eigen::Vector3f towards_light = (light.position_m.cast<float>() - point_m).normalized();
    const float strength = static_cast<float>(light.strength);
    matt += strength * std::max(0.0f, normal.dot(towards_light));
    if (gloss > 0) mirrored += strength * spot(std::max(0.0f, normal.dot((towards_light + towards_eye).normalized())));
  }
  return (matt * colour.cast<float>()).array() + gloss * mirrored;
}

}  // namespace soft_robot_lab
