// SPDX-License-Identifier: BSD-3-Clause
#include "casting_settings.h"

namespace soft_robot_lab {
namespace {

// Keys of earlier versions.
void refuse_old_name(const YamlNode& node, const std::string& old, const std::string& now) {
  if (node.has(old)) node.fail(old + " is called " + now + " now");
}

std::optional<Eigen::Vector3d> read_direction(const YamlNode& node) {
  if (!node.has("direction")) return std::nullopt;
  const YamlNode direction = node.child("direction");
  if (direction.is_scalar()) {
    node.choice("direction", {"best"});
    return std::nullopt;
  }
  const Eigen::Vector3d given = node.vector3("direction");
  if (given.norm() < 1e-9) direction.fail("has no length; must be [x, y, z] or best");
  return given.normalized();
}

void read_limits(const YamlNode& node, CastingSettings& settings) {
  const auto positive = AllowedRange::positive();
  settings.min_thickness_m = node.number_or("min_thickness_m", settings.min_thickness_m, {1e-4, 0.1});
  settings.min_angle_deg = node.number_or("min_angle_deg", settings.min_angle_deg, {0, 90});
  settings.notch_radius_m = node.number_or("notch_radius_m", settings.notch_radius_m, {1e-6, 0.1});
  settings.min_draft_deg = node.number_or("min_draft_deg", settings.min_draft_deg, {0, 45});
  settings.max_stretch = node.number_or("max_stretch", settings.max_stretch, {1, 10});
  settings.min_radius_m = node.number_or("min_radius_m", settings.min_radius_m, AllowedRange::not_negative());
  settings.max_suction_strain = node.number_or("max_suction_strain", settings.max_suction_strain, positive);
  settings.max_core_aspect = node.number_or("max_core_aspect", settings.max_core_aspect, positive);
  settings.air_holes = node.boolean_or("air_holes", settings.air_holes);
  for (const YamlNode& solid : node.optional_sequence("bonded")) settings.inserts.push_back(read_solid(solid));
}

void read_sheath(const YamlNode& node, SheathSettings& sheath) {
  sheath.radius_m = node.number_or("radius_m", sheath.radius_m, AllowedRange::positive());
  sheath.wall_m = node.number_or("wall_m", sheath.wall_m, AllowedRange::not_negative());
  sheath.shelf = node.boolean_or("shelf", sheath.shelf);
  sheath.clearance_m = node.number_or("clearance_m", sheath.clearance_m, {0, 0.002});
  sheath.longest_slot_m = node.number_or("longest_slot_m", sheath.longest_slot_m, {0, 0.1});
}

void read_allowed(const YamlNode& node, MouldSettings& mould) {
  for (const YamlNode& item : node.optional_sequence("allow")) {
    const std::string name = item.as_text();
    if (name != "two_part" && name != "lid") item.fail("is '" + name + "', must be two_part or lid");
    (name == "lid" ? mould.allow_lid : mould.allow_two_part) = true;
  }
}

void read_printer(const YamlNode& node, MouldSettings& mould) {
  if (!node.has("printer_m")) return;
  mould.printer_m = node.vector3("printer_m");
  for (const YamlNode& edge : node.sequence("printer_m")) edge.as_number(AllowedRange::positive());
}

void read_mould(const YamlNode& node, MouldSettings& mould) {
  read_allowed(node, mould);
  read_printer(node, mould);
  mould.wall_m = node.number_or("wall_m", mould.wall_m, {0.001, 0.05});
  mould.min_wall_m = node.number_or("min_wall_m", mould.min_wall_m, {1e-4, 0.05});
  mould.flange_m = node.number_or("flange_m", mould.flange_m, {0.005, 0.1});
  mould.bolt_radius_m = node.number_or("bolt_radius_m", mould.bolt_radius_m, {0.0005, 0.01});
  mould.key_radius_m = node.number_or("key_radius_m", mould.key_radius_m, {0.001, 0.02});
  mould.clearance_m = node.number_or("clearance_m", mould.clearance_m, {0, 0.002});
  mould.air_hole_radius_m = node.number_or("air_hole_radius_m", mould.air_hole_radius_m, {1e-4, 0.005});
  refuse_old_name(node, "spout_radius_m", "sprue_radius_m");
  mould.sprue_radius_m = node.number_or("sprue_radius_m", mould.sprue_radius_m, {0.001, 0.02});
  mould.part_a_fraction = node.number_or("part_a_fraction", mould.part_a_fraction, {0, 1});
  mould.spare_fraction = node.number_or("spare_fraction", mould.spare_fraction, {0, 1});
}

}  // namespace

CastingSettings read_casting_settings(const YamlNode& robot) {
  CastingSettings settings;
  const std::optional<YamlNode> node = robot.optional_child("casting");
  if (!node) return settings;
  settings.direction = read_direction(*node);
  read_limits(*node, settings);
  read_mould(*node, settings.mould);
  if (const auto sheath = node->optional_child("sheath")) read_sheath(*sheath, settings.sheath);
  return settings;
}

}  // namespace soft_robot_lab
