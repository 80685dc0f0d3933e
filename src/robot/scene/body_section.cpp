// SPDX-License-Identifier: BSD-3-Clause
#include <sstream>

#include "sections.h"

namespace soft_robot_lab {
namespace {

struct Box {
  Eigen::Vector3d min_m, max_m;
};

Box read_box(const YamlNode& owner) {
  const YamlNode node = owner.child("box");
  const Box box{node.vector3("min_m"), node.vector3("max_m")};
  if ((box.min_m.array() > box.max_m.array()).any()) node.fail("min_m lies beyond max_m");
  return box;
}

std::string span(const Eigen::Vector3d& min_m, const Eigen::Vector3d& max_m) {
  const Eigen::IOFormat list(6, Eigen::DontAlignCols, ", ", ", ", "", "", "[", "]");
  std::ostringstream text;
  text << min_m.format(list) << " to " << max_m.format(list);
  return text.str();
}

std::string miss(const char* what, const Box& box, const Body& body) {
  const Eigen::Matrix3Xd& nodes_m = body.mesh().nodes_m;
  return std::string("no ") + what + " lies in the box " + span(box.min_m, box.max_m) + "; the body spans " +
         span(nodes_m.rowwise().minCoeff(), nodes_m.rowwise().maxCoeff());
}

Eigen::Matrix<bool, 3, 1> read_axes(const YamlNode& fixed) {
  if (!fixed.has("axes")) return Eigen::Matrix<bool, 3, 1>::Constant(true);
  Eigen::Matrix<bool, 3, 1> axes = Eigen::Matrix<bool, 3, 1>::Constant(false);
  const std::vector<YamlNode> items = fixed.sequence("axes");
  if (items.empty()) fixed.child("axes").fail("must list at least one of x, y, z");
  for (const YamlNode& item : items) {
    const std::string axis = item.as_text();
    if (axis != "x" && axis != "y" && axis != "z") item.fail("'" + axis + "' is not one of x, y, z");
    axes[axis[0] - 'x'] = true;
  }
  return axes;
}

Viscosity read_viscosity(const YamlNode& body) {
  Viscosity viscosity;
  if (const auto damping = body.optional_child("damping")) {
    viscosity.rayleigh_mass_per_s = damping->number_or("rayleigh_mass_per_s", viscosity.rayleigh_mass_per_s);
    viscosity.rayleigh_stiffness_s = damping->number_or("rayleigh_stiffness_s", viscosity.rayleigh_stiffness_s);
  }
  if (const auto hysteresis = body.optional_child("hysteresis")) {
    viscosity.hysteresis_ratio = hysteresis->number("stiffness_ratio");
    viscosity.relaxation_time_s = hysteresis->number("relaxation_time_s");
  }
  return viscosity;
}

bool has_obstacles(const YamlNode& scene) {
  const std::optional<YamlNode> contact = scene.optional_child("contact");
  return contact && !contact->optional_sequence("obstacles").empty();
}

// A body that may lie on something need not be held.
void fix(const YamlNode& scene, const YamlNode& section, Body& body) {
  if (has_obstacles(scene) && !section.has("fixed")) return;
  const YamlNode list = section.child("fixed");
  if (list.items().empty()) list.fail("is empty: a body that nothing holds has no equilibrium");
  for (const YamlNode& item : list.items()) {
    const Box box = read_box(item);
    const int count = body.fix_nodes(box.min_m, box.max_m, read_axes(item));
    if (count == 0) item.fail(miss("node", box, body));
  }
}

void load(const YamlNode& item, Body& body) {
  const Box box = read_box(item);
  if (item.has("traction_pa") == item.has("force_n")) item.fail("must have one of traction_pa, force_n");
  const bool traction = item.has("traction_pa");
  const Eigen::Vector3d value = item.vector3(traction ? "traction_pa" : "force_n");
  // Asked first without a load: both kinds need a surface to act on.
  if (body.add_traction(box.min_m, box.max_m, Eigen::Vector3d::Zero()) <= 0.0) {
    item.fail(miss("whole boundary face", box, body));
  }
  if (traction) {
    body.add_traction(box.min_m, box.max_m, value);
  } else {
    body.add_force(box.min_m, box.max_m, value);
  }
}

}  // namespace

Body read_body(const YamlNode& scene, TetMesh mesh) {
  const YamlNode section = scene.child("body");
  const std::optional<YamlNode> node = section.optional_child("material");
  const Material material = node ? read_material(*node) : Material();
  Body body = in_section(section, [&] { return Body(std::move(mesh), material); });
  const bool averaged = section.choice_or("linear_volume", "element", {"element", "vertex_averaged"}) != "element";
  if (averaged) in_section(section, [&] { body.set_linear_volume(LinearVolume::vertex_averaged); });
  in_section(section, [&] { body.set_viscosity(read_viscosity(section)); });
  fix(scene, section, body);
  for (const YamlNode& item : scene.optional_sequence("loads")) load(item, body);
  body.set_gravity(scene.vector3_or("gravity_m_s2", body.gravity_m_s2()));
  return body;
}

}  // namespace soft_robot_lab
