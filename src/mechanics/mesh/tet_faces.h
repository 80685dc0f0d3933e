// SPDX-License-Identifier: BSD-3-Clause
// The triangles of a tetrahedral mesh: which elements meet in each, and which of them bound the body.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// Local nodes of the four sides, turning counter-clockwise seen from outside: corners, then mid-edges 01, 12, 20.
constexpr int kTetSides[4][6] = {{0, 2, 1, 6, 5, 4}, {0, 1, 3, 4, 9, 7}, {1, 2, 3, 5, 8, 9}, {0, 3, 2, 7, 8, 6}};

using FaceKey = std::array<int, 3>;  // corner nodes in rising order

inline FaceKey face_key(int a, int b, int c) {
  FaceKey key{a, b, c};
  std::sort(key.begin(), key.end());
  return key;
}

struct TetSide {
  FaceKey key;
  int tet;
  int side;

  // Outward triangle of 3 or 6 nodes.
  Eigen::VectorXi nodes(const TetMesh& mesh) const {
    Eigen::VectorXi face(mesh.quadratic() ? 6 : 3);
    for (Eigen::Index i = 0; i < face.size(); ++i) face[i] = mesh.tets(kTetSides[side][i], tet);
    return face;
  }
};

// Every side of every element, sorted so that the sides that meet lie together.
class TetSides {
 public:
  explicit TetSides(const TetMesh& mesh) {
    sides_.reserve(static_cast<size_t>(mesh.tet_count()) * 4);
    for (int tet = 0; tet < mesh.tet_count(); ++tet) {
      for (int side = 0; side < 4; ++side) {
        const auto corner = [&](int i) { return mesh.tets(kTetSides[side][i], tet); };
        sides_.push_back({face_key(corner(0), corner(1), corner(2)), tet, side});
      }
    }
    std::sort(sides_.begin(), sides_.end(), [](const TetSide& a, const TetSide& b) {
      return a.key != b.key ? a.key < b.key : a.tet != b.tet ? a.tet < b.tet : a.side < b.side;
    });
  }

  // The sides with these corners: none, one on the boundary, two inside the body.
  std::vector<TetSide> meeting(const FaceKey& key) const {
    const auto before = [](const TetSide& side, const FaceKey& wanted) { return side.key < wanted; };
    auto at = std::lower_bound(sides_.begin(), sides_.end(), key, before);
    std::vector<TetSide> found;
    for (; at != sides_.end() && at->key == key; ++at) found.push_back(*at);
    return found;
  }

  // Calls visit(first, count) for each group of sides that meet.
  template <typename Visit>
  void for_each_group(const Visit& visit) const {
    for (size_t first = 0; first < sides_.size();) {
      size_t end = first + 1;
      while (end < sides_.size() && sides_[end].key == sides_[first].key) ++end;
      visit(&sides_[first], static_cast<int>(end - first));
      first = end;
    }
  }

 private:
  std::vector<TetSide> sides_;
};

}  // namespace soft_robot_lab
