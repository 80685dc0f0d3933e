// SPDX-License-Identifier: BSD-3-Clause
#include "mechanics/newton/untangle.h"

#include <algorithm>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "box_mesh.h"

namespace soft_robot_lab {
namespace {

Body bar() {
  Body body(box_mesh({0, 0, 0}, {0.12, 0.02, 0.02}, {6, 2, 2}), {264200.0, 0.499, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  return body;
}

int node_at(const Body& body, const Eigen::Vector3d& position_m) {
  Eigen::Index node = 0;
  (body.mesh().nodes_m.colwise() - position_m).colwise().squaredNorm().minCoeff(&node);
  return static_cast<int>(node);
}

TEST(Unfold, LeavesASoundShapeAlone) {
  const Body body = bar();
  Eigen::Matrix3Xd positions_m = body.mesh().nodes_m;
  EXPECT_TRUE(untangle(body, 3, positions_m).nodes.empty());
  EXPECT_EQ(positions_m, body.mesh().nodes_m);
}

// The whole bar is turned and moved, and one node in it pushed through its neighbours.
TEST(Unfold, PutsBackWhatIsOutOfPlaceInATurnedBody) {
  const Body body = bar();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  const Eigen::Matrix3Xd sound_m = (turn * body.mesh().nodes_m).colwise() + Eigen::Vector3d(0.3, 0.1, 0);
  Eigen::Matrix3Xd positions_m = sound_m;
  const int node = node_at(body, {0.08, 0.01, 0.01});
  positions_m.col(node) += turn * Eigen::Vector3d(0.03, 0, 0);
  const Untangled done = untangle(body, 1, positions_m);
  EXPECT_FALSE(done.elements.empty());
  EXPECT_LT((positions_m - sound_m).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Unfold, MovesOnlyWhatIsNear) {
  const Body body = bar();
  Eigen::Matrix3Xd positions_m = body.mesh().nodes_m;
  positions_m.row(1) *= 1.1;
  const Eigen::Matrix3Xd before_m = positions_m;
  const int node = node_at(body, {0.1, 0.01, 0.01});
  positions_m.col(node).x() += 0.03;
  const Untangled done = untangle(body, 1, positions_m);
  EXPECT_FALSE(done.nodes.empty());
  EXPECT_TRUE(untangle(body, 0, positions_m).nodes.empty()) << "elements are still inverted";
  for (const int moved : done.nodes) EXPECT_GT(body.mesh().nodes_m(0, moved), 0.04);
  for (Eigen::Index i = 0; i < positions_m.cols(); ++i) {
    if (std::find(done.nodes.begin(), done.nodes.end(), i) == done.nodes.end()) {
      EXPECT_EQ(positions_m.col(i), before_m.col(i));
    }
  }
}

TEST(Unfold, GivesATangleItsRestShape) {
  const Body body = bar();
  Eigen::Matrix3Xd positions_m = Eigen::Matrix3Xd::Constant(3, body.mesh().node_count(), 0.01);
  positions_m = body.fixed().select(body.mesh().nodes_m.array(), positions_m.array());
  untangle(body, 2, positions_m);
  EXPECT_LT((positions_m - body.mesh().nodes_m).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace soft_robot_lab
