// SPDX-License-Identifier: BSD-3-Clause
// What is reported of a solve that ended badly.
#include "mechanics/simulation/solve_ending.h"

#include <gtest/gtest.h>

#include "box_mesh.h"

namespace soft_robot_lab {
namespace {

TEST(SolveEnding, TellsWhereTheResidualAndTheInvertedElementsAre) {
  const Body body(box_mesh({0, 0, 0}, {0.02, 0.01, 0.01}, {2, 1, 1}), Material{});
  NewtonReport newton;
  newton.reason = "iteration limit";
  newton.residual = 0.5;
  newton.tolerance = 1e-3;
  newton.worst_node = 3;
  newton.inverted_elements = 2;
  newton.worst_element = 11;  // of the second cell
  newton.smallest_determinant = -0.25;
  SolveReport report;
  report_end(newton, body, report);
  EXPECT_FALSE(report.converged);
  ASSERT_EQ(report.warnings.size(), 2u);
  EXPECT_EQ(report.warnings[0].kind, "residual_not_met");
  EXPECT_EQ(report.warnings[0].size, 0.5);
  EXPECT_EQ(*report.warnings[0].rest_position_m, Eigen::Vector3d(body.mesh().nodes_m.col(3)));
  EXPECT_EQ(report.warnings[1].kind, "inverted_elements");
  EXPECT_EQ(report.warnings[1].size, -0.25);
  EXPECT_GT(report.warnings[1].rest_position_m->x(), 0.01);
  EXPECT_EQ(report.message.find("iteration limit; 2 inverted elements, the worst element 11 at"), 0u) << report.message;

  newton.converged = true;
  newton.inverted_elements = 0;
  newton.reason.clear();
  report_end(newton, body, report);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(report.message, "");
}

}  // namespace
}  // namespace soft_robot_lab
