// SPDX-License-Identifier: BSD-3-Clause
// Constructive solid geometry of a robot: the scene file's `solid`, read and checked without a geometry kernel.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

struct Solid {
  enum class Kind {
    box,
    sphere,
    cylinder,
    cone,
    extrude,
    sweep,
    union_of,
    difference,
    intersection,
    rotate,
    translate,
    scale,
    mirror,
    array,
    fillet,
    step_file,
    stl_file
  };
  Kind kind = Kind::box;
  // Names the surface where this solid bounds the body; may be empty. Where several named solids share a surface, the
  // one nested deepest names it, and of those the one written last.
  std::string name;
  // Of the part of the body that lies in this solid, which has a name then; the rules are those of surfaces.
  std::optional<YamlNode> material;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  // box
  Eigen::Vector3d center_m =
      Eigen::Vector3d::Zero();                        // box, sphere; what rotate, scale, mirror and array keep in place
  Eigen::Vector3d start_m = Eigen::Vector3d::Zero();  // cylinder, cone; fillet: lowest corner of where it rounds
  Eigen::Vector3d end_m = Eigen::Vector3d::Zero();    // the same; its highest corner
  double radius_m = 0.0;                              // sphere, cylinder, cone (at the start), sweep of a disc, fillet
  double end_radius_m = 0.0;                          // cone
  std::vector<Eigen::Vector2d> polygon_m;             // extrude: corners in x, y; sweep: along axis, and across it
  std::vector<Eigen::Vector3d> spline_m;              // sweep: control points of a cubic B-spline
  Eigen::Vector2d z_m = Eigen::Vector2d::Zero();      // extrude: from, to
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();    // rotate, array; the plane's normal of mirror; sweep: x
  double angle_deg = 0.0;                             // rotate; array: of one copy to the next
  Eigen::Vector3d by_m = Eigen::Vector3d::Zero();     // translate; array: of one copy to the next
  double factor = 1.0;                                // scale
  int count = 1;                                      // array
  std::string file;                                   // step_file, stl_file: absolute
  // union_of, difference (first minus the rest), intersection; rotate and its kin, and fillet, have one
  std::vector<Solid> parts;

  bool moves() const { return kind >= Kind::rotate && kind <= Kind::array; }
};

// Reads `solid: {box: ..., name: ...}` and its kin; relative files are found beside the file that names them.
// Throws SettingsError.
Solid read_solid(const YamlNode& node);

// `scale` of a body, 1 where it has none: by how much the numbers of its mesh, STL and STEP files are multiplied.
double read_scale(const YamlNode& body);

// Multiplies the STL and STEP files in a body's solid by its `scale`; how large they shall be is then part of the
// solid. Throws SettingsError where the body has a scale, and its solid no file.
void scale_files(const YamlNode& body, Solid& solid);

bool names_file(const Solid& solid);  // an STL or STEP file, here or below: `scale` of the body multiplies it

Solid read_body_solid(const YamlNode& body);  // its `solid`, with its files scaled

// Of shape, place and names alike, whatever their materials.
bool same_solid(const Solid& a, const Solid& b);

// Canonical text without materials, for mesh_robot, a process of its own: numbers have 17 digits, so that read_solid
// gives the solid back bit by bit.
std::string to_yaml(const Solid& solid);

// The solids here and below that have a name, or a material too, where they stand in the body. What counts more stands
// first: what is nested deeper, and of solids nested alike what is written later.
std::vector<Solid> named_solids(const Solid& solid);
std::vector<Solid> solids_with_material(const Solid& solid);

}  // namespace soft_robot_lab
