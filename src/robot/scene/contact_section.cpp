// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "sections.h"
#include "settings/read_name.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

const std::vector<std::string> kShapes{"plane", "sphere", "capsule", "cylinder", "box"};
constexpr double kRounding = 0.1;  // of a cylinder's radius, or a box's half least size: where nothing else is stated

double rounding_m(const YamlNode& node, double largest_m) {
  return node.number_or("rounding_m", kRounding * largest_m, AllowedRange::positive());
}

Cylinder read_cylinder(const YamlNode& node) {
  Cylinder shape{node.vector3("start_m"), node.vector3("end_m"), node.number("radius_m"), 0.0};
  shape.rounding_m = rounding_m(node, std::min(shape.radius_m, 0.5 * (shape.end_m - shape.start_m).norm()));
  return shape;
}

RoundedBox read_rounded_box(const YamlNode& node) {
  RoundedBox shape{node.vector3("center_m"), node.vector3("size_m"), 0.0};
  shape.rounding_m = rounding_m(node, 0.5 * shape.size_m.minCoeff());
  return shape;
}

ObstacleShape read_shape(const YamlNode& item) {
  std::vector<std::string> stated;
  for (const std::string& shape : kShapes)
    if (item.has(shape)) stated.push_back(shape);
  if (stated.size() != 1) item.fail("must have one of " + join(kShapes));
  const YamlNode node = item.child(stated[0]);
  if (stated[0] == "plane") return Plane{node.vector3("point_m"), node.vector3("normal")};
  if (stated[0] == "sphere") return Sphere{node.vector3("center_m"), node.number("radius_m")};
  if (stated[0] == "capsule") return Capsule{node.vector3("start_m"), node.vector3("end_m"), node.number("radius_m")};
  if (stated[0] == "cylinder") return read_cylinder(node);
  return read_rounded_box(node);
}

// The obstacle of a pair [skin, NAME], in any order.
std::string other_than_skin(const YamlNode& item) {
  std::vector<std::string> between;
  for (const YamlNode& name : item.sequence("between")) between.push_back(name.as_text());
  const auto skin = std::find(between.begin(), between.end(), kSkin);
  if (between.size() != 2 || skin == between.end())
    item.child("between").fail("must be two names, of which one is skin: [skin, floor]");
  between.erase(skin);
  if (between[0] == kSkin) item.child("between").fail("of skin on skin there is no friction yet; leave the pair out");
  return between[0];
}

// One coefficient for all pairs, or a list of pairs.
void read_friction(const YamlNode& contact, bool self, std::vector<Obstacle>& obstacles) {
  const std::optional<YamlNode> node = contact.optional_child("friction");
  if (!node) return;
  if (node->is_scalar()) {
    if (self)
      node->fail(
          "is of every pair, but skin on skin knows none yet; list pairs instead: {between: [skin, NAME], "
          "coefficient: 0.3}");
    const double all = node->as_number(AllowedRange::not_negative());
    for (Obstacle& obstacle : obstacles) obstacle.friction = all;
    return;
  }
  for (const YamlNode& item : node->items()) {
    const std::string name = other_than_skin(item);
    const auto named = std::find_if(obstacles.begin(), obstacles.end(),
                                    [&](const Obstacle& obstacle) { return obstacle.name == name; });
    if (named == obstacles.end()) {
      std::vector<std::string> known{kSkin};
      for (const Obstacle& obstacle : obstacles) known.push_back(obstacle.name);
      item.child("between").fail("unknown surface '" + name + "'; known: " + join(known));
    }
    named->friction = item.number("coefficient", AllowedRange::not_negative());
  }
}

}  // namespace

std::vector<ObstaclePose> read_motion(const YamlNode& item) {
  std::vector<ObstaclePose> motion;
  for (const YamlNode& pose : item.optional_sequence("motion"))
    motion.push_back({pose.number("time_s", AllowedRange::not_negative()),
                      pose.vector3_or("translation_m", Eigen::Vector3d::Zero()),
                      pose.vector3_or("rotation_rad", Eigen::Vector3d::Zero())});
  return motion;
}

void read_contact(const YamlNode& scene, Body& body) {
  const std::optional<YamlNode> contact = scene.optional_child("contact");
  if (!contact) return;
  if (contact->boolean_or("self", false)) body.let_touch_itself();
  std::vector<Obstacle> obstacles;
  const std::vector<YamlNode> items = contact->optional_sequence("obstacles");
  for (const YamlNode& item : items) obstacles.push_back({read_name(item), read_shape(item), read_motion(item), 0.0});
  read_friction(*contact, body.touches_itself(), obstacles);
  for (std::size_t i = 0; i < items.size(); ++i)
    obstacles[i].friction = items[i].number_or("friction", obstacles[i].friction, AllowedRange::not_negative());
  in_section(*contact, [&] { body.set_obstacles(std::move(obstacles)); });
}

}  // namespace soft_robot_lab
