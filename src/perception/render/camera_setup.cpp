// SPDX-License-Identifier: BSD-3-Clause
#include "camera_setup.h"

#include <set>
#include <stdexcept>

#include "noise_tile.h"

namespace soft_robot_lab {
namespace {

Eigen::Vector3d read_colour(const YamlNode& node, const Eigen::Vector3d& otherwise, const std::string& key = "colour") {
  const Eigen::Vector3d colour = node.vector3_or(key, otherwise);
  if (colour.minCoeff() < 0 || colour.maxCoeff() > 1) node.child(key).fail("allowed: [r, g, b] from 0 to 1");
  return colour;
}

Cuboid read_cuboid(const YamlNode& node) {
  Cuboid cuboid;
  const Eigen::Vector3d size_m = node.vector3("size_m"), center_m = node.vector3("center_m");
  if (!(size_m.minCoeff() > 0)) node.child("size_m").fail("allowed: three numbers > 0");
  cuboid.min_m = center_m - 0.5 * size_m;
  cuboid.max_m = center_m + 0.5 * size_m;
  cuboid.colour = read_colour(node, cuboid.colour);
  return cuboid;
}

Ball read_ball(const YamlNode& node) {
  Ball ball;
  ball.center_m = node.vector3("center_m");
  ball.radius_m = node.number_or("radius_m", ball.radius_m, AllowedRange::positive());
  ball.colour = read_colour(node, ball.colour);
  return ball;
}

Lighting read_lighting(const YamlNode& node) {
  Lighting lighting;
  lighting.shaded = node.boolean_or("shaded", lighting.shaded);
  lighting.ambient = node.number_or("ambient", lighting.ambient, {0, 1});
  for (const YamlNode& item : node.optional_sequence("lights"))
    lighting.lights.push_back({item.vector3("position_m"), item.number("strength", {0, 1})});
  return lighting;
}

MarkerLook read_look(const YamlNode& node, const MarkerLook& otherwise) {
  MarkerLook look;
  look.diameter_m = node.number_or("diameter_m", otherwise.diameter_m, AllowedRange::positive());
  look.colour = read_colour(node, otherwise.colour);
  return look;
}

CameraModel read_model(const YamlNode& node) {
  const int width_px = node.integer("width_px", 16, 4096), height_px = node.integer("height_px", 16, 4096);
  CameraModel model;
  try {
    model = d415_camera(width_px, height_px);
  } catch (const std::invalid_argument& error) {
    node.fail(error.what());
  }
  if (const auto lens = node.optional_child("distortion")) {
    const Eigen::VectorXd numbers = lens->as_numbers();
    if (numbers.size() != 5) lens->fail("must have 5 numbers: k1, k2, p1, p2, k3");
    std::copy(numbers.begin(), numbers.end(), model.distortion.begin());
  }
  return model;
}

RigCamera read_camera(const YamlNode& node) {
  RigCamera camera;
  camera.pose.name = node.text("name");
  camera.pose.world_from_camera = read_world_from_camera(node);
  camera.model = read_model(node);
  camera.rate_hz = node.number_or("rate_hz", camera.rate_hz, {0, 1000, true, false});
  if (node.has("samples_a_side"))
    camera.samples_a_side = node.integer("samples_a_side", 3, ExactCamera::most_samples_a_side);
  if (const auto sensor = node.optional_child("sensor")) camera.sensor = read_sensor_model(*sensor);
  return camera;
}

void require_within(const Cuboid& box, const RigCamera& camera, const YamlNode& node) {
  const Eigen::Vector3d at_m = camera.pose.world_from_camera.translation();
  if ((at_m - box.min_m).minCoeff() <= 0 || (box.max_m - at_m).minCoeff() <= 0)
    node.child("position_m").fail("must be within the box");
}

Surroundings read_surroundings(const YamlNode& file) {
  Surroundings surroundings;
  if (const auto box = file.optional_child("box")) surroundings.cuboids.push_back(read_cuboid(*box));
  for (const YamlNode& node : file.optional_sequence("blocks")) surroundings.cuboids.push_back(read_cuboid(node));
  for (const YamlNode& node : file.optional_sequence("balls")) surroundings.balls.push_back(read_ball(node));
  if (const auto lighting = file.optional_child("lighting")) surroundings.lighting = read_lighting(*lighting);
  return surroundings;
}

}  // namespace

std::vector<Sticker> CameraSetup::stickers(const std::vector<std::string>& marker_names) const {
  std::vector<Sticker> stickers;
  for (const std::string& name : marker_names) {
    const auto own = marker_overrides.find(name);
    const MarkerLook& look = own == marker_overrides.end() ? markers : own->second;
    stickers.push_back({name, look.diameter_m, look.colour});
  }
  return stickers;
}

CameraSetup read_camera_setup(const std::string& path) {
  const YamlNode file = YamlNode::load_file(path);
  CameraSetup rig;
  rig.surroundings = read_surroundings(file);
  for (const YamlNode& node : file.optional_sequence("calibration_balls"))
    rig.calibration_balls.push_back(read_ball(node));
  std::set<std::string> names;
  for (const YamlNode& node : file.sequence("cameras")) {
    rig.cameras.push_back(read_camera(node));
    const RigCamera& camera = rig.cameras.back();
    if (!names.insert(camera.pose.name).second) node.child("name").fail("'" + camera.pose.name + "' is there twice");
    if (file.has("box")) require_within(rig.surroundings.cuboids.front(), camera, node);
  }
  if (rig.cameras.empty()) file.child("cameras").fail("must name a camera");
  if (const auto markers = file.optional_child("markers")) {
    rig.markers = read_look(*markers, rig.markers);
    if (const auto overrides = markers->optional_child("overrides"))
      for (const std::string& name : overrides->keys())
        rig.marker_overrides[name] = read_look(overrides->child(name), rig.markers);
  }
  rig.robot_colour = read_colour(file, rig.robot_colour, "robot_colour");
  file.require_all_read();
  return rig;
}

RenderedCamera make_camera(const RigCamera& camera, const RayScene& scene, std::uint64_t seed) {
  std::uint64_t own_seed = seed;
  for (const char letter : camera.pose.name) own_seed = scramble(own_seed, static_cast<unsigned char>(letter), 0);
  return {camera.pose.name, ExactCamera(camera.model, camera.pose.world_from_camera, scene), camera.sensor, own_seed,
          camera.samples_a_side};
}

}  // namespace soft_robot_lab
