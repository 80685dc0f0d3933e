// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/robot/design/solid.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <tuple>
#include <utility>

#include "file_solid.h"
#include "mesh_formats.h"
#include "settings/limits.h"
#include "settings/named_file.h"
#include "settings/read_points.h"
#include "solid_kind_names.h"

namespace soft_robot_lab {
namespace {

using Kind = Solid::Kind;

constexpr AllowedRange kScale{1e-3, 1e3};
constexpr double kShortest_m = 1e-6;  // points within 1e-7 are one for the kernel
constexpr AllowedRange kLength{kShortest_m, std::numeric_limits<double>::infinity()};

// The one key of the node that names a shape.
Kind read_kind(const YamlNode& node) {
  if (!node.is_map()) node.fail("must be a solid such as {box: {size_m: [...], center_m: [...]}}");
  const std::vector<std::string>& names = solid_kind_names();
  std::string all;
  std::vector<size_t> found;
  for (size_t i = 0; i < names.size(); ++i) {
    all += (i == 0 ? "" : ", ") + names[i];
    if (node.has(names[i])) found.push_back(i);
  }
  if (found.size() > 1) {
    node.fail("'" + names[found[0]] + "' and '" + names[found[1]] + "' in one solid; put them in a union: [...]");
  }
  if (found.empty()) {
    std::string keys;
    for (const std::string& key : node.keys()) keys += (keys.empty() ? "" : ", ") + key;
    node.fail("holds no shape but '" + keys + "'; must hold one of " + all);
  }
  return static_cast<Kind>(found[0]);
}

// Stands beside the shape or among its dimensions. It ends up between double quotes in mesh files.
std::string read_name(const YamlNode& solid, const YamlNode& shape) {
  const bool inside = shape.is_map() && shape.has("name");
  if (inside && solid.has("name")) solid.fail("has two names; keep one");
  if (!inside && !solid.has("name")) return "";
  const YamlNode& node = inside ? shape : solid;
  const std::string name = node.text("name");
  const bool printable = std::all_of(name.begin(), name.end(), [](char c) { return c != '"' && (c < 0 || c >= ' '); });
  if (name.empty() || !printable)
    node.child("name").fail("'" + name + "' is no name: it must have letters and no double quotes");
  return name;
}

void read_box(const YamlNode& node, Solid& solid) {
  solid.size_m = node.vector3("size_m");
  solid.center_m = node.vector3("center_m");
  for (const YamlNode& edge : node.sequence("size_m")) edge.as_number(kLength);
}

void read_sphere(const YamlNode& node, Solid& solid) {
  solid.radius_m = node.number("radius_m", kLength);
  solid.center_m = node.vector3("center_m");
}

void read_axis(const YamlNode& node, Solid& solid) {
  solid.start_m = node.vector3("start_m");
  solid.end_m = node.vector3("end_m");
  if ((solid.end_m - solid.start_m).norm() < kShortest_m)
    node.fail("start_m and end_m are the same point, or nearer than " + format_number(kShortest_m) + " m");
}

void read_cylinder(const YamlNode& node, Solid& solid) {
  read_axis(node, solid);
  solid.radius_m = solid.end_radius_m = node.number("radius_m", kLength);
}

void read_cone(const YamlNode& node, Solid& solid) {
  read_axis(node, solid);
  solid.radius_m = node.number("radius_m", AllowedRange::not_negative());
  solid.end_radius_m = node.number("end_radius_m", AllowedRange::not_negative());
  if (std::max(solid.radius_m, solid.end_radius_m) < kShortest_m)
    node.fail("radius_m and end_radius_m are both 0, or less than " + format_number(kShortest_m) + " m");
  // The kernel takes no cone that nearly is a cylinder, or nearly has a tip.
  if (std::abs(solid.radius_m - solid.end_radius_m) < kShortest_m) solid.end_radius_m = solid.radius_m;
  for (double* radius_m : {&solid.radius_m, &solid.end_radius_m})
    if (*radius_m < kShortest_m) *radius_m = 0.0;
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

bool segments_meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                   const Eigen::Vector2d& d) {
  const auto side = [](const auto& p, const auto& q, const auto& r) { return cross(q - p, r - p); };
  const auto between = [](const auto& p, const auto& q, const auto& r) { return (p - r).dot(q - r) <= 0; };
  const double abc = side(a, b, c), abd = side(a, b, d), cda = side(c, d, a), cdb = side(c, d, b);
  if (((abc > 0) != (abd > 0)) && ((cda > 0) != (cdb > 0)) && abc != 0 && abd != 0 && cda != 0 && cdb != 0) return true;
  return (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) || (cda == 0 && between(c, d, a)) ||
         (cdb == 0 && between(c, d, b));
}

void check_polygon(const YamlNode& node, const std::vector<Eigen::Vector2d>& corners) {
  const size_t n = corners.size();
  if (n < 3) node.fail("has " + std::to_string(n) + " corners, must have at least 3");
  double area = 0;
  for (size_t i = 0; i < n; ++i) {
    const size_t next = (i + 1) % n;
    area += cross(corners[i], corners[next]) / 2;
    if ((corners[next] - corners[i]).norm() >= kShortest_m) continue;
    node.fail("corners " + std::to_string(i) + " and " + std::to_string(next) + " are the same, or nearer than " +
              format_number(kShortest_m) + " m");
  }
  if (area == 0) node.fail("encloses no area");
  for (size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % n];
    for (size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      if (!segments_meet(a, b, corners[j], corners[(j + 1) % n])) continue;
      node.fail("the edges after corners " + std::to_string(i) + " and " + std::to_string(j) + " cross");
    }
  }
}

// Before anything is made of them: what the kernel does with many takes it hours.
void require_few(const YamlNode& node, std::size_t count, int most) {
  if (count > static_cast<std::size_t>(most))
    node.fail("has " + std::to_string(count) + " items, at most " + std::to_string(most) + " are read");
}

// With each copy of an array; beyond the limit no more are counted.
std::size_t solid_count(const Solid& solid) {
  std::size_t count = solid.kind == Kind::array ? 0 : 1;
  for (const Solid& part : solid.parts) count += solid_count(part);
  const std::size_t copies = solid.kind == Kind::array ? static_cast<std::size_t>(solid.count) : 1;
  return std::min<std::size_t>(count * copies, 1000000);
}

void read_polygon(const YamlNode& node, Solid& solid) {
  for (const YamlNode& item : node.sequence("polygon_m")) {
    const Eigen::VectorXd corner = item.as_numbers();
    if (corner.size() != 2) item.fail("has " + std::to_string(corner.size()) + " numbers, must have 2: [x, y]");
    solid.polygon_m.emplace_back(corner);
  }
  require_few(node.child("polygon_m"), solid.polygon_m.size(), limits::kPolygonCorners);
  check_polygon(node.child("polygon_m"), solid.polygon_m);
}

void read_extrude(const YamlNode& node, Solid& solid) {
  read_polygon(node, solid);
  const Eigen::VectorXd z_m = node.child("z_m").as_numbers();
  if (z_m.size() != 2 || !(z_m[1] - z_m[0] >= kShortest_m))
    node.child("z_m").fail("must be [min, max], at least " + format_number(kShortest_m) + " m apart");
  solid.z_m = z_m;
}

Eigen::Vector3d read_direction(const YamlNode& node, const std::string& key) {
  const Eigen::Vector3d given = node.vector3(key);
  if (given.norm() < 1e-9) node.child(key).fail("has no length");
  if (!(given.norm() <= 1e9)) node.child(key).fail("is longer than 1e9; its length does not matter");
  return given;
}

// A disc, or a polygon whose x runs along `x_axis` as far as the curve's start lets it.
void read_sweep(const YamlNode& node, Solid& solid) {
  solid.spline_m = read_points(node, "spline_m");
  require_few(node.child("spline_m"), solid.spline_m.size(), limits::kSplinePoints);
  if (solid.spline_m.size() < 2) node.child("spline_m").fail("has less than 2 points");
  if (node.has("radius_m") == node.has("polygon_m")) node.fail("must have one of radius_m, polygon_m");
  if (node.has("radius_m")) {
    solid.radius_m = node.number("radius_m", kLength);
    return;
  }
  read_polygon(node, solid);
  solid.axis = read_direction(node, "x_axis");
  const Eigen::Vector3d along = solid.spline_m[1] - solid.spline_m[0];
  if (along.cross(solid.axis).norm() < 1e-6 * along.norm() * solid.axis.norm())
    node.child("x_axis").fail("runs along the curve's start, must run across it");
}

void read_parts(const YamlNode& node, Solid& solid) {
  for (const YamlNode& item : node.items()) solid.parts.push_back(read_solid(item));
  const size_t least = solid.kind == Kind::union_of ? 1 : 2;
  if (solid.parts.size() < least) {
    node.fail("has " + std::to_string(solid.parts.size()) + " solids, must have at least " + std::to_string(least));
  }
}

Eigen::Vector3d vector3_or_zero(const YamlNode& node, const std::string& key) {
  return node.has(key) ? node.vector3(key) : Eigen::Vector3d::Zero().eval();
}

Solid read_moved(const YamlNode& node) { return read_solid(node.child("solid")); }

void read_rotate(const YamlNode& node, Solid& solid) {
  solid.parts = {read_moved(node)};
  solid.axis = read_direction(node, "axis");
  solid.angle_deg = node.number("angle_deg", {-360, 360});
  solid.center_m = vector3_or_zero(node, "center_m");
}

void read_translate(const YamlNode& node, Solid& solid) {
  solid.parts = {read_moved(node)};
  solid.by_m = node.vector3("by_m");
}

void read_scale(const YamlNode& node, Solid& solid) {
  solid.parts = {read_moved(node)};
  solid.factor = node.number("factor", kScale);
  solid.center_m = vector3_or_zero(node, "center_m");
}

void read_mirror(const YamlNode& node, Solid& solid) {
  solid.parts = {read_moved(node)};
  solid.axis = read_direction(node, "normal");
  solid.center_m = vector3_or_zero(node, "center_m");
}

void read_array(const YamlNode& node, Solid& solid) {
  solid.parts = {read_moved(node)};
  solid.count = node.integer("count", 1, limits::kSolidCopies);
  solid.by_m = vector3_or_zero(node, "by_m");
  if (node.has("axis")) solid.axis = read_direction(node, "axis");
  solid.angle_deg = node.number_or("angle_deg", 0, {-360, 360});
  solid.center_m = vector3_or_zero(node, "center_m");
  if (solid.by_m.isZero() && solid.angle_deg == 0) node.fail("needs by_m or angle_deg between its copies");
}

// Of all edges, or of those that lie in a box.
void read_fillet(const YamlNode& node, Solid& solid) {
  solid.parts = {read_moved(node)};
  solid.radius_m = node.number("radius_m", kLength);
  solid.start_m.setConstant(-limits::kPlace_m);
  solid.end_m.setConstant(limits::kPlace_m);
  const std::optional<YamlNode> box = node.optional_child("edges_in");
  if (!box) return;
  solid.start_m = box->vector3("min_m");
  solid.end_m = box->vector3("max_m");
  if ((solid.start_m.array() > solid.end_m.array()).any()) box->fail("min_m lies beyond max_m");
}

// With the ending of one of these formats.
std::string read_file(const YamlNode& node, const std::vector<MeshFormat>& formats, const std::string& endings) {
  namespace fs = std::filesystem;
  const fs::path file = named_file(node);
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) node.fail("there is no file " + file.string());
  if (std::none_of(formats.begin(), formats.end(), [&](MeshFormat format) { return has_ending_of(file, format); }))
    node.fail("'" + file.string() + "' must end with " + endings);
  return file.string();
}

// Returns how many files there are.
int scale_files_by(double factor, Solid& solid) {
  int files = 0;
  for (Solid& part : solid.parts) files += scale_files_by(factor, part);
  if (solid.kind != Kind::step_file && solid.kind != Kind::stl_file) return files;
  if (factor != 1.0) {
    Solid scaled;
    scaled.kind = Kind::scale;
    scaled.factor = factor;
    scaled.parts = {std::move(solid)};
    solid = std::move(scaled);
  }
  return 1;
}

struct NamedSolid {
  Solid solid;  // where it stands in the body
  int depth;
};

void collect_named(const Solid& solid, int depth, std::vector<NamedSolid>& named) {
  if (!solid.name.empty()) named.push_back({solid, depth});
  const size_t first = named.size();
  for (const Solid& part : solid.parts) collect_named(part, depth + 1, named);
  if (!solid.moves()) return;
  for (size_t i = first; i < named.size(); ++i) {
    Solid moved = solid;
    moved.name = named[i].solid.name;
    moved.material = named[i].solid.material;
    moved.parts = {named[i].solid};
    named[i].solid = moved;
  }
}

}  // namespace

Solid read_solid(const YamlNode& node) {
  using Read = void (*)(const YamlNode&, Solid&);
  static constexpr Read readers[] = {read_box,       read_sphere, read_cylinder, read_cone,  read_extrude,
                                     read_sweep,     read_parts,  read_parts,    read_parts, read_rotate,
                                     read_translate, read_scale,  read_mirror,   read_array, read_fillet};
  Solid solid;
  solid.kind = read_kind(node);
  const YamlNode shape = node.child(solid_kind_names()[static_cast<size_t>(solid.kind)]);
  solid.name = read_name(node, shape);
  solid.material = node.optional_child("material");
  if (solid.material && solid.name.empty()) solid.material->fail("belongs to a solid without a name; give it one");
  if (solid.kind == Kind::step_file || solid.kind == Kind::stl_file) {
    solid.file = solid.kind == Kind::stl_file ? read_file(shape, {MeshFormat::stl, MeshFormat::obj}, ".stl or .obj")
                                              : read_file(shape, {MeshFormat::step}, ".step or .stp");
  } else {
    readers[static_cast<size_t>(solid.kind)](shape, solid);
  }
  require_few(shape, solid_count(solid), limits::kSolids);
  return solid;
}

Solid read_file_solid(const YamlNode& node, const std::string& key) {
  Solid solid;
  solid.file =
      read_file(node.child(key), {MeshFormat::stl, MeshFormat::obj, MeshFormat::step}, ".stl, .obj, .step or .stp");
  solid.kind = has_ending_of(solid.file, MeshFormat::step) ? Kind::step_file : Kind::stl_file;
  scale_files_by(read_scale(node), solid);
  return solid;
}

double read_scale(const YamlNode& body) { return body.number_or("scale", 1.0, kScale); }

void scale_files(const YamlNode& body, Solid& solid) {
  const double factor = read_scale(body);
  if (scale_files_by(factor, solid) == 0 && body.has("scale"))
    body.child("scale").fail("multiplies files, and the solid names neither an STL nor a STEP file");
}

bool names_file(const Solid& solid) {
  return solid.kind == Kind::step_file || solid.kind == Kind::stl_file ||
         std::any_of(solid.parts.begin(), solid.parts.end(), names_file);
}

Solid read_body_solid(const YamlNode& body) {
  Solid solid = read_solid(body.child("solid"));
  scale_files(body, solid);
  return solid;
}

bool same_solid(const Solid& a, const Solid& b) {
  const auto shape = [](const Solid& one) {
    return std::tie(one.kind, one.name, one.size_m, one.center_m, one.start_m, one.end_m, one.radius_m,
                    one.end_radius_m, one.polygon_m, one.spline_m, one.z_m, one.axis, one.angle_deg, one.by_m,
                    one.factor, one.count, one.file);
  };
  return shape(a) == shape(b) && std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end(), same_solid);
}

std::vector<Solid> named_solids(const Solid& solid) {
  std::vector<NamedSolid> named;
  collect_named(solid, 0, named);
  std::reverse(named.begin(), named.end());
  std::stable_sort(named.begin(), named.end(), [](const auto& a, const auto& b) { return a.depth > b.depth; });
  std::vector<Solid> result;
  for (NamedSolid& each : named) result.push_back(std::move(each.solid));
  return result;
}

std::vector<Solid> solids_with_material(const Solid& solid) {
  std::vector<Solid> result;
  for (Solid& named : named_solids(solid))
    if (named.material) result.push_back(std::move(named));
  return result;
}

}  // namespace soft_robot_lab
