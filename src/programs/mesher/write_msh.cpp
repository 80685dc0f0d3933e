// SPDX-License-Identifier: BSD-3-Clause
#include "write_msh.h"

#include <charconv>
#include <sstream>
#include <utility>
#include <vector>

#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

constexpr int kBodyTag = 1;
int surface_tag(int surface) { return surface + 2; }

// Elements of a region without a name, where others have one, belong to no group.
int region_tag(const TetMesh& mesh, int region) {
  if (mesh.regions.size() > 1 && mesh.regions[static_cast<size_t>(region)].name.empty()) return 0;
  return region == 0 ? kBodyTag : surface_tag(static_cast<int>(mesh.surface_names.size())) + region - 1;
}

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

void write_names(const TetMesh& mesh, std::ostream& out) {
  std::vector<std::pair<int, std::string>> regions;
  for (size_t i = 0; i < mesh.regions.size(); ++i)
    if (const int tag = region_tag(mesh, static_cast<int>(i)); tag != 0)
      regions.emplace_back(tag, mesh.regions[i].name);
  out << "$PhysicalNames\n" << mesh.surface_names.size() + regions.size() << "\n";
  for (size_t i = 0; i < mesh.surface_names.size(); ++i) {
    out << "2 " << surface_tag(static_cast<int>(i)) << " \"" << mesh.surface_names[i] << "\"\n";
  }
  for (const auto& [tag, name] : regions) out << "3 " << tag << " \"" << (name.empty() ? "body" : name) << "\"\n";
  out << "$EndPhysicalNames\n";
}

void write_nodes(const TetMesh& mesh, std::ostream& out) {
  out << "$Nodes\n" << mesh.node_count() << "\n";
  for (int node = 0; node < mesh.node_count(); ++node) {
    out << node + 1;
    for (const double coordinate : mesh.nodes_m.col(node)) out << ' ' << shortest(coordinate);
    out << "\n";
  }
  out << "$EndNodes\n";
}

void write_elements(const TetMesh& mesh, std::ostream& out) {
  const bool quadratic = mesh.quadratic();
  out << "$Elements\n" << mesh.faces.cols() + mesh.tets.cols() << "\n";
  long number = 0;
  const auto write = [&](int type, int tag, const auto& nodes) {
    out << ++number << ' ' << type << " 2 " << tag << ' ' << tag;
    for (const int node : nodes) out << ' ' << node + 1;
    out << "\n";
  };
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    write(quadratic ? 9 : 2, surface_tag(mesh.face_surface[static_cast<size_t>(face)]), mesh.faces.col(face));
  }
  for (int tet = 0; tet < mesh.tet_count(); ++tet)
    write(quadratic ? 11 : 4, region_tag(mesh, mesh.region_of(tet)), mesh.tets.col(tet));
  out << "$EndElements\n";
}

}  // namespace

void write_msh(const TetMesh& mesh, const std::string& path) {
  std::ostringstream out;
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  write_names(mesh, out);
  write_nodes(mesh, out);
  write_elements(mesh, out);
  write_file(path, out.str());
}

}  // namespace soft_robot_lab
