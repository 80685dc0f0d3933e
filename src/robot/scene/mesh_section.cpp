// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>

#include "mechanics/mesh/cable_path.h"
#include "sections.h"
#include "settings/named_file.h"
#include "settings/read_name.h"
#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kFirstBody = "body";  // name of what stands in `body`

// A cable's end anchor sinks in over its plug's radius; elements there must be no larger to see it.
std::vector<MeshRefinement> plug_refinements(const YamlNode& scene) {
  std::vector<MeshRefinement> refinements;
  for (const YamlNode& cable : scene.optional_sequence("cables")) {
    if (!cable.has("plug_radius_m")) continue;
    const double plug_radius_m = cable.number("plug_radius_m", AllowedRange::positive());
    refinements.push_back({read_cable_path(cable).points_m.back(), 2.0 * plug_radius_m, plug_radius_m});
  }
  return refinements;
}

// The solids that some difference, here or below, takes away.
void collect_subtracted(Solid& solid, std::vector<Solid*>& subtracted) {
  for (std::size_t i = 0; i < solid.parts.size(); ++i) {
    if (solid.kind == Solid::Kind::difference && i > 0) subtracted.push_back(&solid.parts[i]);
    collect_subtracted(solid.parts[i], subtracted);
  }
}

// A chamber's `surface: {solid: ...}` repeats a solid that the body's takes away; that solid gets the chamber's name.
void name_chamber_solids(const YamlNode& scene, const std::string& body_name, Solid& body) {
  std::vector<Solid*> subtracted;
  collect_subtracted(body, subtracted);
  for (const YamlNode& chamber : scene.optional_sequence("chambers")) {
    const std::optional<YamlNode> surface = chamber.optional_child("surface");
    if (!surface || !surface->is_map() || chamber.text_or("body", kFirstBody) != body_name) continue;
    const Solid wanted = read_solid(surface->child("solid"));
    const auto found = std::find_if(subtracted.begin(), subtracted.end(),
                                    [&](const Solid* solid) { return same_solid(*solid, wanted); });
    if (found == subtracted.end())
      surface->fail("is none of the " + std::to_string(subtracted.size()) + " solids that a difference of " +
                    body_name + ".solid takes away");
    (*found)->name = chamber.text("name");
  }
}

// Of all bodies.
bool quadratic(const YamlNode& scene) {
  return scene.child("body").choice_or("element", "quadratic", {"linear", "quadratic"}) == "quadratic";
}

void refuse_chamber_solids(const YamlNode& scene, const std::string& body_name) {
  for (const YamlNode& chamber : scene.optional_sequence("chambers"))
    if (chamber.text_or("body", kFirstBody) == body_name && chamber.has("surface") && chamber.child("surface").is_map())
      chamber.child("surface").fail("must be the name of a surface in the mesh file");
}

// Either a solid to be meshed at some size, or a mesh as it is.
MeshRequest read_request(const YamlNode& scene, const std::string& body_name, const YamlNode& body) {
  MeshRequest request;
  request.quadratic = quadratic(scene);
  if (body.has("solid") == body.has("mesh")) body.fail("must have one of solid, mesh");
  if (body.has("mesh")) {
    request.mesh_file = named_file(body.child("mesh"));
    request.mesh_unit_m = read_scale(body);
    refuse_chamber_solids(scene, body_name);
    return request;
  }
  Solid solid = read_solid(body.child("solid"));
  name_chamber_solids(scene, body_name, solid);
  scale_files(body, solid);
  for (const Solid& region : solids_with_material(solid)) request.regions.push_back(region.name);
  request.solid = std::move(solid);
  request.element_size_m = body.number_or("element_size_m", request.element_size_m, AllowedRange::positive());
  if (body.boolean_or("refine_plugs", false)) request.refinements = plug_refinements(scene);
  for (const YamlNode& node : body.optional_sequence("refinements")) {
    request.refinements.push_back(read_mesh_refinement(node));
  }
  return request;
}

std::string mesh_file_of(const MeshRequest& request, const YamlNode& body, const MesherOptions& mesher) {
  return in_section(body, [&] { return mesh_file_for(request, mesher); });
}

// Where each of these is in an order by rank; equal ranks stay in theirs.
std::vector<Eigen::Index> by_rank(const std::vector<int>& ranks) {
  std::vector<Eigen::Index> order(ranks.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return ranks[static_cast<std::size_t>(a)] < ranks[static_cast<std::size_t>(b)];
  });
  return order;
}

// Numbers of bodies in the order of the places of their middles.
std::vector<int> ranks_by_place(const TetMesh& mesh, const std::vector<int>& of_nodes) {
  const auto count = static_cast<Eigen::Index>(mesh.bodies.size());
  Eigen::Matrix3Xd middles_m = Eigen::Matrix3Xd::Zero(3, count);
  Eigen::RowVectorXd nodes = Eigen::RowVectorXd::Zero(count);
  for (std::size_t node = 0; node < of_nodes.size(); ++node) {
    middles_m.col(of_nodes[node]) += mesh.nodes_m.col(static_cast<Eigen::Index>(node));
    nodes[of_nodes[node]] += 1.0;
  }
  middles_m.array().rowwise() /= nodes.array();
  std::vector<int> bodies(static_cast<std::size_t>(count)), ranks(bodies.size());
  std::iota(bodies.begin(), bodies.end(), 0);
  std::stable_sort(bodies.begin(), bodies.end(), [&](int a, int b) {
    return std::lexicographical_compare(middles_m.col(a).begin(), middles_m.col(a).end(), middles_m.col(b).begin(),
                                        middles_m.col(b).end());
  });
  for (std::size_t i = 0; i < bodies.size(); ++i) ranks[static_cast<std::size_t>(bodies[i])] = static_cast<int>(i);
  return ranks;
}

// Numbers nodes, elements and faces by where their bodies are, so that no sum depends on the order of the file.
void number_by_place(TetMesh& mesh) {
  const std::vector<int> of_nodes = bodies_of_nodes(mesh), ranks = ranks_by_place(mesh, of_nodes);
  std::vector<int> node_ranks, tet_ranks, face_ranks;
  for (const int body : of_nodes) node_ranks.push_back(ranks[static_cast<std::size_t>(body)]);
  for (int tet = 0; tet < mesh.tet_count(); ++tet)
    tet_ranks.push_back(ranks[static_cast<std::size_t>(mesh.body_of(tet))]);
  for (const int node : mesh.faces.row(0)) face_ranks.push_back(node_ranks[static_cast<std::size_t>(node)]);
  const std::vector<Eigen::Index> nodes = by_rank(node_ranks), tets = by_rank(tet_ranks), faces = by_rank(face_ranks);
  Eigen::VectorXi number_of(mesh.node_count());
  for (std::size_t i = 0; i < nodes.size(); ++i) number_of[nodes[i]] = static_cast<int>(i);
  const auto renumbered = [&](int node) { return number_of[node]; };
  mesh.nodes_m = Eigen::Matrix3Xd(mesh.nodes_m(Eigen::all, nodes));
  mesh.tets = Eigen::MatrixXi(mesh.tets(Eigen::all, tets).unaryExpr(renumbered));
  mesh.faces = Eigen::MatrixXi(mesh.faces(Eigen::all, faces).unaryExpr(renumbered));
  const std::vector<int> regions = mesh.tet_region, surfaces = mesh.face_surface;
  for (std::size_t i = 0; i < tets.size(); ++i) mesh.tet_region[i] = regions[static_cast<std::size_t>(tets[i])];
  for (std::size_t i = 0; i < faces.size(); ++i) mesh.face_surface[i] = surfaces[static_cast<std::size_t>(faces[i])];
}

}  // namespace

bool is_of_file(const YamlNode& body) { return body.has("mesh") || names_file(read_solid(body.child("solid"))); }

std::string mesh_file(const YamlNode& scene, const MesherOptions& mesher) {
  const YamlNode body = scene.child("body");
  return mesh_file_of(read_request(scene, kFirstBody, body), body, mesher);
}

TetMesh read_mesh(const YamlNode& scene, const SceneOptions& options) {
  const MesherOptions mesher = mesher_options(options);
  const auto shape_of = [&](const std::string& name, const YamlNode& body) {
    const std::string file = mesh_file_of(read_request(scene, name, body), body, mesher);
    const TetMesh shape = in_section(body, [&] { return read_msh(file); });
    return quadratic(scene) ? make_quadratic(shape) : make_linear(shape);
  };
  TetMesh mesh = shape_of(kFirstBody, scene.child("body"));
  for (const YamlNode& body : scene.optional_sequence("bodies")) {
    const std::string name = read_name(body);
    in_section(body, [&] { add_body(name, shape_of(name, body), mesh); });
  }
  if (mesh.bodies.size() > 1) number_by_place(mesh);
  if (options.change_mesh) options.change_mesh(mesh);
  return mesh;
}

std::optional<int> read_owner(const YamlNode& item, const TetMesh& mesh) {
  if (!item.has("body")) return std::nullopt;
  const std::string name = item.choice("body", mesh.bodies);
  return static_cast<int>(std::find(mesh.bodies.begin(), mesh.bodies.end(), name) - mesh.bodies.begin());
}

}  // namespace soft_robot_lab
