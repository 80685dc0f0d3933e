// SPDX-License-Identifier: BSD-3-Clause
// A hand that pulls at a body, and where it takes hold of the skin.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "box_mesh.h"
#include "mechanics/mesh/skin.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

// Along x from 0 to 100 mm, 10 x 10 mm, held at x = 0.
Body held_bar() {
  Body body(box_mesh({0, -0.005, -0.005}, {0.1, 0.005, 0.005}, {10, 1, 1}), {264200.0, 0.4, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, Eigen::Matrix<bool, 3, 1>::Constant(true));
  return body;
}

EmbeddedPoint end_of(const Body& body) { return MeshLocator(body.mesh()).embed(Eigen::Vector3d(0.1, 0, 0)); }

Simulation simulation_of(Body body, SolverOptions::Method method = SolverOptions::Method::newton) {
  SolverOptions options;
  options.method = method;
  return Simulation(std::move(body), {}, {}, options);
}

const Eigen::Vector3d kForce_n(0.0, 0.004, -0.002);

TEST(Pull, ActsAsTheSameDeadLoadAndIsGoneAfterwards) {
  Body loaded = held_bar();
  loaded.add_force(end_of(loaded), kForce_n);
  Simulation expected = simulation_of(std::move(loaded));
  Simulation pulled = simulation_of(held_bar());
  pulled.pull({{end_of(pulled.body()), kForce_n}});
  ASSERT_TRUE(expected.solve_equilibrium().converged);
  ASSERT_TRUE(pulled.solve_equilibrium().converged);
  EXPECT_EQ(pulled.state().positions_m, expected.state().positions_m);
  const Eigen::Matrix3Xd& rest_m = pulled.body().mesh().nodes_m;
  EXPECT_GT((pulled.state().positions_m - rest_m).norm(), 1e-3);
  pulled.pull({});
  ASSERT_TRUE(pulled.solve_equilibrium().converged);
  EXPECT_LT((pulled.state().positions_m - rest_m).colwise().norm().maxCoeff(), 1e-7);
}

TEST(Pull, WakesABodyThatSleeps) {
  for (const SolverOptions::Method method : {SolverOptions::Method::newton, SolverOptions::Method::xpbd}) {
    Simulation simulation = simulation_of(held_bar(), method);
    for (int i = 0; i < 3; ++i) simulation.step();
    const Eigen::Matrix3Xd still_m = simulation.state().positions_m;
    simulation.pull({{end_of(simulation.body()), kForce_n}});
    for (int i = 0; i < 10; ++i) simulation.step();
    const Eigen::Vector3d moved_m = end_of(simulation.body()).at(simulation.state().positions_m - still_m);
    EXPECT_GT(moved_m.dot(kForce_n.normalized()), 1e-4);
  }
}

TEST(Pull, ReplacesThePullBefore) {
  Simulation twice = simulation_of(held_bar()), once = simulation_of(held_bar());
  twice.pull({{end_of(twice.body()), 5.0 * kForce_n}});
  for (Simulation* each : {&twice, &once}) {
    each->pull({{end_of(each->body()), kForce_n}});
    ASSERT_TRUE(each->solve_equilibrium().converged);
  }
  EXPECT_EQ(twice.state().positions_m, once.state().positions_m);
}

TEST(Pull, RefusesWhatIsNotFiniteOrNotAccountedFor) {
  Simulation simulation = simulation_of(held_bar());
  const EmbeddedPoint end = end_of(simulation.body());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(simulation.pull({{end, Eigen::Vector3d(nan, 0, 0)}}), std::invalid_argument);
  simulation.keep_energy_ledger();
  EXPECT_THROW(simulation.pull({{end, kForce_n}}), std::invalid_argument);
}

TEST(Pull, TakesHoldOfThePlaceThatIsThereNow) {
  const Body body = held_bar();
  // Turned by a quarter about z, and moved.
  Eigen::Matrix3Xd positions_m = body.mesh().nodes_m;
  positions_m.row(0) = -body.mesh().nodes_m.row(1).array() + 0.3;
  positions_m.row(1) = body.mesh().nodes_m.row(0);
  const GripPlace place = grip_on_skin(body.mesh(), positions_m, Eigen::Vector3d(0.297, 0.043, 0.007));
  EXPECT_NEAR(place.distance_m, 0.002, 1e-12);
  EXPECT_LT((place.rest_m - Eigen::Vector3d(0.043, 0.003, 0.005)).norm(), 1e-12) << place.rest_m.transpose();
  EXPECT_LT((place.rest_normal - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

}  // namespace
}  // namespace soft_robot_lab
