// SPDX-License-Identifier: BSD-3-Clause
#include <charconv>

#include "settings/words.h"
#include "soft_robot_lab/robot/design/solid.h"
#include "solid_kind_names.h"

namespace soft_robot_lab {
namespace {

using Kind = Solid::Kind;

std::string number_text(double value) {
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, 17).ptr};
}

template <typename Vector>
std::string vector_text(const Vector& vector) {
  std::string text;
  for (Eigen::Index i = 0; i < vector.size(); ++i) text += (i == 0 ? "" : ", ") + number_text(vector[i]);
  return "[" + text + "]";
}

std::string moved_text(const Solid& solid) {
  const std::string inner = "{solid: " + to_yaml(solid.parts[0]), center = ", center_m: " + vector_text(solid.center_m);
  const std::string axis = vector_text(solid.axis), by = ", by_m: " + vector_text(solid.by_m);
  const std::string angle = ", angle_deg: " + number_text(solid.angle_deg);
  if (solid.kind == Kind::rotate) return inner + ", axis: " + axis + angle + center + "}";
  if (solid.kind == Kind::translate) return inner + by + "}";
  if (solid.kind == Kind::scale) return inner + ", factor: " + number_text(solid.factor) + center + "}";
  if (solid.kind == Kind::mirror) return inner + ", normal: " + axis + center + "}";
  return inner + ", count: " + std::to_string(solid.count) + by + ", axis: " + axis + angle + center + "}";
}

template <typename Points>
std::string list_text(const Points& points) {
  std::string list;
  for (const auto& point : points) list += (list.empty() ? "" : ", ") + vector_text(point);
  return "[" + list + "]";
}

std::string sweep_text(const Solid& solid) {
  const std::string start = "{spline_m: " + list_text(solid.spline_m);
  if (solid.polygon_m.empty()) return start + ", radius_m: " + number_text(solid.radius_m) + "}";
  return start + ", polygon_m: " + list_text(solid.polygon_m) + ", x_axis: " + vector_text(solid.axis) + "}";
}

std::string shape_text(const Solid& solid) {
  if (solid.moves()) return moved_text(solid);
  const std::string center = "center_m: " + vector_text(solid.center_m);
  const std::string radius = "radius_m: " + number_text(solid.radius_m);
  const std::string axis = "start_m: " + vector_text(solid.start_m) + ", end_m: " + vector_text(solid.end_m);
  std::string list;
  switch (solid.kind) {
    case Kind::box:
      return "{size_m: " + vector_text(solid.size_m) + ", " + center + "}";
    case Kind::sphere:
      return "{" + radius + ", " + center + "}";
    case Kind::cylinder:
      return "{" + axis + ", " + radius + "}";
    case Kind::cone:
      return "{" + axis + ", " + radius + ", end_radius_m: " + number_text(solid.end_radius_m) + "}";
    case Kind::extrude:
      return "{polygon_m: " + list_text(solid.polygon_m) + ", z_m: " + vector_text(solid.z_m) + "}";
    case Kind::sweep:
      return sweep_text(solid);
    case Kind::fillet:
      return "{solid: " + to_yaml(solid.parts[0]) + ", " + radius +
             ", edges_in: {min_m: " + vector_text(solid.start_m) + ", max_m: " + vector_text(solid.end_m) + "}}";
    case Kind::union_of:
    case Kind::difference:
    case Kind::intersection:
      for (const Solid& part : solid.parts) list += (list.empty() ? "" : ", ") + to_yaml(part);
      return "[" + list + "]";
    default:
      break;
  }
  return quote(solid.file);
}

}  // namespace

const std::vector<std::string>& solid_kind_names() {
  static const std::vector<std::string> names = {"box",    "sphere",     "cylinder",     "cone",   "extrude",   "sweep",
                                                 "union",  "difference", "intersection", "rotate", "translate", "scale",
                                                 "mirror", "array",      "fillet",       "step",   "stl"};
  return names;
}

std::string to_yaml(const Solid& solid) {
  const std::string name = solid.name.empty() ? "" : ", name: " + quote(solid.name);
  return "{" + solid_kind_names()[static_cast<size_t>(solid.kind)] + ": " + shape_text(solid) + name + "}";
}

}  // namespace soft_robot_lab
