// SPDX-License-Identifier: BSD-3-Clause
// Equilibria that are none: saddles, and what is said where a body buckles.
#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "box_mesh.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

// A column of 10 x 100 x 20 mm, mirrored at x = 0 element by element, so that it stays straight to the last bits.
TetMesh mirrored_column() {
  const TetMesh half = box_mesh({0, 0, -0.01}, {0.005, 0.1, 0.01}, {1, 8, 2}, false);
  TetMesh mesh = half;
  std::map<int, int> mirrored;
  for (int node = 0; node < half.node_count(); ++node) {
    mirrored[node] = node;
    if (half.nodes_m(0, node) == 0.0) continue;
    mirrored[node] = mesh.node_count();
    mesh.nodes_m.conservativeResize(3, mesh.node_count() + 1);
    mesh.nodes_m.rightCols<1>() = half.nodes_m.col(node).cwiseProduct(Eigen::Vector3d(-1, 1, 1));
  }
  mesh.tets.conservativeResize(Eigen::NoChange, 2 * half.tet_count());
  for (int tet = 0; tet < half.tet_count(); ++tet)
    for (int i = 0; i < 4; ++i)
      mesh.tets(i < 2 ? 1 - i : i, half.tet_count() + tet) = mirrored[half.tets(i, tet)];  // turned the other way
  return make_quadratic(mesh);
}

// Euler's load is 540 Pa on the top.
Simulation column(double pressure_pa, bool held_straight,
                  SolverOptions::Method method = SolverOptions::Method::newton) {
  Body body(mirrored_column(), {264200.0, 0.45, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1, 1e-6, 1}, {true, true, true});
  if (held_straight) body.fix_nodes({-1e-9, -1, -1}, {1e-9, 1, 1}, {true, false, false});
  body.add_traction({-1, 0.099999, -1}, {1, 1, 1}, {0, -pressure_pa, 0});
  std::vector<Marker> markers;
  markers.emplace_back("top", Eigen::Vector3d(0, 0.1, 0), body.mesh(), MeshLocator(body.mesh()));
  SolverOptions options;
  options.method = method;
  return Simulation(std::move(body), {}, std::move(markers), options);
}

bool snapped(const SolveReport& report) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [](const SolveWarning& warning) { return warning.kind == "snapped"; });
}

TEST(Saddle, IsNoEquilibriumThoughNoForceIsLeft) {
  Simulation straight = column(700.0, true), free = column(700.0, false);
  ASSERT_TRUE(straight.solve_equilibrium().converged);
  free.set_state(straight.state());
  const SolveReport report = free.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_GT(std::abs(free.marker_position(0).x()), 0.01);
  EXPECT_TRUE(snapped(report));
}

TEST(Saddle, OfAColumnThatDoesNotBuckleIsNone) {
  Simulation straight = column(300.0, true), free = column(300.0, false);
  const SolveReport first = straight.solve_equilibrium();
  ASSERT_TRUE(first.converged);
  EXPECT_FALSE(snapped(first));
  free.set_state(straight.state());
  const SolveReport report = free.solve_equilibrium();
  ASSERT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_FALSE(snapped(report));
}

TEST(Saddle, IsLeftWhereALoadBucklesAColumnFromItsRestShape) {
  for (const double over_euler : {1.06, 1.3, 1.52}) {
    Simulation column = soft_robot_lab::column(540.0 * over_euler, false);
    const SolveReport report = column.solve_equilibrium();
    ASSERT_TRUE(report.converged) << over_euler << ": " << report.message;
    EXPECT_GT(std::abs(column.marker_position(0).x()), 0.02) << over_euler;
    EXPECT_TRUE(snapped(report)) << over_euler;
  }
}

// A column that is held straight stands at 1.3 times Euler's load, and so does a mirrored one without a push.
TEST(Saddle, IsLeftByXpbdToo) {
  Simulation newton = column(700.0, false), xpbd = column(700.0, false, SolverOptions::Method::xpbd);
  ASSERT_TRUE(newton.solve_equilibrium().converged);
  const SolveReport report = xpbd.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_TRUE(snapped(report));
  EXPECT_NEAR(std::abs(xpbd.marker_position(0).x()), std::abs(newton.marker_position(0).x()), 1e-4);
  EXPECT_NEAR(xpbd.marker_position(0).y(), newton.marker_position(0).y(), 1e-4);
}

TEST(Saddle, IsNoneOfAColumnThatXpbdBringsToRestBelowEulersLoad) {
  Simulation xpbd = column(300.0, false, SolverOptions::Method::xpbd);
  const SolveReport report = xpbd.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_FALSE(snapped(report));
  EXPECT_LT(std::abs(xpbd.marker_position(0).x()), 1e-6);
}

// A body that falls beside the ball that is below it.
TEST(FailedEquilibrium, LeavesTheStateToTheLastBit) {
  for (const auto method : {SolverOptions::Method::newton, SolverOptions::Method::xpbd}) {
    Body body(box_mesh({0, 0, 0}, {0.01, 0.01, 0.01}, {1, 1, 1}), {264200.0, 0.45, 1070.0});
    body.set_gravity({0, 0, -9.81});
    body.set_obstacles({{"ball", Sphere{{0.5, 0, -0.1}, 0.01}, {}, 0.0}});
    SolverOptions options;
    options.method = method;
    Simulation falling(std::move(body), {}, {}, options);
    const SimulationState before = falling.state();
    EXPECT_FALSE(falling.solve_equilibrium().converged);
    EXPECT_TRUE(falling.state() == before) << (method == SolverOptions::Method::xpbd ? "xpbd" : "newton");
  }
}

}  // namespace
}  // namespace soft_robot_lab
