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

// A pair [skin, NAME] or [NAME, NAME], with skin first.
std::vector<std::string> read_pair(const YamlNode& item) {
  std::vector<std::string> between;
  for (const YamlNode& name : item.sequence("between")) between.push_back(name.as_text());
  if (between.size() != 2 || (between[0] == between[1] && between[0] != kSkin))
    item.child("between").fail("must be two names, of skin or obstacles: [skin, floor]");
  if (between[1] == kSkin) std::swap(between[0], between[1]);
  if (between[1] == kSkin) item.child("between").fail("of skin on skin there is no friction yet; leave the pair out");
  return between;
}

Obstacle& find_obstacle(const YamlNode& item, const std::string& name, std::vector<Obstacle>& obstacles) {
  const auto named =
      std::find_if(obstacles.begin(), obstacles.end(), [&](const Obstacle& obstacle) { return obstacle.name == name; });
  if (named != obstacles.end()) return *named;
  std::vector<std::string> known{kSkin};
  for (const Obstacle& obstacle : obstacles) known.push_back(obstacle.name);
  item.child("between").fail("unknown surface '" + name + "'; known: " + join(known));
}

void read_friction_of_pair(const YamlNode& item, std::vector<Obstacle>& obstacles) {
  const std::vector<std::string> between = read_pair(item);
  const double coefficient = item.number("coefficient", AllowedRange::not_negative());
  Obstacle& second = find_obstacle(item, between[1], obstacles);
  if (between[0] == kSkin) {
    second.friction = coefficient;
    return;
  }
  Obstacle& first = find_obstacle(item, between[0], obstacles);
  if (!first.is_free() && !second.is_free())
    item.child("between").fail("neither '" + first.name + "' nor '" + second.name +
                               "' is free, so they do not touch; must have one with mass_kg");
  first.friction_on[second.name] = coefficient;
}

// Of every pair.
void set_friction(double coefficient, std::vector<Obstacle>& obstacles) {
  for (Obstacle& obstacle : obstacles) {
    obstacle.friction = coefficient;
    if (!obstacle.is_free()) continue;
    for (const Obstacle& other : obstacles)
      if (&other != &obstacle) obstacle.friction_on[other.name] = coefficient;
  }
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
    set_friction(node->as_number(AllowedRange::not_negative()), obstacles);
    return;
  }
  for (const YamlNode& item : node->items()) read_friction_of_pair(item, obstacles);
}

Obstacle read_obstacle(const YamlNode& item) {
  Obstacle obstacle{read_name(item), read_shape(item), read_motion(item), 0.0};
  if (!item.has("mass_kg")) {
    for (const char* key : {"inertia_kg_m2", "velocity_m_s", "angular_velocity_rad_s"})
      if (item.has(key)) item.child(key).fail("is for free obstacles; give mass_kg too");
    return obstacle;
  }
  if (item.has("motion")) item.child("motion").fail("is for obstacles that it moves; one with mass_kg is free");
  obstacle.mass_kg = item.number("mass_kg", AllowedRange::positive());
  if (item.has("inertia_kg_m2")) obstacle.inertia_kg_m2 = item.vector3("inertia_kg_m2").asDiagonal();
  obstacle.velocity_m_s = item.vector3_or("velocity_m_s", Eigen::Vector3d::Zero());
  obstacle.angular_velocity_rad_s = item.vector3_or("angular_velocity_rad_s", Eigen::Vector3d::Zero());
  return obstacle;
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
  for (const YamlNode& item : items) obstacles.push_back(read_obstacle(item));
  read_friction(*contact, body.touches_itself(), obstacles);
  for (std::size_t i = 0; i < items.size(); ++i)
    obstacles[i].friction = items[i].number_or("friction", obstacles[i].friction, AllowedRange::not_negative());
  in_section(*contact, [&] { body.set_obstacles(std::move(obstacles)); });
}

}  // namespace soft_robot_lab
