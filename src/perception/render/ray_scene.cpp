// SPDX-License-Identifier: BSD-3-Clause
#include "ray_scene.h"

#include <stdexcept>
#include <string>

#include "ball_depth.h"
#include "ray_scene_parts.h"

namespace soft_robot_lab {
namespace {

void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument("what cameras see: " + what);
}

void check_state(const SeenState& state, Eigen::Index vertex_count, Eigen::Index sticker_count) {
  require(state.vertices_m.cols() == vertex_count,
          "the skin has " + std::to_string(vertex_count) + " vertices, not " + std::to_string(state.vertices_m.cols()));
  require(state.stickers_m.cols() == sticker_count, "of " + std::to_string(sticker_count) + " stickers " +
                                                        std::to_string(state.stickers_m.cols()) + " are placed");
  require(state.vertices_m.allFinite(), "a vertex of the skin is not finite");
  require(state.stickers_m.allFinite(), "a sticker's position is not finite");
}

void check(const Surroundings& surroundings, const SeenRobot& robot, const SeenState& rest) {
  for (const Cuboid& cuboid : surroundings.cuboids)
    require((cuboid.max_m - cuboid.min_m).minCoeff() > 0, "a cuboid's max_m must be above its min_m on each axis");
  for (const Ball& ball : surroundings.balls)
    require(ball.radius_m > 0 && ball.center_m.allFinite(), "a ball's radius must be > 0 and its centre finite");
  for (const Sticker& sticker : robot.stickers)
    require(sticker.diameter_m > 0, "the diameter of sticker '" + sticker.name + "' must be > 0");
  if (robot.triangles.size() > 0)
    require(robot.triangles.minCoeff() >= 0 && robot.triangles.maxCoeff() < rest.vertices_m.cols(),
            "a triangle names a vertex that is not there");
  check_state(rest, rest.vertices_m.cols(), static_cast<Eigen::Index>(robot.stickers.size()));
}

}  // namespace

RayScene::RayScene(Surroundings surroundings, SeenRobot robot, const SeenState& rest) {
  check(surroundings, robot, rest);
  parts_ = std::make_unique<Parts>(std::move(surroundings), std::move(robot), rest);
}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;

const SeenState& RayScene::state() const { return parts_->state; }
const SeenRobot& RayScene::robot() const { return parts_->robot; }
const Surroundings& RayScene::surroundings() const { return parts_->surroundings; }

void RayScene::show(const SeenState& state) {
  check_state(state, parts_->state.vertices_m.cols(), parts_->state.stickers_m.cols());
  if (state.vertices_m == parts_->state.vertices_m && state.stickers_m == parts_->state.stickers_m) return;
  parts_->move(state);
}

RayHit RayScene::cast_at_surroundings(const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction) const {
  RayHit ray_hit;
  const MeshHit hit = parts_->walls.cast(origin_m, direction);
  if (hit.triangle >= 0) {
    const auto& cuboid = parts_->surroundings.cuboids[static_cast<std::size_t>(hit.triangle / 12)];
    const Eigen::Vector3f normal = Eigen::Vector3f::Unit(2 - hit.triangle % 12 / 4);
    ray_hit = {hit.depth, parts_->shade(cuboid.colour, origin_m + hit.depth * direction, normal, direction, 0)};
  }
  for (const Ball& ball : parts_->surroundings.balls) {
    const float depth = ball_depth(ball.center_m, ball.radius_m, origin_m, direction);
    if (depth <= 0 || (ray_hit.depth > 0 && depth >= ray_hit.depth)) continue;
    const Eigen::Vector3f point_m = origin_m + depth * direction;
    const Eigen::Vector3f normal = (point_m - ball.center_m.cast<float>()).normalized();
    ray_hit = {depth, parts_->shade(ball.colour, point_m, normal, direction, 0)};
  }
  return ray_hit;
}

RayHit RayScene::cast_at_robot(const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction, float gloss) const {
  const std::vector<Sticker>& stickers = parts_->robot.stickers;
  RayHit ray_hit;
  const MeshHit hit = parts_->skin.cast(origin_m, direction);
  if (hit.triangle >= 0) {
    const Eigen::Vector3f point_m = origin_m + hit.depth * direction;
    std::size_t painted = 0;
    while (painted < stickers.size() && !parts_->paints(painted, point_m, hit.triangle)) ++painted;
    const bool bare = painted == stickers.size();
    ray_hit.depth = hit.depth;
    ray_hit.colour = parts_->shade(bare ? parts_->robot.colour : stickers[painted].colour, point_m,
                                   parts_->normals.at(hit.triangle, hit.u, hit.v), direction, bare ? gloss : 0);
  }
  for (std::size_t i = 0; i < stickers.size(); ++i) {
    const float depth = parts_->ball_depth(i, origin_m, direction);
    if (depth <= 0 || (ray_hit.depth > 0 && depth >= ray_hit.depth)) continue;
    const Eigen::Vector3f point_m = origin_m + depth * direction;
    const Eigen::Vector3f center_m = parts_->state.stickers_m.col(static_cast<Eigen::Index>(i)).cast<float>();
    ray_hit = {depth, parts_->shade(stickers[i].colour, point_m, (point_m - center_m).normalized(), direction, 0)};
  }
  return ray_hit;
}

}  // namespace soft_robot_lab
