// SPDX-License-Identifier: BSD-3-Clause
// Which part of a sticker a camera sees.
#include <cmath>

#include <Eigen/Geometry>

#include "ray_scene_parts.h"

namespace soft_robot_lab {
namespace {

constexpr int sample_count = 100;

// Evenly spread over a disc (Vogel's spiral).
Eigen::Vector3f disc_point(int i, const Eigen::Vector3f& center_m, const Eigen::Vector3f& normal, float radius_m) {
  const float radius = radius_m * std::sqrt((static_cast<float>(i) + 0.5f) / sample_count);
  const float angle = 2.39996323f * static_cast<float>(i);  // the golden angle
  const Eigen::Vector3f x = normal.unitOrthogonal(), y = normal.cross(x);
  return center_m + radius * (std::cos(angle) * x + std::sin(angle) * y);
}

}  // namespace

bool RayScene::clear(const Eigen::Vector3f& camera_m, const Eigen::Vector3f& point_m, float slack_m,
                     int sticker) const {
  const Eigen::Vector3f direction = point_m - camera_m;
  const float enough = 1 - slack_m / direction.norm();
  const auto blocks = [&](float depth) { return depth > 0 && depth < enough; };
  if (blocks(parts_->skin.cast(camera_m, direction).depth)) return false;
  if (blocks(cast_at_surroundings(camera_m, direction).depth)) return false;
  for (int i = 0; i < static_cast<int>(parts_->closest.size()); ++i)
    if (i != sticker && blocks(parts_->ball_depth(static_cast<std::size_t>(i), camera_m, direction))) return false;
  return true;
}

StickerSight RayScene::sight(int sticker, const Eigen::Vector3d& camera_position_m) const {
  const std::size_t index = static_cast<std::size_t>(sticker);
  const bool ball = parts_->is_ball(index);
  const Eigen::Vector3f camera_m = camera_position_m.cast<float>();
  const Eigen::Vector3f center_m = parts_->state.stickers_m.col(sticker).cast<float>();
  const Eigen::Vector3f towards_camera = (camera_m - center_m).normalized();
  const Eigen::Vector3f normal = ball ? towards_camera : parts_->normals.of_face(parts_->closest[index].triangle);
  const float radius_m = 0.5f * static_cast<float>(parts_->robot.stickers[index].diameter_m);

  StickerSight sight;
  // The drawn skin is made of flat triangles: it may lie a little before a position within the true, curved one.
  sight.centre_seen = normal.dot(towards_camera) > 0 && clear(camera_m, center_m, 0.001f, sticker);
  int painted = 0, seen = 0;
  for (int i = 0; i < sample_count; ++i) {
    Eigen::Vector3f point_m = disc_point(i, center_m, normal, radius_m);
    if (!ball) {
      const Eigen::Vector3f above_m = point_m + radius_m * normal;
      const MeshHit hit = parts_->skin.cast(above_m, -normal);
      if (hit.triangle < 0) continue;
      point_m = above_m - hit.depth * normal;
      if (!parts_->paints(index, point_m, hit.triangle)) continue;
    }
    ++painted;
    if (normal.dot(camera_m - point_m) > 0 && clear(camera_m, point_m, 0.0003f, sticker)) ++seen;
  }
  if (painted > 0) sight.share_seen = static_cast<double>(seen) / painted;
  return sight;
}

}  // namespace soft_robot_lab
