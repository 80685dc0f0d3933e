// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <set>
#include <sstream>

#include "sections.h"
#include "settings/read_name.h"
#include "settings/words.h"
#include "soft_robot_lab/robot/design/solid.h"

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
void fix(const YamlNode& scene, const YamlNode& section, int index, Body& body) {
  if (has_obstacles(scene) && !section.has("fixed")) return;
  const YamlNode list = section.child("fixed");
  if (list.items().empty()) list.fail("is empty: a body that nothing holds has no equilibrium");
  for (const YamlNode& item : list.items()) {
    const Box box = read_box(item);
    const Eigen::Matrix<bool, 3, 1> axes = read_axes(item);
    const std::string name = item.has("name") ? read_name(item) : "";
    const int count =
        in_section(item, [&] { return body.fix_nodes(box.min_m, box.max_m, axes, read_motion(item), name, index); });
    if (count == 0) item.fail(miss("node", box, body));
  }
}

void load_skin(const YamlNode& item, Body& body) {
  const Box box = read_box(item);
  const std::optional<int> owner = read_owner(item, body.mesh());
  if (item.has("traction_pa") == item.has("force_n")) item.fail("must have one of traction_pa, force_n");
  if (item.has("force_n")) {
    const Eigen::Vector3d force_n = item.vector3("force_n");
    try {
      body.add_force(box.min_m, box.max_m, force_n, owner);
    } catch (const std::invalid_argument&) {
      item.fail(miss("part of a boundary face, and no edge of one,", box, body));
    }
    return;
  }
  const Eigen::Vector3d traction_pa = item.vector3("traction_pa");
  if (body.add_traction(box.min_m, box.max_m, traction_pa, owner) <= 0.0)
    item.fail(miss("part of a boundary face", box, body));
}

Eigen::Vector3d marker_position_m(const YamlNode& item, const YamlNode& scene) {
  const std::string name = item.text("marker");
  std::vector<std::string> known;
  for (const YamlNode& marker : scene.optional_sequence("markers")) {
    known.push_back(read_name(marker));
    if (known.back() == name) return marker.vector3("position_m");
  }
  item.child("marker").fail("unknown marker '" + name + "'; known: " + (known.empty() ? "none" : join(known)));
}

// What acts at one point: a force, or a weight that hangs there.
void load_point(const YamlNode& item, const YamlNode& scene, Body& body) {
  constexpr double kOnBody = 1e-6;  // of the body's size
  const bool at_marker = item.has("marker");
  const YamlNode where = item.child(at_marker ? "marker" : "point_m");
  const Eigen::Vector3d point_m = at_marker ? marker_position_m(item, scene) : item.vector3("point_m");
  const MeshLocator locator(body.mesh(), read_owner(item, body.mesh()));
  const Location location = locator.locate(point_m);
  if (location.distance_m > kOnBody * body.size_m()) {
    std::ostringstream text;
    text << "lies " << location.distance_m << " m off the body, out of range [0, " << kOnBody * body.size_m()
         << "]; the nearest point of the body is " << span(location.nearest_m, location.nearest_m);
    where.fail(text.str());
  }
  if (item.has("string_m"))
    item.child("string_m")
        .fail("a weight on a string is not supported; leave it out: the weight is fixed to its point");
  if (item.has("mass_kg") == item.has("force_n")) item.fail("must have one of mass_kg, force_n");
  if (item.has("force_n")) {
    body.add_force(locator.embed(location), item.vector3("force_n"));
  } else {
    body.hang(locator.embed(location), item.number("mass_kg", AllowedRange::positive()));
  }
}

void load(const YamlNode& item, const YamlNode& scene, Body& body) {
  if (item.has("box") + item.has("point_m") + item.has("marker") != 1)
    item.fail("must have one of box, point_m, marker");
  if (item.has("box")) {
    load_skin(item, body);
  } else {
    load_point(item, scene, body);
  }
}

// Names of regions, and where their materials stand: with a solid, or in `regions` for the groups of a mesh file.
std::map<std::string, YamlNode> own_materials(const YamlNode& section) {
  std::map<std::string, YamlNode> materials;
  const auto add = [&](const std::string& name, const YamlNode& material) {
    if (!materials.emplace(name, material).second) material.fail("'" + name + "' has a material already");
  };
  if (section.has("solid")) {
    if (section.has("regions"))
      section.child("regions").fail("belongs to a mesh file; give a named solid its `material` instead");
    const Solid solid = read_solid(section.child("solid"));
    for (const Solid& region : solids_with_material(solid)) add(region.name, *region.material);
    return materials;
  }
  for (const YamlNode& region : section.optional_sequence("regions")) add(read_name(region), region.child("material"));
  return materials;
}

// Of one body: its own ones, and `material` everywhere else.
void read_region_materials(const YamlNode& section, int index, const TetMesh& mesh, std::vector<Material>& of_regions) {
  const std::map<std::string, YamlNode> own = own_materials(section);
  const std::optional<YamlNode> node = section.optional_child("material");
  const Material elsewhere = node ? read_material(*node) : Material();
  std::set<std::string> unused;
  for (const auto& [name, material] : own) unused.insert(name);
  std::vector<std::string> known;
  for (std::size_t region = 0; region < mesh.regions.size(); ++region) {
    if (mesh.regions[region].body != index) continue;
    const std::string& name = mesh.regions[region].name;
    if (!name.empty()) known.push_back(name);
    const auto found = own.find(name);
    of_regions[region] = found == own.end() ? elsewhere : read_material(found->second);
    unused.erase(name);
  }
  if (unused.empty()) return;
  own.at(*unused.begin())
      .fail("no element of the body lies in '" + *unused.begin() +
            "'; regions of its mesh: " + (known.empty() ? "none with a name" : join(known)));
}

std::vector<Material> region_materials(const std::vector<YamlNode>& sections, const TetMesh& mesh) {
  std::vector<Material> of_regions(mesh.regions.size());
  for (std::size_t i = 0; i < sections.size(); ++i)
    read_region_materials(sections[i], static_cast<int>(i), mesh, of_regions);
  return of_regions;
}

}  // namespace

std::vector<YamlNode> body_sections(const YamlNode& scene) {
  std::vector<YamlNode> sections{scene.child("body")};
  for (const YamlNode& further : scene.optional_sequence("bodies")) sections.push_back(further);
  return sections;
}

std::vector<YamlNode> materials_of(const YamlNode& body) {
  std::vector<YamlNode> materials;
  if (const std::optional<YamlNode> own = body.optional_child("material")) materials.push_back(*own);
  for (const auto& [name, material] : own_materials(body)) materials.push_back(material);
  return materials;
}

Body read_body(const YamlNode& scene, TetMesh mesh) {
  const YamlNode section = scene.child("body");
  const std::vector<YamlNode> sections = body_sections(scene);
  std::vector<Material> materials = region_materials(sections, mesh);
  Body body = in_section(section, [&] { return Body(std::move(mesh), std::move(materials)); });
  const bool averaged = section.choice_or("linear_volume", "element", {"element", "vertex_averaged"}) != "element";
  if (averaged) in_section(section, [&] { body.set_linear_volume(LinearVolume::vertex_averaged); });
  in_section(section, [&] { body.set_viscosity(read_viscosity(section)); });
  for (std::size_t i = 0; i < sections.size(); ++i) fix(scene, sections[i], static_cast<int>(i), body);
  for (const YamlNode& item : scene.optional_sequence("loads")) load(item, scene, body);
  body.set_gravity(scene.vector3_or("gravity_m_s2", body.gravity_m_s2()));
  read_fibres(scene, body);
  return body;
}

}  // namespace soft_robot_lab
