// SPDX-License-Identifier: BSD-3-Clause
#include "solid_geometry.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <stdexcept>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

namespace occ = gmsh::model::occ;
using Kind = Solid::Kind;
using Volumes = gmsh::vectorpair;  // pairs of dimension 3 and tag

Eigen::Vector3d scaled(const Eigen::Vector3d& value_m) { return kKernelUnitsPerMetre * value_m; }
double scaled(double value_m) { return kKernelUnitsPerMetre * value_m; }

Volumes build(const Solid& solid);

Volumes only_volumes(const Volumes& all) {
  Volumes volumes;
  std::copy_if(all.begin(), all.end(), std::back_inserter(volumes), [](const auto& e) { return e.first == 3; });
  return volumes;
}

Volumes build_box(const Solid& solid) {
  const Eigen::Vector3d corner = scaled(solid.center_m - solid.size_m / 2), size = scaled(solid.size_m);
  return {{3, occ::addBox(corner.x(), corner.y(), corner.z(), size.x(), size.y(), size.z())}};
}

Volumes build_sphere(const Solid& solid) {
  const Eigen::Vector3d centre = scaled(solid.center_m);
  return {{3, occ::addSphere(centre.x(), centre.y(), centre.z(), scaled(solid.radius_m))}};
}

Volumes build_cone(const Solid& solid) {
  const Eigen::Vector3d at = scaled(solid.start_m), axis = scaled(solid.end_m - solid.start_m);
  const double r1 = scaled(solid.radius_m), r2 = scaled(solid.end_radius_m);
  if (r1 == r2) return {{3, occ::addCylinder(at.x(), at.y(), at.z(), axis.x(), axis.y(), axis.z(), r1)}};
  return {{3, occ::addCone(at.x(), at.y(), at.z(), axis.x(), axis.y(), axis.z(), r1, r2)}};
}

int add_point(const Eigen::Vector3d& at_m) {
  const Eigen::Vector3d at = scaled(at_m);
  return occ::addPoint(at.x(), at.y(), at.z());
}

// A plane face; its corners lie at origin + x u + y v.
int add_polygon(const std::vector<Eigen::Vector2d>& polygon_m, const Eigen::Vector3d& origin_m,
                const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  std::vector<int> points, lines;
  for (const auto& corner : polygon_m) points.push_back(add_point(origin_m + corner.x() * u + corner.y() * v));
  for (size_t i = 0; i < points.size(); ++i) lines.push_back(occ::addLine(points[i], points[(i + 1) % points.size()]));
  return occ::addPlaneSurface({occ::addCurveLoop(lines)});
}

Volumes build_extrude(const Solid& solid) {
  const int base =
      add_polygon(solid.polygon_m, {0, 0, solid.z_m[0]}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
  Volumes all;
  occ::extrude({{2, base}}, 0, 0, scaled(solid.z_m[1]) - scaled(solid.z_m[0]), all);
  return only_volumes(all);
}

int add_disc(const Eigen::Vector3d& center_m, const Eigen::Vector3d& normal, double radius_m) {
  const Eigen::Vector3d centre = scaled(center_m), z = Eigen::Vector3d::UnitZ();
  const double radius = scaled(radius_m), turn = std::acos(std::clamp(normal.z(), -1.0, 1.0));
  const int disc = occ::addDisk(centre.x(), centre.y(), centre.z(), radius, radius);
  const Eigen::Vector3d axis = z.cross(normal).norm() > 0 ? z.cross(normal) : Eigen::Vector3d::UnitX();
  occ::rotate({{2, disc}}, centre.x(), centre.y(), centre.z(), axis.x(), axis.y(), axis.z(), turn);
  return disc;
}

// At the curve's start, and at right angles to it there.
int add_profile(const Solid& solid) {
  const Eigen::Vector3d at = solid.spline_m[0], along = (solid.spline_m[1] - at).normalized();
  if (solid.polygon_m.empty()) return add_disc(at, along, solid.radius_m);
  const Eigen::Vector3d u = (solid.axis - solid.axis.dot(along) * along).normalized();
  return add_polygon(solid.polygon_m, at, u, along.cross(u));
}

Volumes build_sweep(const Solid& solid) {
  std::vector<int> control;
  for (const Eigen::Vector3d& point : solid.spline_m) control.push_back(add_point(point));
  const int degree = std::min<int>(3, static_cast<int>(control.size()) - 1);
  const int wire = occ::addWire({occ::addBSpline(control, -1, degree)});
  const int profile = add_profile(solid);
  Volumes all;
  occ::addPipe({{2, profile}}, wire, all, "CorrectedFrenet");
  occ::remove({{2, profile}}, true);
  return only_volumes(all);
}

double volume_of(const Volumes& volumes) {
  double sum = 0.0;
  for (const auto& [dimension, tag] : volumes) {
    double part = 0.0;
    occ::getMass(dimension, tag, part);
    sum += part;
  }
  return sum;
}

Eigen::AlignedBox3d box_of(const gmsh::vectorpair& entities) {
  Eigen::AlignedBox3d box;
  for (const auto& [dimension, tag] : entities) {
    Eigen::Vector3d low, high;
    occ::getBoundingBox(dimension, tag, low.x(), low.y(), low.z(), high.x(), high.y(), high.z());
    box.extend(low).extend(high);
  }
  return box;
}

bool lies_in_box(int curve, const Solid& box) {
  constexpr double kSlack_m = 1e-6;
  const Eigen::Vector3d slack = Eigen::Vector3d::Constant(scaled(kSlack_m));
  return Eigen::AlignedBox3d(scaled(box.start_m) - slack, scaled(box.end_m) + slack).contains(box_of({{1, curve}}));
}

// The edges of two faces; what has one is a seam, as along a cylinder.
std::vector<int> edges_to_round(const Volumes& volumes, const Solid& solid) {
  occ::synchronize();
  gmsh::vectorpair faces, curves;
  gmsh::model::getBoundary(volumes, faces, true, false, false);
  gmsh::model::getBoundary(faces, curves, false, false, false);
  std::set<int> tags;
  for (const auto& curve : curves) tags.insert(curve.second);
  std::vector<int> edges;
  for (const int curve : tags) {
    std::vector<int> neighbours, ends;
    gmsh::model::getAdjacencies(1, curve, neighbours, ends);
    if (neighbours.size() == 2 && lies_in_box(curve, solid)) edges.push_back(curve);
  }
  return edges;
}

Volumes build_fillet(const Solid& solid) {
  const Volumes volumes = build(solid.parts[0]);
  if (volumes.empty()) return volumes;
  const std::vector<int> edges = edges_to_round(volumes, solid);
  if (edges.empty()) throw std::invalid_argument("fillet: no edge lies in edges_in");
  const double most = box_of(volumes).volume();  // rounded inner edges fill it, and nothing lies beyond it
  std::vector<int> tags;
  for (const auto& volume : volumes) tags.push_back(volume.second);
  Volumes all;
  double rounded = 0.0;  // of a radius too large the kernel makes what is no solid
  try {
    occ::fillet(tags, edges, {scaled(solid.radius_m)}, all);
    rounded = volume_of(only_volumes(all));
  } catch (const std::string&) {  // what Gmsh throws
  }
  if (!(rounded > 0.0 && rounded <= most))
    throw std::invalid_argument("fillet: the geometry kernel cannot round these " + std::to_string(edges.size()) +
                                " edges by radius_m " + std::to_string(solid.radius_m) +
                                "; take a smaller one, or fewer edges by edges_in");
  return only_volumes(all);
}

Volumes fuse(const Volumes& volumes) {
  if (volumes.size() < 2) return volumes;
  Volumes result;
  std::vector<Volumes> origins;
  occ::fuse({volumes[0]}, Volumes(volumes.begin() + 1, volumes.end()), result, origins);
  return result;
}

Volumes build_step(const Solid& solid) {
  Volumes all;
  try {
    occ::importShapes(solid.file, all, true, "step");
  } catch (const std::string&) {  // says that it could not read it
    throw std::invalid_argument(solid.file + ": is no whole STEP file; write it anew by the program that made it");
  }
  const Volumes volumes = only_volumes(all);
  if (volumes.empty()) throw std::invalid_argument(solid.file + ": holds no solid, surfaces or curves at most");
  return fuse(volumes);
}

Volumes build_union(const Solid& solid) {
  Volumes all;
  for (const Solid& part : solid.parts) {
    const Volumes volumes = build(part);
    all.insert(all.end(), volumes.begin(), volumes.end());
  }
  return fuse(all);
}

// Takes all away at once: the kernel sorts what lies apart by boxes, where one cut after the other would copy all that
// is left each time.
Volumes build_many_cuts(const Solid& solid) {
  Volumes parts, result;
  std::vector<Volumes> origins;
  for (size_t i = 1; i < solid.parts.size(); ++i) {
    const Volumes part = build(solid.parts[i]);
    parts.insert(parts.end(), part.begin(), part.end());
  }
  const Volumes whole = build(solid.parts[0]);
  if (whole.empty() || parts.empty()) return whole;
  occ::cut(whole, parts, result, origins);
  return only_volumes(result);
}

// Difference and intersection, one part after the other.
Volumes build_combination(const Solid& solid, bool cut) {
  constexpr size_t kMany = 32;  // few are quick either way
  if (cut && solid.parts.size() > kMany) return build_many_cuts(solid);
  Volumes rest = build(solid.parts[0]);
  for (size_t i = 1; i < solid.parts.size(); ++i) {
    const Volumes part = build(solid.parts[i]);
    if (rest.empty() || part.empty()) {
      if (!cut) return {};
      continue;
    }
    Volumes result;
    std::vector<Volumes> origins;
    if (cut) {
      occ::cut(rest, part, result, origins);
    } else {
      occ::intersect(rest, part, result, origins);
    }
    rest = only_volumes(result);
  }
  return rest;
}

void turn(const Volumes& volumes, const Solid& solid, double angle_deg) {
  const Eigen::Vector3d at = scaled(solid.center_m), axis = solid.axis;
  occ::rotate(volumes, at.x(), at.y(), at.z(), axis.x(), axis.y(), axis.z(), angle_deg * M_PI / 180);
}

void shift(const Volumes& volumes, const Eigen::Vector3d& by_m) {
  const Eigen::Vector3d by = scaled(by_m);
  occ::translate(volumes, by.x(), by.y(), by.z());
}

Volumes build_moved(const Solid& solid) {
  const Volumes volumes = build(solid.parts[0]);
  const Eigen::Vector3d at = scaled(solid.center_m), n = solid.axis.normalized();
  if (solid.kind == Kind::rotate) turn(volumes, solid, solid.angle_deg);
  if (solid.kind == Kind::translate) shift(volumes, solid.by_m);
  if (solid.kind == Kind::scale) occ::dilate(volumes, at.x(), at.y(), at.z(), solid.factor, solid.factor, solid.factor);
  if (solid.kind == Kind::mirror) occ::mirror(volumes, n.x(), n.y(), n.z(), -n.dot(at));
  return volumes;
}

// Each copy is turned, then moved, once more than the one before.
Volumes build_array(const Solid& solid) {
  Volumes all = build(solid.parts[0]);
  const Volumes first = all;
  for (int i = 1; i < solid.count; ++i) {
    Volumes copy;
    occ::copy(first, copy);
    if (solid.angle_deg != 0) turn(copy, solid, i * solid.angle_deg);
    shift(copy, i * solid.by_m);
    all.insert(all.end(), copy.begin(), copy.end());
  }
  return fuse(all);
}

Volumes build(const Solid& solid) {
  switch (solid.kind) {
    case Kind::box:
      return build_box(solid);
    case Kind::sphere:
      return build_sphere(solid);
    case Kind::cylinder:
    case Kind::cone:
      return build_cone(solid);
    case Kind::extrude:
      return build_extrude(solid);
    case Kind::sweep:
      return build_sweep(solid);
    case Kind::union_of:
      return build_union(solid);
    case Kind::difference:
      return build_combination(solid, true);
    case Kind::intersection:
      return build_combination(solid, false);
    case Kind::rotate:
    case Kind::translate:
    case Kind::scale:
    case Kind::mirror:
      return build_moved(solid);
    case Kind::array:
      return build_array(solid);
    case Kind::fillet:
      return build_fillet(solid);
    case Kind::step_file:
      return build_step(solid);
    case Kind::stl_file:
      break;
  }
  throw std::invalid_argument(solid.file +
                              ": an STL file must be the whole solid; to combine it with others, use STEP");
}

bool has_name(const Solid& solid) {
  return !solid.name.empty() || std::any_of(solid.parts.begin(), solid.parts.end(), has_name);
}

}  // namespace

namespace {

// What of the named solids lies in the body, and whose each piece is.
struct Pieces {
  Volumes volumes;
  std::vector<size_t> owners;  // among the names, in the order of named_solids
};

Pieces pieces_in(int body, const std::vector<Solid>& solids) {
  Pieces pieces;
  for (size_t i = 0; i < solids.size(); ++i) {
    Volumes found;
    std::vector<Volumes> origins;
    occ::intersect({{3, body}}, build(solids[i]), found, origins, -1, false, true);
    for (const auto& volume : found) {
      if (volume.first != 3) continue;
      pieces.volumes.push_back(volume);
      pieces.owners.push_back(i);
    }
  }
  return pieces;
}

std::vector<Solid> chosen(const Solid& solid, const std::vector<std::string>& names) {
  std::vector<Solid> result;
  for (const Solid& named : named_solids(solid))
    if (std::find(names.begin(), names.end(), named.name) != names.end()) result.push_back(named);
  return result;
}

}  // namespace

std::vector<NamedEntities> cut_body(int body, const Solid& solid, const std::vector<std::string>& names) {
  if (names.empty()) return {};
  const std::vector<Solid> solids = chosen(solid, names);
  const Pieces pieces = pieces_in(body, solids);
  if (pieces.volumes.empty()) return {};
  Volumes cut;
  std::vector<Volumes> origins;  // of the body, then of each piece: what it was cut into
  occ::fragment({{3, body}}, pieces.volumes, cut, origins);
  occ::synchronize();
  std::vector<NamedEntities> regions(solids.size() + 1);
  for (size_t i = 0; i < solids.size(); ++i) regions[i + 1].name = solids[i].name;
  for (const auto& part : cut) {
    size_t owner = solids.size();
    for (size_t i = 0; i < pieces.volumes.size(); ++i)
      if (std::count(origins[i + 1].begin(), origins[i + 1].end(), part) > 0) owner = std::min(owner, pieces.owners[i]);
    regions[owner == solids.size() ? 0 : owner + 1].entities.push_back(part.second);
  }
  regions.erase(std::remove_if(regions.begin(), regions.end(), [](const auto& r) { return r.entities.empty(); }),
                regions.end());
  return regions;
}

gmsh::vectorpair build_solid(const Solid& solid) {
  gmsh::option::setString("Geometry.OCCTargetUnit", "MM");
  const Volumes volumes = build(solid);
  occ::synchronize();
  return volumes;
}

int build_body(const Solid& solid) {
  // Touching faces of one plane become one, which makes better meshes, unless they may have different names.
  gmsh::option::setNumber("Geometry.OCCUnionUnify", has_name(solid) ? 0 : 1);
  const Volumes volumes = build_solid(solid);
  if (!(volume_of(volumes) > 0.0)) throw std::invalid_argument("empty solid: nothing is left of it");
  if (volumes.size() > 1) {
    throw std::invalid_argument("the solid falls into " + std::to_string(volumes.size()) + " parts, must be one");
  }
  return volumes[0].second;
}

}  // namespace soft_robot_lab
