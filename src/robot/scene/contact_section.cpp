// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "mechanics/body/free_obstacles.h"
#include "sections.h"
#include "settings/limits.h"
#include "settings/read_name.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

const std::vector<std::string> kShapes{"plane", "sphere", "capsule", "cylinder", "box", "mesh"};
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

ObstacleShape read_shape(const YamlNode& item, const MesherOptions& mesher) {
  std::vector<std::string> stated;
  for (const std::string& shape : kShapes)
    if (item.has(shape)) stated.push_back(shape);
  if (stated.size() != 1) item.fail("must have one of " + join(kShapes));
  if (stated[0] == "mesh") return read_mesh_shape(item, mesher);
  const YamlNode node = item.child(stated[0]);
  if (stated[0] == "plane") return Plane{node.vector3("point_m"), node.vector3("normal")};
  if (stated[0] == "sphere") return Sphere{node.vector3("center_m"), node.number("radius_m")};
  if (stated[0] == "capsule") return Capsule{node.vector3("start_m"), node.vector3("end_m"), node.number("radius_m")};
  if (stated[0] == "cylinder") return read_cylinder(node);
  return read_rounded_box(node);  // stated as `box`
}

// All that touches, by name.
struct Surfaces {
  std::vector<std::string> bodies;  // of the mesh
  std::vector<TouchingBodies> touching;
  std::vector<Obstacle> obstacles;

  int body(const std::string& name) const {  // -1: none
    const auto named = std::find(bodies.begin(), bodies.end(), name);
    return named == bodies.end() ? -1 : static_cast<int>(named - bodies.begin());
  }
};

std::vector<std::string> read_names(const YamlNode& list) {
  std::vector<std::string> names;
  for (const YamlNode& name : list.items()) names.push_back(name.as_text());
  if (names.size() != 2) list.fail("must be two names: [skin, floor]");
  return names;
}

// Which skin touches which.
std::vector<TouchingBodies> read_touching(const YamlNode& contact, const Surfaces& surfaces) {
  std::vector<TouchingBodies> touching;
  if (contact.boolean_or("self", false)) {
    if (contact.has("bodies"))
      contact.child("bodies").fail("contact.self lets all bodies touch; leave out one of both");
    const auto count = static_cast<int>(surfaces.bodies.size());
    for (int first = 0; first < count; ++first)
      for (int second = first; second < count; ++second) touching.push_back({first, second, 0.0});
  }
  for (const YamlNode& item : contact.optional_sequence("bodies")) {
    const std::vector<std::string> names = read_names(item);
    for (const std::string& name : names)
      if (surfaces.body(name) < 0) item.fail("unknown body '" + name + "'; known: " + join(surfaces.bodies));
    touching.push_back({surfaces.body(names[0]), surfaces.body(names[1]), 0.0});
  }
  return touching;
}

Obstacle& find_obstacle(const YamlNode& item, const std::string& name, Surfaces& surfaces) {
  const auto named = std::find_if(surfaces.obstacles.begin(), surfaces.obstacles.end(),
                                  [&](const Obstacle& obstacle) { return obstacle.name == name; });
  if (named != surfaces.obstacles.end()) return *named;
  if (surfaces.body(name) >= 0)
    item.child("between").fail("the skin of all bodies rubs alike on an obstacle; must be [skin, NAME]");
  std::vector<std::string> known{kSkin};
  for (const Obstacle& obstacle : surfaces.obstacles) known.push_back(obstacle.name);
  item.child("between").fail("unknown surface '" + name + "'; known: " + join(known));
}

// Of skin on skin: of all, or of two bodies. False where the pair is another.
bool read_friction_of_skin(const YamlNode& item, const std::vector<std::string>& between, double coefficient,
                           Surfaces& surfaces) {
  const bool all = between[0] == kSkin && between[1] == kSkin;
  const int first = surfaces.body(between[0]), second = surfaces.body(between[1]);
  if (!all && (first < 0 || second < 0)) return false;
  bool found = false;
  for (TouchingBodies& pair : surfaces.touching) {
    if (!all && std::minmax(pair.first, pair.second) != std::minmax(first, second)) continue;
    pair.friction = coefficient;
    found = true;
  }
  if (!found) item.child("between").fail("their skin does not touch; contact.self or contact.bodies lets it");
  return true;
}

void read_friction_of_pair(const YamlNode& item, Surfaces& surfaces) {
  std::vector<std::string> between = read_names(item.child("between"));
  const double coefficient = item.number("coefficient", AllowedRange::not_negative());
  if (read_friction_of_skin(item, between, coefficient, surfaces)) return;
  if (between[0] == between[1]) item.child("between").fail("must be two names, of skin or obstacles: [skin, floor]");
  if (between[1] == kSkin) std::swap(between[0], between[1]);
  Obstacle& second = find_obstacle(item, between[1], surfaces);
  if (between[0] == kSkin) {
    second.friction = coefficient;
    return;
  }
  Obstacle& first = find_obstacle(item, between[0], surfaces);
  if (!first.is_free() && !second.is_free())
    item.child("between").fail("neither '" + first.name + "' nor '" + second.name +
                               "' is free, so they do not touch; must have one with mass_kg");
  first.friction_on[second.name] = coefficient;
}

// Of every pair.
void set_friction(double coefficient, Surfaces& surfaces) {
  for (TouchingBodies& pair : surfaces.touching) pair.friction = coefficient;
  for (Obstacle& obstacle : surfaces.obstacles) {
    obstacle.friction = coefficient;
    if (!obstacle.is_free()) continue;
    for (const Obstacle& other : surfaces.obstacles)
      if (&other != &obstacle) obstacle.friction_on[other.name] = coefficient;
  }
}

// One coefficient for all pairs, or a list of pairs.
void read_friction(const YamlNode& contact, Surfaces& surfaces) {
  const std::optional<YamlNode> node = contact.optional_child("friction");
  if (!node) return;
  if (node->is_scalar()) {
    set_friction(node->as_number(AllowedRange::not_negative()), surfaces);
    return;
  }
  for (const YamlNode& item : node->items()) read_friction_of_pair(item, surfaces);
}

// Stated, or by the volume of a shape whose edges are sharp.
double read_mass_kg(const YamlNode& item, const ObstacleShape& shape) {
  if (!item.has("density_kg_m3")) return item.number("mass_kg", AllowedRange::positive());
  const YamlNode node = item.child("density_kg_m3");
  if (item.has("mass_kg")) node.fail("must not stand beside mass_kg");
  if (std::holds_alternative<Plane>(shape)) node.fail("a plane has no volume, and cannot be free");
  return item.number("density_kg_m3", AllowedRange::positive()) * volume_m3(shape);
}

Obstacle read_obstacle(const YamlNode& item, const MesherOptions& mesher) {
  Obstacle obstacle{read_name(item), read_shape(item, mesher), read_motion(item), 0.0};
  if (!item.has("mass_kg") && !item.has("density_kg_m3")) {
    for (const char* key : {"inertia_kg_m2", "velocity_m_s", "angular_velocity_rad_s"})
      if (item.has(key)) item.child(key).fail("is for free obstacles; give mass_kg or density_kg_m3 too");
    return obstacle;
  }
  if (item.has("motion")) item.child("motion").fail("is for obstacles that it moves; one with mass_kg is free");
  obstacle.mass_kg = read_mass_kg(item, obstacle.shape);
  if (item.has("inertia_kg_m2")) obstacle.inertia_kg_m2 = item.vector3("inertia_kg_m2").asDiagonal();
  obstacle.velocity_m_s = item.vector3_or("velocity_m_s", Eigen::Vector3d::Zero());
  obstacle.angular_velocity_rad_s = item.vector3_or("angular_velocity_rad_s", Eigen::Vector3d::Zero());
  return obstacle;
}

// A step's time grows by the cube of the free obstacles.
void require_few_obstacles(const YamlNode& contact, const std::vector<Obstacle>& obstacles) {
  const int most = contact.integer_or("max_free_obstacles", limits::kFreeObstacles, 0, limits::kObstacles);
  const auto free = std::count_if(obstacles.begin(), obstacles.end(), [](const Obstacle& o) { return o.is_free(); });
  if (obstacles.size() > static_cast<std::size_t>(limits::kObstacles))
    contact.child("obstacles")
        .fail("has " + std::to_string(obstacles.size()) + " obstacles, at most " + std::to_string(limits::kObstacles) +
              " are read");
  if (free > most)
    contact.child("obstacles")
        .fail(std::to_string(free) + " have mass_kg, at most contact.max_free_obstacles, " + std::to_string(most) +
              ", may; a step's time grows by the cube of their number");
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

void read_contact(const YamlNode& scene, const MesherOptions& mesher, Body& body) {
  const std::optional<YamlNode> contact = scene.optional_child("contact");
  if (!contact) return;
  Surfaces surfaces;
  surfaces.bodies = body.mesh().bodies;
  surfaces.touching = read_touching(*contact, surfaces);
  const std::vector<YamlNode> items = contact->optional_sequence("obstacles");
  for (const YamlNode& item : items) surfaces.obstacles.push_back(read_obstacle(item, mesher));
  require_few_obstacles(*contact, surfaces.obstacles);
  read_friction(*contact, surfaces);
  for (std::size_t i = 0; i < items.size(); ++i) {
    double& friction = surfaces.obstacles[i].friction;
    friction = items[i].number_or("friction", friction, AllowedRange::not_negative());
  }
  in_section(*contact, [&] {
    body.let_skin_touch(std::move(surfaces.touching));
    body.set_obstacles(std::move(surfaces.obstacles));
  });
}

}  // namespace soft_robot_lab
