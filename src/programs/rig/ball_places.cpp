// SPDX-License-Identifier: BSD-3-Clause
#include "ball_places.h"

#include <cmath>
#include <random>
#include <stdexcept>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr std::size_t kBalls = 5;
constexpr int kDraws = 3000, kArrangements = 40, kRim = 24;
constexpr double kFromSkin_m = 0.01, kBetween_px = 6.0, kBorder_px = 6.0;
constexpr double kRadii_m[] = {0.02, 0.014, 0.01};  // the largest that find room

// Those of the robots of record, in the middle of config/cameras/box.yaml; others are drawn where these do not do.
const std::vector<PlacedBall> kUsual = {
    {"low_left", {-0.105, 0.020, -0.120}},    {"low_right", {0.080, -0.050, -0.135}},
    {"middle", {-0.010, 0.075, -0.050}},      {"above", {-0.010, 0.065, 0.100}},
    {"high_left", {-0.120, -0.040, 0.010}},   {"high_right", {0.115, 0.060, 0.035}},
    {"right_before", {0.115, -0.040, 0.060}},
};

class Room {
 public:
  Room(const Simulation& simulation, const CameraSetup& cameras, double radius_m)
      : cameras_(cameras),
        radius_m_(radius_m),
        vertices_m_(Skin(simulation.body().mesh()).vertices_m(simulation.state().positions_m)),
        scene_(cameras.surroundings, {Skin(simulation.body().mesh()).triangles(), cameras.robot_colour, {}},
               {vertices_m_, Eigen::Matrix3Xd(3, 0)}) {}

  bool has_place_for(const Eigen::Vector3d& center_m, const std::vector<PlacedBall>& others) const {
    if ((vertices_m_.colwise() - center_m).colwise().norm().minCoeff() < radius_m_ + kFromSkin_m) return false;
    for (const RigCamera& camera : cameras_.cameras) {
      if (!sees_whole(camera, center_m)) return false;
      for (const PlacedBall& other : others)
        if (overlap(camera, center_m, other.position_m)) return false;
    }
    return true;
  }

  Eigen::AlignedBox3d around() const {
    Eigen::AlignedBox3d box(vertices_m_.rowwise().minCoeff(), vertices_m_.rowwise().maxCoeff());
    const Eigen::Vector3d half_m = (box.sizes() / 2).cwiseMax(0.06) + Eigen::Vector3d::Constant(0.08);
    return {box.center() - half_m, box.center() + half_m};
  }

 private:
  static Eigen::Vector3d seen_from(const RigCamera& camera, const Eigen::Vector3d& point_m) {
    return camera.pose.world_from_camera.inverse() * point_m;
  }

  double radius_px(const RigCamera& camera, double depth_m) const {
    return camera.model.focal_x_px * radius_m_ / depth_m;
  }

  bool overlap(const RigCamera& camera, const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) const {
    const Eigen::Vector3d a = seen_from(camera, a_m), b = seen_from(camera, b_m);
    const double apart_px = (camera.model.project(a) - camera.model.project(b)).norm();
    return apart_px < radius_px(camera, a.z()) + radius_px(camera, b.z()) + kBetween_px;
  }

  // Its rim and its middle: in the image, and nothing before them.
  bool sees_whole(const RigCamera& camera, const Eigen::Vector3d& center_m) const {
    const Eigen::Vector3d eye_m = camera.pose.world_from_camera.translation();
    const Eigen::Vector3d towards = (center_m - eye_m).normalized(), x = towards.unitOrthogonal(), y = towards.cross(x);
    for (int i = 0; i <= kRim; ++i) {
      const double angle = 2 * M_PI * i / kRim, radius_m = i == kRim ? 0.0 : radius_m_ + kFromSkin_m / 4;
      const Eigen::Vector3d point_m = center_m + radius_m * (std::cos(angle) * x + std::sin(angle) * y);
      if (!sees(camera, eye_m, point_m)) return false;
    }
    return true;
  }

  bool sees(const RigCamera& camera, const Eigen::Vector3d& eye_m, const Eigen::Vector3d& point_m) const {
    const Eigen::Vector3d in_camera_m = seen_from(camera, point_m);
    if (in_camera_m.z() < 0.05) return false;
    const Eigen::Vector2d pixel = camera.model.project(in_camera_m);
    for (const double border_px : {-kBorder_px, kBorder_px})
      if (!camera.model.sees(pixel + Eigen::Vector2d::Constant(border_px))) return false;
    const Eigen::Vector3f from = eye_m.cast<float>(), direction = (point_m - eye_m).cast<float>();
    const auto blocks = [](float depth) { return depth > 0 && depth < 1; };
    return !blocks(scene_.cast_at_robot(from, direction, 0).depth) &&
           !blocks(scene_.cast_at_surroundings(from, direction).depth);
  }

  const CameraSetup& cameras_;
  double radius_m_;
  Eigen::Matrix3Xd vertices_m_;
  RayScene scene_;
};

bool is_unambiguous(const BallPlacement& placement) {
  try {
    require_unambiguous(placement);
    return true;
  } catch (const CalibrationError&) {
    return false;
  }
}

double rounded(double value_m) { return std::round(value_m * 1000) / 1000; }

// The first five places that do, of those that are usual and then of those that are drawn.
std::vector<PlacedBall> fill(const Room& room, const std::vector<PlacedBall>& usual, std::mt19937& random) {
  std::vector<PlacedBall> balls;
  for (const PlacedBall& ball : usual)
    if (balls.size() < kBalls && room.has_place_for(ball.position_m, balls)) balls.push_back(ball);
  const Eigen::AlignedBox3d box = room.around();
  const auto draw = [&](int axis) {  // as every library draws it
    const double part = static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
    return rounded(box.min()[axis] + part * box.sizes()[axis]);
  };
  for (int i = 0; i < kDraws && balls.size() < kBalls; ++i) {
    const double x_m = draw(0), y_m = draw(1), z_m = draw(2);
    if (room.has_place_for({x_m, y_m, z_m}, balls)) balls.push_back({"", {x_m, y_m, z_m}});
  }
  return balls;
}

}  // namespace

BallPlacement place_balls(const Simulation& simulation, const CameraSetup& cameras) {
  std::mt19937 random(1);
  for (const double radius_m : kRadii_m) {
    const Room room(simulation, cameras, radius_m);
    for (int arrangement = 0; arrangement < kArrangements; ++arrangement) {
      BallPlacement placement;
      placement.radius_m = radius_m;
      placement.balls = fill(room, arrangement == 0 ? kUsual : std::vector<PlacedBall>{}, random);
      if (placement.balls.size() < kBalls) break;
      for (std::size_t i = 0; i < kBalls; ++i)
        if (placement.balls[i].name.empty()) placement.balls[i].name = "ball_" + std::to_string(i + 1);
      if (is_unambiguous(placement)) return placement;
    }
  }
  throw std::invalid_argument(
      "there is no room for five calibration balls that every camera sees beside the robot; give --cameras a file "
      "whose "
      "cameras stand farther off, or see more in common");
}

}  // namespace soft_robot_lab
