// SPDX-License-Identifier: BSD-3-Clause
#include "rendered_rig.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "settings/cpu_time.h"
#include "settings/unit_limits.h"

namespace soft_robot_lab {
namespace {

std::int64_t frame_number(const ros::Time& stamp, double rate_hz) {
  constexpr double rounding = 1.0e-6;  // of a frame: stamps are whole nanoseconds
  return static_cast<std::int64_t>(std::floor(stamp.toSec() * rate_hz + rounding));
}

std::string names_of(const std::vector<RigCamera>& cameras) {
  std::string names;
  for (const RigCamera& camera : cameras) names += (names.empty() ? "" : ", ") + camera.pose.name;
  return names;
}

}  // namespace

RenderedRig::RenderedRig(CameraSetup rig, std::uint64_t seed) : rig_(std::move(rig)), seed_(seed) {
  build_stage({}, {});
  for (std::size_t i = 0; i < rig_.cameras.size(); ++i) {
    const CameraSetting setting = own_setting(rig_.cameras[i].sensor);
    shooting_.push_back({made(i, setting), setting, {}, -1});
  }
}

RenderedCamera RenderedRig::made(std::size_t camera, const CameraSetting& setting) const {
  RigCamera filming = rig_.cameras[camera];
  filming.sensor = exposed(filming.sensor, setting);
  return make_camera(filming, *stage_, seed_);
}

void RenderedRig::set(std::size_t camera, const CameraSetting& setting) {
  const CameraSetting& old = shooting_[camera].setting;
  if (setting.automatic == old.automatic && setting.exposure == old.exposure && setting.gain == old.gain) return;
  shooting_[camera].camera = made(camera, setting);
  shooting_[camera].setting = setting;
}

void RenderedRig::build_stage(SeenRobot robot, const SeenState& state) {
  Surroundings surroundings = rig_.surroundings;
  if (balls_shown_)
    surroundings.balls.insert(surroundings.balls.end(), rig_.calibration_balls.begin(), rig_.calibration_balls.end());
  stage_ = std::make_unique<RayScene>(std::move(surroundings), std::move(robot), state);
}

void RenderedRig::show_balls(bool shown) {
  if (shown == balls_shown_) return;
  balls_shown_ = shown;
  const SeenState state = stage_->state();
  build_stage(stage_->robot(), state);
  for (std::size_t i = 0; i < shooting_.size(); ++i) shooting_[i].camera = made(i, shooting_[i].setting);
}

const RigCamera& RenderedRig::move(const std::string& name, const Eigen::Vector3d& translation_m,
                                   const Eigen::Vector3d& rotation_rad) {
  const auto camera = std::find_if(rig_.cameras.begin(), rig_.cameras.end(),
                                   [&](const RigCamera& candidate) { return candidate.pose.name == name; });
  if (camera == rig_.cameras.end())
    throw std::invalid_argument("name: '" + name + "' is not one of " + names_of(rig_.cameras));
  require_in_unit("translation_m", translation_m);
  require_in_unit("rotation_rad", rotation_rad);
  Eigen::Isometry3d pose = camera->pose.world_from_camera;
  pose.linear() = Eigen::AngleAxisd(rotation_rad.norm(), rotation_rad.stableNormalized()) * pose.linear();
  pose.translation() += translation_m;
  require_in_unit("position_m", pose.translation());
  camera->pose.world_from_camera = pose;
  const auto place = static_cast<std::size_t>(camera - rig_.cameras.begin());
  shooting_[place].camera = made(place, shooting_[place].setting);
  return *camera;
}

void RenderedRig::follow(const SeenRobotStates& robot, const SeenState& state) {
  if (robot.version() == robot_version_) return;
  robot_version_ = robot.version();
  SeenRobot look;
  look.triangles = robot.triangles();
  look.colour = rig_.robot_colour;
  look.stickers = rig_.stickers(robot.marker_names());
  build_stage(std::move(look), state);
  for (Shooting& shooting : shooting_) shooting.last_frame = -1;
}

bool RenderedRig::is_due(Shooting& shooting, std::int64_t frame) {
  if (frame <= shooting.last_frame) return false;
  if (shooting.last_frame >= 0) shooting.counts.dropped += frame - shooting.last_frame - 1;
  shooting.last_frame = frame;
  return true;
}

std::vector<TakenFrame> RenderedRig::take_due(const SeenRobotStates& robot,
                                              const std::function<bool(std::size_t)>& wanted) {
  std::vector<TakenFrame> taken;
  const std::optional<SeenMoment> moment = robot.newest();
  if (!moment) return taken;
  follow(robot, moment->motion.present);
  for (std::size_t i = 0; i < shooting_.size(); ++i) {
    Shooting& shooting = shooting_[i];
    if (!wanted(i)) {
      shooting.last_frame = -1;
      continue;
    }
    const std::int64_t frame = frame_number(moment->stamp, rig_.cameras[i].rate_hz);
    if (!is_due(shooting, frame)) continue;
    const double start_s = cpu_time_s();
    taken.push_back(
        {i, moment->stamp,
         shooting.camera.take(*stage_, moment->motion, moment->stamp.toSec(), static_cast<std::uint64_t>(frame))});
    shooting.counts.cpu_s += cpu_time_s() - start_s;
    ++shooting.counts.taken;
  }
  return taken;
}

}  // namespace soft_robot_lab
