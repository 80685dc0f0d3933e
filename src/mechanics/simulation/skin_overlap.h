// SPDX-License-Identifier: BSD-3-Clause
// Skin that has come into other silicone: where no contact is modelled, or in spite of it.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "mechanics/contact/skin_pairs.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

class SkinOverlap {
 public:
  explicit SkinOverlap(const Body& body);

  // A warning `skin_in_silicone` where nodes of the skin are inside elements that share no node with theirs, of a body
  // with which contact is not modelled, and deeper below its skin than a twentieth of an element's edge. Its size is
  // the largest such depth [m]. `present`: the body's mesh with its nodes where they are now.
  std::optional<SolveWarning> deepest(const Body& body, const TetMesh& present) const;

  // The same of a body with which contact is modelled, deeper than a quarter of an edge: no such state is a solution.
  std::optional<SolveWarning> deepest_in_spite_of_contact(const Body& body, const TetMesh& present) const;

 private:
  enum class Contact { none, modelled };
  struct Inside {
    int node, tet;
  };
  std::optional<SolveWarning> deepest_with(Contact contact, const Body& body, const TetMesh& present) const;
  std::vector<Inside> nodes_inside(Contact contact, const Body& body, const TetMesh& present) const;
  bool may_touch(const Body& body, const Inside& inside) const;
  bool neighbours(const TetMesh& mesh, const Inside& inside) const;
  double depth_m(const TetMesh& present, const Eigen::Matrix3Xd& face_normals, int node) const;

  TouchingPairs touching_;
  std::vector<int> skin_nodes_;
  std::vector<std::vector<int>> tets_of_node_, faces_of_node_;
  bool all_touch_;
};

}  // namespace soft_robot_lab
