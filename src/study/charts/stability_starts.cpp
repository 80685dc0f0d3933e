// SPDX-License-Identifier: BSD-3-Clause
#include "stability_starts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace soft_robot_lab {
namespace {

struct Box {
  Eigen::Vector3d min_m, max_m;
  std::array<int, 3> axes;  // from the shortest edge to the longest

  explicit Box(const Body& body)
      : min_m(body.mesh().nodes_m.rowwise().minCoeff()), max_m(body.mesh().nodes_m.rowwise().maxCoeff()) {
    const Eigen::Vector3d edges = max_m - min_m;
    std::iota(axes.begin(), axes.end(), 0);
    std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return edges[a] < edges[b]; });
  }
  Eigen::Vector3d middle_m() const { return 0.5 * (min_m + max_m); }
};

// Numbers in [0, 1) that are the same with every standard library (Vigna 2015, splitmix64).
class Uniform {
 public:
  double next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
  }

 private:
  std::uint64_t state_ = 1;
};

void keep_held(const Body& body, const Eigen::Matrix3Xd& before, Eigen::Matrix3Xd& positions_m) {
  positions_m = body.fixed().array().select(before.array(), positions_m.array()).matrix();
}

// Scales the first `count` of the box's axes, from the shortest, about its middle.
void scale_axes(const Body& body, int count, double scale, Eigen::Matrix3Xd& positions_m) {
  const Box box(body);
  const Eigen::Matrix3Xd before = positions_m;
  for (int i = 0; i < count; ++i) {
    const int axis = box.axes[static_cast<std::size_t>(i)];
    const double middle = box.middle_m()[axis];
    positions_m.row(axis) = (middle + scale * (positions_m.row(axis).array() - middle)).matrix();
  }
  keep_held(body, before, positions_m);
}

}  // namespace

void add_slivers(TetMesh& mesh, double height, int every) {
  const bool quadratic = mesh.quadratic();
  TetMesh split = make_linear(mesh);
  const int elements = split.tet_count(), added = (elements + every - 1) / every;
  int node = split.node_count(), element = elements;
  split.nodes_m.conservativeResize(3, node + added);
  split.tets.conservativeResize(4, elements + 3 * added);
  for (int e = 0; e < elements; e += every, ++node) {
    const Eigen::Vector4i corners = split.tets.col(e);
    const Eigen::Vector4d weights(height, (1.0 - height) / 3.0, (1.0 - height) / 3.0, (1.0 - height) / 3.0);
    split.nodes_m.col(node).setZero();
    for (int i = 0; i < 4; ++i) split.nodes_m.col(node) += weights[i] * split.nodes_m.col(corners[i]);
    for (int i = 0; i < 4; ++i) {
      Eigen::Vector4i part = corners;
      part[i] = node;
      split.tets.col(i == 0 ? e : element++) = part;
    }
  }
  mesh = quadratic ? make_quadratic(split) : split;
}

void scramble(const Body& body, Eigen::Matrix3Xd& positions_m) {
  const Box box(body);
  const Eigen::Matrix3Xd before = positions_m;
  Uniform random;
  for (Eigen::Index node = 0; node < positions_m.cols(); ++node)
    for (int axis = 0; axis < 3; ++axis)
      positions_m(axis, node) = box.min_m[axis] + random.next() * (box.max_m[axis] - box.min_m[axis]);
  keep_held(body, before, positions_m);
}

void collapse_to_plane(const Body& body, Eigen::Matrix3Xd& positions_m) { scale_axes(body, 1, 0.0, positions_m); }
void collapse_to_line(const Body& body, Eigen::Matrix3Xd& positions_m) { scale_axes(body, 2, 0.0, positions_m); }
void collapse_to_point(const Body& body, Eigen::Matrix3Xd& positions_m) { scale_axes(body, 3, 0.0, positions_m); }
void collapse_spans(const Body& body, Eigen::Matrix3Xd& positions_m) {
  const Box box(body);
  const int axis = box.axes[2];
  const double slice = 0.2 * (box.max_m - box.min_m)[axis];
  const Eigen::Matrix3Xd before = positions_m;
  for (double& place : positions_m.row(axis)) {
    const double count = std::min(4.0, std::floor((place - box.min_m[axis]) / slice));
    place = box.min_m[axis] + (count + 0.5) * slice;
  }
  keep_held(body, before, positions_m);
}

void mirror(const Body& body, Eigen::Matrix3Xd& positions_m) { scale_axes(body, 1, -1.0, positions_m); }

}  // namespace soft_robot_lab
