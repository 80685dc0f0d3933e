// SPDX-License-Identifier: BSD-3-Clause
// The seen things as something rays can be cast at (Embree).
#pragma once

#include <memory>

#include <Eigen/Core>

#include "seen.h"

namespace soft_robot_lab {

// What a ray meets first. Depth in units of the ray's direction; 0 where it meets nothing.
struct RayHit {
  float depth = 0;
  Eigen::Vector3f colour = Eigen::Vector3f::Zero();
};

struct StickerSight {
  bool centre_seen = false;  // nothing stands between the camera and the sticker's position
  double share_seen = 0;     // of its area
};

class RayScene {
 public:
  // Edges of the skin that bend by more than 35 degrees in `rest` are sharp, others are shaded smoothly. Throws
  // std::invalid_argument: sizes that do not match, indices out of range, numbers that are not finite.
  RayScene(Surroundings surroundings, SeenRobot robot, const SeenState& rest);
  ~RayScene();
  RayScene(RayScene&&) noexcept;

  // Moves the robot; throws std::invalid_argument as above and nothing moves then.
  void show(const SeenState& state);
  const SeenState& state() const;
  const SeenRobot& robot() const;
  const Surroundings& surroundings() const;

  // `gloss` is the strength of the lights' mirror image on the skin.
  RayHit cast_at_surroundings(const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction) const;
  RayHit cast_at_robot(const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction, float gloss) const;

  StickerSight sight(int sticker, const Eigen::Vector3d& camera_position_m) const;

 private:
  struct Parts;
  // Whether nothing but the sticker itself stands before a point, or less than `slack_m` before it.
  bool clear(const Eigen::Vector3f& camera_m, const Eigen::Vector3f& point_m, float slack_m, int sticker) const;
  std::unique_ptr<Parts> parts_;
};

}  // namespace soft_robot_lab
