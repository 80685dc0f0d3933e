// SPDX-License-Identifier: BSD-3-Clause
#include "surface_edge.h"

#include <map>
#include <stdexcept>
#include <utility>

#include "settings/point_text.h"

namespace soft_robot_lab {
namespace {

[[noreturn]] void refuse(const TetMesh& mesh, int node, const std::string& why) {
  const Eigen::Vector3d at = mesh.nodes_m.col(node);
  throw std::invalid_argument("the surface cannot be capped: " + why + " at " + point_text(at));
}

// Edges that are not met by as many faces turning the other way.
std::vector<EdgeOfFace> open_edges(const TetMesh& mesh, const std::vector<int>& faces) {
  struct Meeting {
    int turns = 0;  // faces that run from the lower to the higher corner, less those that run back
    EdgeOfFace edge;
  };
  std::map<std::pair<int, int>, Meeting> meetings;
  for (const int face : faces) {
    for (int i = 0; i < 3; ++i) {
      const int from = mesh.faces(i, face), to = mesh.faces((i + 1) % 3, face);
      Meeting& meeting = meetings[std::minmax(from, to)];
      meeting.turns += from < to ? 1 : -1;
      meeting.edge = {std::min(from, to), std::max(from, to), mesh.faces.rows() == 6 ? mesh.faces(3 + i, face) : -1};
    }
  }
  std::vector<EdgeOfFace> open;
  for (auto& [corners, meeting] : meetings) {
    if (meeting.turns == 0) continue;
    if (std::abs(meeting.turns) > 1) refuse(mesh, corners.first, "faces turn against each other");
    if (meeting.turns < 0) std::swap(meeting.edge.from, meeting.edge.to);
    open.push_back(meeting.edge);
  }
  return open;
}

}  // namespace

std::vector<std::vector<EdgeOfFace>> edge_loops(const TetMesh& mesh, const std::vector<int>& faces) {
  std::map<int, EdgeOfFace> next;  // by the corner an edge starts from
  for (const EdgeOfFace& edge : open_edges(mesh, faces))
    if (!next.emplace(edge.from, edge).second) refuse(mesh, edge.from, "two loops of its edge touch");
  std::vector<std::vector<EdgeOfFace>> loops;
  while (!next.empty()) {
    loops.emplace_back();
    for (auto at = next.begin(); at != next.end(); at = next.find(loops.back().back().to)) {
      loops.back().push_back(at->second);
      next.erase(at);
    }
  }
  return loops;
}

}  // namespace soft_robot_lab
