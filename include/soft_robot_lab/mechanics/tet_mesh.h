// SPDX-License-Identifier: BSD-3-Clause
// A tetrahedral mesh of the rest shape, with named boundary surfaces and regions. Lengths in metres, frame: robot_base.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// Elements that may have a material of their own.
struct MeshRegion {
  std::string name;  // may be empty
  int body = 0;      // index into TetMesh::bodies
};

// One body, or several that share no node.
// Node order of a 10-node tetrahedron (Gmsh's): corners 0..3, then mid-edges 01, 12, 02, 03, 23, 13.
//
//        3
//       /|\         corner order: volume is positive when
//      0-+-2        0, 1, 2 turn counter-clockwise seen from 3
//       \|/
//        1
struct TetMesh {
  Eigen::Matrix3Xd nodes_m;                // 3 x nodes, rest positions
  Eigen::MatrixXi tets;                    // 4 or 10 x tets, node indices
  Eigen::MatrixXi faces;                   // 3 or 6 x boundary triangles, outward: corners, then mid-edges 01, 12, 20
  std::vector<int> face_surface;           // per face: index into surface_names, or -1
  std::vector<std::string> surface_names;  // named surfaces, e.g. "cavity"
  std::vector<int> tet_region;             // per element: index into regions; empty: all in the first
  std::vector<MeshRegion> regions = {{}};  // at least one
  std::vector<std::string> bodies = {"body"};  // names, at least one

  int node_count() const { return static_cast<int>(nodes_m.cols()); }
  int tet_count() const { return static_cast<int>(tets.cols()); }
  bool quadratic() const { return tets.rows() == 10; }
  int region_of(int tet) const { return tet_region.empty() ? 0 : tet_region[static_cast<std::size_t>(tet)]; }
  int body_of(int tet) const { return regions[static_cast<std::size_t>(region_of(tet))].body; }
};

// Adds mid-edge nodes (on straight edges) to a 4-node mesh; returns a 10-node mesh unchanged.
TetMesh make_quadratic(const TetMesh& mesh);

// Drops the mid-edge nodes of a 10-node mesh; returns a 4-node mesh unchanged.
TetMesh make_linear(const TetMesh& mesh);

// Fills `faces` with every outer triangle that is not listed yet (face_surface -1), so that they cover the boundary.
void complete_boundary(TetMesh& mesh);

// Throws std::invalid_argument with the place: no element, index out of range, an unused node, an element whose
// Jacobian is not positive everywhere (inverted or degenerate), parts of one body that do not hang together, bodies
// that do.
void check_mesh(const TetMesh& mesh);

// Elements whose Jacobian is not positive at one of the places that check_mesh looks at: inverted, flat or folded.
std::vector<int> folded_elements(const TetMesh& mesh);

// Signed volume inside the elements [m^3].
double volume(const TetMesh& mesh);

// Per node: its body, an index into mesh.bodies.
std::vector<int> bodies_of_nodes(const TetMesh& mesh);

// Adds the other mesh as a further body, which it must be by itself. Its surfaces become NAME/SURFACE. Throws
// std::invalid_argument for elements of another order and a name that is taken.
void add_body(const std::string& name, const TetMesh& body, TetMesh& mesh);

// Reads Gmsh's MSH 2.2 text format: 4- or 10-node tetrahedra; physical surfaces and volumes become named surfaces and
// regions.
// Other formats and versions go through `mesh_robot`, which rewrites them as this one.
// Throws std::invalid_argument naming file and line.
TetMesh read_msh(const std::string& path);

}  // namespace soft_robot_lab
