// SPDX-License-Identifier: BSD-3-Clause
#include "cast_robot.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "build_solids.h"
#include "mechanics/mesh/cable_path.h"
#include "moved_bends.h"
#include "robot/design/mesh_quality.h"
#include "robot/design/surface_file.h"
#include "robot/scene/sections.h"
#include "settings/limits.h"
#include "settings/read_name.h"
#include "settings/words.h"
#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {
namespace {

constexpr double kEdgesAcross = 50;     // of the body's box: round sides get more by their curvature
constexpr double kFinestEdge_m = 1e-4;  // where they are rounder than any rule asks for
constexpr int kRuleSegments = 24;       // of seats, as thin as a straw: normals are the solid's anyway
constexpr double kBelow_m = 0.001;      // what is swept goes on below the floor

Surface surface_of_mesh(TetMesh mesh) {
  complete_boundary(mesh);
  return make_surface(mesh.nodes_m, mesh.faces.topRows(3));
}

void refuse_crossing(const Surface& surface) {
  if (const std::optional<Eigen::Vector3d> at = find_crossing(RayTree(surface)))
    throw std::invalid_argument("the surface crosses itself at " + place_text(*at));
}

Surface surface_of_body(const Solid& solid, const MesherOptions& options) {
  SurfaceRequest request;
  request.solid = solid;
  request.edges_across = kEdgesAcross;
  request.smallest_edge_m = kFinestEdge_m;
  Surface surface = read_off(surface_file_for(request, options));
  if (!holds_stl(solid)) return surface;
  refuse_crossing(surface);  // the geometry kernel makes no such surface
  surface.estimate_sags();   // and knows the normals of its own
  return surface;
}

// Not worth a Boolean where they are refused anyway.
bool can_lie_on_shelves(const std::vector<SheathPath>& paths, const Eigen::Vector3d& direction) {
  return steepest_sheath(paths, direction).worst_m >= kSteepest_deg &&
         nearest_footprints(paths, direction).worst_m >= 0;
}

std::vector<SheathPath> read_sheaths(const YamlNode& robot, double default_radius_m) {
  std::vector<SheathPath> paths;
  for (const YamlNode& cable : robot.optional_sequence("cables")) {
    SheathPath path;
    path.name = cable.text("name");
    path.radius_m = cable.number_or("sheath_radius_m", default_radius_m);
    if (!(path.radius_m > 0)) path.radius_m = default_radius_m;
    path.points_m = read_cable_path(cable).points_m;
    paths.push_back(std::move(path));
  }
  return paths;
}

// What is cast of a body.
Solid without_inserts(const Solid& body, const std::vector<Solid>& inserts) {
  if (inserts.empty()) return body;
  std::vector<Solid> parts{body};
  parts.insert(parts.end(), inserts.begin(), inserts.end());
  return combined(Solid::Kind::difference, parts);
}

void refuse_several(const YamlNode& section) { section.fail("casting knows one body of one material, not several"); }

void take_material(const Material& material, CastRobot& robot) {
  robot.youngs_modulus_pa = material.youngs_modulus_pa;
  robot.density_kg_m3 = material.density_kg_m3;
}

// All but the surface and what comes from the mesh for simulations.
CastRobotFile read_blocks(const YamlNode& settings, const SceneOptions& options) {
  CastRobotFile file;
  file.settings = read_casting_settings(settings);
  file.mesher = mesher_options(options);
  const YamlNode body = settings.child("body");
  if (body.has("solid")) file.solid = without_inserts(read_body_solid(body), file.settings.inserts);
  file.robot.sheaths = read_sheaths(settings, file.settings.sheath.radius_m);
  for (const YamlNode& fibre : settings.optional_sequence("fibres")) file.fibres.push_back(read_name(fibre));
  return file;
}

CastRobotFile cast_robot_of(const Scene& scene, const std::string& path, const SceneOptions& options) {
  const Body& body = scene.simulation->body();
  const YamlNode settings = with_overrides(YamlNode::load_file(path), options.overrides);
  const YamlNode section = settings.child("body");
  if (!body.one_material() || body.mesh().bodies.size() > 1) refuse_several(section);
  CastRobotFile file = read_blocks(settings, options);
  file.robot.surface = in_section(
      section, [&] { return file.solid ? surface_of_body(*file.solid, file.mesher) : surface_of_mesh(body.mesh()); });
  take_material(body.material(), file.robot);
  file.robot.mesh_qualities = volume_length_qualities(body.mesh().nodes_m, body.mesh().tets);
  return file;
}

bool rests_on_something(const YamlNode& settings) {
  return settings.child("body").has("fixed") || settings.has("contact");
}

// A casting may be held nowhere: all of it then, as only its shape and mesh are looked at.
SceneOptions held(const YamlNode& settings, SceneOptions options) {
  if (rests_on_something(settings)) return options;
  const Eigen::Vector3d far_m = Eigen::Vector3d::Constant(limits::kPlace_m);
  Overrides box;
  box.set({"box", "min_m"}, Eigen::Vector3d(-far_m)).set({"box", "max_m"}, far_m);
  options.overrides.set({"body", "fixed"}, std::vector<OverrideValue>{box});
  return options;
}

// Blocks of a scene that casting does not look into.
void refuse_unknown_blocks(const YamlNode& settings) {
  const std::vector<std::string> known{"actuators", "bodies",     "body",     "cables",       "casting", "chambers",
                                       "contact",   "fibres",     "fidelity", "gravity_m_s2", "include", "loads",
                                       "markers",   "parameters", "run",      "solver"};
  for (const std::string& key : settings.keys())
    if (std::find(known.begin(), known.end(), key) == known.end())
      settings.child(key).fail("is no block of a robot's file; known: " + join(known));
}

}  // namespace

CastRobotFile load_cast_robot(const std::string& path, const SceneOptions& options) {
  const YamlNode settings = with_overrides(YamlNode::load_file(path), options.overrides);
  return cast_robot_of(load_scene(path, held(settings, options)), path, options);
}

CastRobotFile load_cast_robot_in_use(const std::string& path, const SceneOptions& options) {
  const YamlNode settings = with_overrides(YamlNode::load_file(path), options.overrides);
  if (!rests_on_something(settings)) return load_cast_robot(path, options);
  const Scene scene = load_scene(path, options);
  CastRobotFile file = cast_robot_of(scene, path, options);
  file.robot.moved_bend = tightest_moved_bend(*scene.simulation, RayTree(file.robot.surface), file.robot.sheaths);
  return file;
}

CastRobotFile load_cast_surface(const std::string& path, const SceneOptions& options) {
  const YamlNode settings = with_overrides(YamlNode::load_file(path), options.overrides);
  const YamlNode section = settings.child("body");
  refuse_unknown_blocks(settings);
  if (!section.has("solid"))
    section.fail(
        "has no solid: a mesh has no surface but its elements' facets. check_casting takes one without "
        "--surface-alone; a mould needs shapes, or `solid: {step: FILE.step}` from the program that drew the body");
  CastRobotFile file = read_blocks(settings, options);
  if (settings.has("bodies") || !solids_with_material(*file.solid).empty()) refuse_several(section);
  if (section.has("material")) take_material(read_material(section.child("material")), file.robot);
  if (settings.has("casting")) settings.child("casting").require_all_read();
  file.robot.surface = in_section(section, [&] { return surface_of_body(*file.solid, file.mesher); });
  return file;
}

std::string robot_name(const std::string& path) {
  const std::filesystem::path file = std::filesystem::absolute(path);
  return file.stem() == "robot" ? file.parent_path().filename() : file.stem();
}

Surface surface_of_solid(const Solid& solid, double size_m, const MesherOptions& options) {
  SurfaceRequest request;
  request.solid = solid;
  request.largest_edge_m = size_m / kEdgesAcross;
  request.circle_segments = kRuleSegments;
  return read_off(surface_file_for(request, options));
}

std::vector<SheathPiece> pieces_on_shelves(const CastRobotFile& file) {
  if (!file.settings.sheath.shelf) return {};
  const CastShape shape(file.robot.surface);
  if (!can_lie_on_shelves(file.robot.sheaths, way_out(shape, file.settings))) return {};
  return sheath_pieces(shape.tree, file.robot.sheaths, file.settings.sheath.longest_slot_m);
}

std::string note_on_fibres(const std::vector<std::string>& fibres) {
  if (fibres.empty()) return "";
  return "fibres are inserts that no rule looks at (" + join(fibres) +
         "): wind them on a core or stretch them in the mould before it is filled, or cast in two layers";
}

MouldHeights heights_along(const Surface& surface, const Eigen::Vector3d& direction) {
  const Eigen::RowVectorXd heights = direction.transpose() * surface.vertices_m;
  return {heights.minCoeff(), heights.maxCoeff()};
}

CastingVerdict check_casting(const CastRobotFile& file) {
  const std::vector<SheathPiece> pieces = pieces_on_shelves(file);
  if (pieces.empty()) return check_casting(file.robot, file.settings);
  if (!file.solid) throw std::invalid_argument("casting.sheath.shelf: a body.mesh has no shelves");
  CastRobot robot = file.robot;
  const Eigen::Vector3d direction = way_out(CastShape(robot.surface), file.settings);
  MouldHeights heights = heights_along(robot.surface, direction);
  heights.floor_m -= kBelow_m;
  const Solid solid = less_swept_sheaths(*file.solid, pieces, direction, heights, file.settings.sheath.clearance_m);
  robot.shelved = surface_of_solid(solid, robot.surface.size_m(), file.mesher);
  return check_casting(robot, file.settings);
}

}  // namespace soft_robot_lab
