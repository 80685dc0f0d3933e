// SPDX-License-Identifier: BSD-3-Clause
#include "mechanics/newton/co_rotated_step.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "box_mesh.h"
#include "mechanics/elements/elements.h"
#include "mechanics/elements/node_turns.h"

namespace soft_robot_lab {
namespace {

class CoRotatedStepTest : public ::testing::TestWithParam<bool> {
 protected:
  CoRotatedStepTest()
      : body_(box_mesh({0, 0, 0}, {0.03, 0.02, 0.02}, {3, 2, 2}, GetParam()), {1.0e5, 0.45, 1000.0}),
        matrix_(body_.mesh().node_count(), stiffness_cliques(body_)),
        elements_(body_, matrix_) {}

  const Eigen::Matrix3Xd& rest() const { return body_.mesh().nodes_m; }
  Eigen::Matrix3Xd follow(const Eigen::Matrix3Xd& step) const {
    return CoRotatedStep(body_, elements_.batches(), matrix_.pattern()).follow(rest(), step);
  }
  void hold_corner(const Eigen::Matrix<bool, 3, 1>& axes) {
    body_.fix_nodes(Eigen::Vector3d::Constant(-1e-6), Eigen::Vector3d::Constant(1e-6), axes);
  }

  Body body_;
  BlockMatrix matrix_;
  Elements elements_;
};

INSTANTIATE_TEST_SUITE_P(, CoRotatedStepTest, testing::Bool(),
                         [](const auto& kind) { return kind.param ? "Quadratic" : "Linear"; });

TEST_P(CoRotatedStepTest, TurnsABodyRigidlyWhereTheStepOnlyTurns) {
  hold_corner({true, true, true});
  const Eigen::Vector3d turn(0.3, -0.9, 0.5);
  Eigen::Matrix3Xd step(3, rest().cols());
  for (Eigen::Index node = 0; node < step.cols(); ++node) step.col(node) = turn.cross(rest().col(node));
  const Eigen::Matrix3Xd turned = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * rest();
  EXPECT_LT((follow(step) - turned).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_P(CoRotatedStepTest, StretchesToTheVolumeThatTheStepMeant) {
  hold_corner({true, true, true});
  const Eigen::Vector3d strain(0.4, -0.2, -0.1);
  const TetMesh& mesh = body_.mesh();
  TetMesh stretched = mesh;
  stretched.nodes_m = follow(strain.asDiagonal() * rest());
  EXPECT_NEAR(volume(stretched), (1.0 + strain.sum()) * volume(mesh), 1e-7 * volume(mesh));
  const Eigen::Vector3d far = stretched.nodes_m.rowwise().maxCoeff();
  EXPECT_NEAR(far.x() / far.y(), 1.4 * 0.03 / (0.8 * 0.02), 1e-6);
}

TEST_P(CoRotatedStepTest, IsTheStepItselfToFirstOrder) {
  body_.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  Eigen::Matrix3Xd bend = Eigen::Matrix3Xd::Zero(3, rest().cols());
  for (Eigen::Index node = 0; node < bend.cols(); ++node) {
    const double x = rest()(0, node) / 0.03;
    bend.col(node) = 0.01 * Eigen::Vector3d(0.3 * x * rest()(2, node) / 0.02, x * x, -0.5 * x * x * x);
  }
  const auto beyond = [&](double fraction) { return (follow(fraction * bend) - rest() - fraction * bend).norm(); };
  EXPECT_GT(beyond(1.0), 1e-3 * bend.norm());
  EXPECT_NEAR(beyond(0.01) / beyond(0.005), 4.0, 0.1);
}

TEST_P(CoRotatedStepTest, MovesNothingAlongAnAxisThatIsHeld) {
  body_.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, false, false});
  hold_corner({true, true, true});
  Eigen::Matrix3Xd step = Eigen::Matrix3Xd::Zero(3, rest().cols());
  step.row(1) = 8.0 * rest().row(0).array().square() + 0.2 * rest().row(1).array() * rest().row(1).array().sign();
  const Eigen::Matrix3Xd there = follow(step);
  for (Eigen::Index node = 0; node < step.cols(); ++node)
    for (int axis = 0; axis < 3; ++axis)
      if (body_.fixed()(axis, node)) {
        EXPECT_EQ(there(axis, node), rest()(axis, node) + step(axis, node));
      }
  EXPECT_GT((there - rest() - step).row(0).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_P(CoRotatedStepTest, StaysFiniteWhereElementsAreInvertedOrFlat) {
  hold_corner({true, false, false});
  Eigen::Matrix3Xd mirrored = rest(), flat = rest();
  mirrored.row(1) *= -1.0;
  flat.row(2).setZero();
  const Eigen::Matrix3Xd step = 3.0 * rest();
  const CoRotatedStep warp(body_, elements_.batches(), matrix_.pattern());
  EXPECT_LT((warp.follow(mirrored, step) - mirrored - step).norm(), 1e-12);
  EXPECT_TRUE(warp.follow(flat, step).allFinite());
  EXPECT_TRUE(warp.follow(rest(), -5.0 * rest()).allFinite());
}

TEST_P(CoRotatedStepTest, NodeTurnsAreThoseOfTheBodyButWhereItIsHeld) {
  hold_corner({false, true, false});
  Eigen::Matrix3Xd bent = rest();
  for (Eigen::Index node = 0; node < bent.cols(); ++node) bent(1, node) += 8.0 * rest()(0, node) * rest()(0, node);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  const NodeTurns turns(body_, elements_.batches());
  const Turns found = turns.between(bent, turn * bent);
  for (Eigen::Index node = 0; node < bent.cols(); ++node) {
    const Eigen::Matrix3d expected =
        body_.fixed().col(node).any() ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : turn;
    EXPECT_LT((found.middleCols<3>(3 * node) - expected).norm(), 1e-12) << node;
  }
  EXPECT_LT((turned_back(found, turned(found, bent)) - bent).norm(), 1e-15);
}

TEST_P(CoRotatedStepTest, NodeTurnsAreRotationsWhereElementsAreStretchedOrInverted) {
  const NodeTurns turns(body_, elements_.batches());
  const Eigen::Vector3d stretch(2.0, 0.6, 0.8), mirror(1.0, -1.0, 1.0);
  for (const Eigen::Vector3d& scale : {stretch, mirror, Eigen::Vector3d(Eigen::Vector3d::Zero())}) {
    const Eigen::Matrix3Xd there = scale.asDiagonal() * rest();
    for (const Turns& found : {turns.between(rest(), there), turns.between(there, rest())})
      for (Eigen::Index node = 0; node < there.cols(); ++node)
        EXPECT_LT((found.middleCols<3>(3 * node) - Eigen::Matrix3d::Identity()).norm(), 1e-6) << node;
  }
}

}  // namespace
}  // namespace soft_robot_lab
