// SPDX-License-Identifier: BSD-3-Clause
#include "gmsh_model.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <map>
#include <stdexcept>
#include <unordered_map>

#include <gmsh.h>

namespace soft_robot_lab {
namespace {

using Tags = std::vector<std::size_t>;

std::string name_of_type(int type) {
  static const std::map<int, const char*> names = {{2, "triangles"},
                                                   {3, "quadrilaterals"},
                                                   {5, "hexahedra"},
                                                   {6, "wedges"},
                                                   {7, "pyramids"},
                                                   {9, "triangles of 6 nodes"},
                                                   {12, "hexahedra of 27 nodes"},
                                                   {17, "hexahedra of 20 nodes"}};
  const auto found = names.find(type);
  return found == names.end() ? "elements of type " + std::to_string(type) : found->second;
}

struct Elements {
  int nodes_each = 0;
  Tags nodes;
};

// The elements of a dimension in an entity (-1: in all), of one type that is among those allowed.
Elements elements_of(int dimension, int entity, const std::map<int, int>& nodes_of_type) {
  std::vector<int> types;
  std::vector<Tags> tags, nodes;
  gmsh::model::mesh::getElements(types, tags, nodes, dimension, entity);
  Elements all;
  for (size_t i = 0; i < types.size(); ++i) {
    const auto type = nodes_of_type.find(types[i]);
    if (type == nodes_of_type.end()) {
      throw std::invalid_argument("the mesh holds " + name_of_type(types[i]) +
                                  "; only tetrahedra of 4 or 10 nodes can be used; mesh the body anew with these");
    }
    if (all.nodes_each != 0 && all.nodes_each != type->second) {
      throw std::invalid_argument("the mesh mixes elements of " + std::to_string(all.nodes_each) + " and " +
                                  std::to_string(type->second) + " nodes");
    }
    all.nodes_each = type->second;
    all.nodes.insert(all.nodes.end(), nodes[i].begin(), nodes[i].end());
  }
  return all;
}

// Removes the noise of converting units: multiples of 1e-15 m where doubles are finer than that.
double snap_m(double value_m) { return std::abs(value_m) < 1 ? std::round(value_m * 1e15) / 1e15 : value_m; }

// Node tags that the elements use, in rising order, to indices.
std::map<std::size_t, int> number_nodes(const Tags& used) {
  std::map<std::size_t, int> index;
  for (const std::size_t tag : used) index[tag] = 0;
  int next = 0;
  for (auto& entry : index) entry.second = next++;
  return index;
}

Eigen::Matrix3Xd node_positions(const std::map<std::size_t, int>& index, double unit_m) {
  Tags tags;
  std::vector<double> coordinates, unused;
  gmsh::model::mesh::getNodes(tags, coordinates, unused);
  Eigen::Matrix3Xd nodes_m = Eigen::Matrix3Xd::Constant(3, static_cast<Eigen::Index>(index.size()), std::nan(""));
  for (size_t i = 0; i < tags.size(); ++i) {
    const auto found = index.find(tags[i]);
    if (found == index.end()) continue;
    for (size_t axis = 0; axis < 3; ++axis) {
      const double value = coordinates[3 * i + axis];
      nodes_m(static_cast<Eigen::Index>(axis), found->second) = unit_m == 1.0 ? value : snap_m(value * unit_m);
    }
  }
  return nodes_m;
}

Eigen::MatrixXi cells(const Elements& elements, const std::map<std::size_t, int>& index) {
  const auto count = static_cast<Eigen::Index>(elements.nodes.size()) / elements.nodes_each;
  Eigen::MatrixXi result(elements.nodes_each, count);
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    const auto found = index.find(elements.nodes[static_cast<size_t>(i)]);
    if (found == index.end()) throw std::invalid_argument("a triangle of a named surface is no side of an element");
    result(i) = found->second;
  }
  return result;
}

constexpr int kAllEntities = -1;

// Of all volumes, region by region.
Elements tetrahedra(const std::vector<NamedEntities>& volumes, TetMesh& mesh) {
  const std::map<int, int> types{{4, 4}, {11, 10}};
  if (!volumes.empty()) mesh.regions.clear();
  if (volumes.size() == 1) mesh.regions.push_back({volumes[0].name});
  if (volumes.size() < 2) return elements_of(3, kAllEntities, types);
  Elements all;
  for (const NamedEntities& volume : volumes) {
    for (const int entity : volume.entities) {
      const Elements part = elements_of(3, entity, types);
      if (part.nodes.empty()) continue;
      if (all.nodes_each != 0 && all.nodes_each != part.nodes_each)
        throw std::invalid_argument("elements of region '" + volume.name + "' are of another order than others");
      all.nodes_each = part.nodes_each;
      all.nodes.insert(all.nodes.end(), part.nodes.begin(), part.nodes.end());
      mesh.tet_region.resize(all.nodes.size() / static_cast<size_t>(all.nodes_each),
                             static_cast<int>(mesh.regions.size()));
    }
    mesh.regions.push_back({volume.name});
  }
  return all;
}

}  // namespace

GmshSession::GmshSession() {
  gmsh::initialize(0, nullptr, false);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);  // Gmsh goes on in spite of them
  gmsh::option::setNumber("General.Terminal", 0);
  gmsh::option::setNumber("General.NumThreads", 1);
  gmsh::option::setNumber("General.AbortOnError", 2);  // throw
}

GmshSession::~GmshSession() { gmsh::finalize(); }

TetMesh extract_mesh(const std::vector<NamedEntities>& surfaces, const std::vector<NamedEntities>& volumes,
                     double unit_m) {
  TetMesh mesh;
  const Elements tets = tetrahedra(volumes, mesh);
  if (tets.nodes.empty()) throw std::invalid_argument("the mesh holds no tetrahedra");
  const std::map<std::size_t, int> index = number_nodes(tets.nodes);
  mesh.nodes_m = node_positions(index, unit_m);
  mesh.tets = cells(tets, index);
  mesh.faces.resize(mesh.quadratic() ? 6 : 3, 0);
  for (const NamedEntities& surface : surfaces) {
    for (const int entity : surface.entities) {
      const Elements triangles = elements_of(2, entity, {{2, 3}, {9, 6}});
      if (triangles.nodes.empty()) continue;
      if (triangles.nodes_each != mesh.faces.rows()) {
        throw std::invalid_argument("triangles of surface '" + surface.name + "' do not fit the elements");
      }
      const Eigen::MatrixXi faces = cells(triangles, index);
      mesh.faces.conservativeResize(Eigen::NoChange, mesh.faces.cols() + faces.cols());
      mesh.faces.rightCols(faces.cols()) = faces;
      mesh.face_surface.resize(static_cast<size_t>(mesh.faces.cols()), static_cast<int>(mesh.surface_names.size()));
    }
    mesh.surface_names.push_back(surface.name);
  }
  return mesh;
}

}  // namespace soft_robot_lab
