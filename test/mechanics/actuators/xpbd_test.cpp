// SPDX-License-Identifier: BSD-3-Clause
// The xpbd solver against the newton one, on the cantilever of reference R1 with cables.
#include "mechanics/xpbd/xpbd_solver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mechanics/box_mesh.h"
#include "mechanics/xpbd/element_colours.h"
#include "soft_robot_lab/mechanics/actuators/cable.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

struct Bar {
  double poissons_ratio = 0.499;
  Eigen::Vector3i cells = {8, 2, 2};
  bool quadratic = true;
  std::string cables = "";  // settings of two cables' common keys
};

const Eigen::Vector3i kCoarse(5, 1, 1);

SolverOptions xpbd(int substep_count) {
  SolverOptions options;
  options.method = SolverOptions::Method::xpbd;
  options.substep_count = substep_count;
  return options;
}

Body make_body(const Bar& bar, double rayleigh_mass_per_s = 0.0) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, bar.cells, bar.quadratic),
            {264200.0, bar.poissons_ratio, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  body.set_gravity({0, -9.81, 0});
  Viscosity viscosity;
  viscosity.rayleigh_mass_per_s = rayleigh_mass_per_s;
  body.set_viscosity(viscosity);
  return body;
}

Simulation make_bar(const Bar& bar, const SolverOptions& options, double rayleigh_mass_per_s = 0.0) {
  Body body = make_body(bar, rayleigh_mass_per_s);
  const MeshLocator locator(body.mesh());
  std::vector<std::unique_ptr<Actuator>> actuators;
  for (const std::string side : {"upper", "lower"}) {
    if (bar.cables.empty()) continue;
    const std::string y = side == "upper" ? "0.006" : "-0.006";
    actuators.push_back(std::make_unique<Cable>());
    actuators.back()->initialise(
        YamlNode::parse("{name: " + side + ", " + bar.cables + ", points_m: [[0, " + y + ", 0], [0.03, " + y +
                            ", 0], [0.06, " + y + ", 0], [0.095, " + y + ", 0]]}",
                        "bar"),
        body, locator);
  }
  std::vector<Marker> markers;
  markers.emplace_back("tip", Eigen::Vector3d(0.1, 0, 0), body.mesh(), locator);
  return Simulation(std::move(body), std::move(actuators), std::move(markers), options);
}

TEST(Xpbd, ComesToRestWhereTheGlobalSolverDoes) {
  const std::vector<Bar> bars = {{0.45, kCoarse, true, ""},
                                 {0.4999, kCoarse, true, ""},
                                 {0.45, Bar().cells, false, ""},
                                 {0.499, kCoarse, false, ""},   // it locks
                                 {0.499, {5, 1, 5}, true, ""},  // elements of 20 x 20 x 4 mm
                                 {0.499, kCoarse, true, "compliance_m_n: 1.0e-5"}};
  for (const Bar& bar : bars) {
    Simulation newton = make_bar(bar, {}), local = make_bar(bar, xpbd(50));
    for (Simulation* simulation : {&newton, &local})
      if (!bar.cables.empty()) simulation->set_command("upper", 0.8);
    ASSERT_TRUE(newton.solve_equilibrium().converged);
    const SolveReport report = local.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    EXPECT_LE(report.residual, local.options().tolerance);
    const Eigen::Matrix3Xd way_m = newton.state().positions_m - newton.body().mesh().nodes_m;
    EXPECT_LT((local.state().positions_m - newton.state().positions_m).colwise().norm().maxCoeff(),
              5e-4 * way_m.colwise().norm().maxCoeff());
    EXPECT_EQ(local.state().velocities_m_s.norm(), 0.0);
  }
}

TEST(Xpbd, StaysAtRestInTime) {
  Bar coarse;
  coarse.cells = kCoarse;
  Simulation bar = make_bar(coarse, xpbd(50));
  ASSERT_TRUE(bar.solve_equilibrium().converged);
  const Eigen::Vector3d tip = bar.marker_position(0);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(bar.step().converged);
  EXPECT_LT((bar.marker_position(0) - tip).norm(), 1e-6);
}

// Without the elements' forces the first step lets go of a body under tension: it creates energy in every attempt.
TEST(Xpbd, GoesOnFromAStateOfTheGlobalSolver) {
  Bar bar;
  bar.cables = "compliance_m_n: 1.0e-4";
  Simulation newton = make_bar(bar, {}), local = make_bar(bar, xpbd(100));
  newton.set_command("upper", 0.8);
  ASSERT_TRUE(newton.solve_equilibrium().converged);
  const Eigen::Vector3d tip_m = newton.marker_position(0);
  SimulationState state = local.state();
  state.positions_m = newton.state().positions_m;
  state.element_multipliers_pa = newton.state().element_multipliers_pa;
  state.constraint_multipliers = newton.state().constraint_multipliers;
  state.take_commands(newton.state());
  state.element_forces_n.resize(0);  // as the shape has them
  local.set_state(state);
  for (int i = 0; i < 5; ++i) {
    const SolveReport report = local.step();
    EXPECT_TRUE(report.converged) << report.message;
    EXPECT_EQ(report.rejected_steps, 0);
    EXPECT_LT((local.marker_position(0) - tip_m).norm(), 1e-5);
  }
}

// What xpbd keeps of its elements is no factor of newton's.
TEST(Xpbd, LeavesAStateFromWhichTheGlobalSolverGoesOn) {
  Bar bar;
  bar.cells = kCoarse;
  Simulation local = make_bar(bar, xpbd(50)), newton = make_bar(bar, {});
  ASSERT_TRUE(local.step().converged);
  SimulationState state = local.state();
  EXPECT_TRUE(state.linearisation != nullptr);
  state.element_forces_n.resize(0);
  newton.set_state(state);
  EXPECT_TRUE(newton.step().converged);
  EXPECT_TRUE(newton.state().linearisation != state.linearisation);
}

TEST(Xpbd, FallsAsTheGlobalSolverWithItsSubsteps) {
  SolverOptions fine;
  fine.time_step_s = 1.0 / 3000.0;
  Simulation newton = make_bar({}, fine), local = make_bar({}, xpbd(50));
  for (int i = 0; i < 6; ++i) {
    ASSERT_TRUE(local.step().converged);
    for (int k = 0; k < 50; ++k) ASSERT_TRUE(newton.step().converged);
    EXPECT_LT((local.marker_position(0) - newton.marker_position(0)).norm(), 3e-4) << i;
  }
  EXPECT_LT(newton.marker_position(0).y(), -0.015);
}

TEST(Xpbd, CutsStepsThatCreateEnergy) {
  Simulation bar = make_bar({}, xpbd(5));
  int rejected = 0;
  for (int i = 0; i < 12; ++i) {
    const SolveReport report = bar.step();
    EXPECT_TRUE(report.converged) << report.message;
    rejected += report.rejected_steps;
    EXPECT_LT(std::abs(bar.marker_position(0).y()), 0.04);
  }
  EXPECT_GT(rejected, 0);
}

TEST(Xpbd, CableReachesItsLengthAndNeverPushes) {
  Bar bar;
  bar.cables = "compliance_m_n: 0";
  Simulation simulation = make_bar(bar, xpbd(50));
  simulation.set_command("upper", 0.9);
  simulation.set_command("lower", 1.2);
  for (int i = 0; i < 20; ++i) {
    const SolveReport report = simulation.step();
    ASSERT_TRUE(report.converged) << report.message;
    const ActuatorReading upper = simulation.actuator_state(0), lower = simulation.actuator_state(1);
    EXPECT_NEAR(*upper.length_m, 0.9 * *upper.rest_length_m, 1e-4);
    EXPECT_GE(*upper.tension_n, 0.0);
    EXPECT_EQ(*lower.tension_n, 0.0);
  }
  EXPECT_GT(*simulation.actuator_state(0).tension_n, 1.0);
}

TEST(Xpbd, HoldsAPrescribedTension) {
  Bar bar;
  bar.cables = "command: tension_n";
  bar.cells = kCoarse;
  Simulation newton = make_bar(bar, {}), local = make_bar(bar, xpbd(50));
  for (Simulation* simulation : {&newton, &local}) {
    simulation->set_command("upper", 3.0);
    const SolveReport report = simulation->solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_EQ(*simulation->actuator_state(0).tension_n, 3.0);
  }
  EXPECT_LT((local.marker_position(0) - newton.marker_position(0)).norm(), 5e-5);
}

TEST(Xpbd, SurvivesASuddenStrongPull) {
  Bar bar;
  bar.cables = "compliance_m_n: 0";
  Simulation simulation = make_bar(bar, xpbd(20));
  simulation.set_command("upper", 0.5);
  for (int i = 0; i < 10; ++i) {
    const SolveReport report = simulation.step();
    ASSERT_TRUE(simulation.state().positions_m.allFinite()) << i;
    ASSERT_TRUE(simulation.state().element_forces_n.allFinite()) << i;
    EXPECT_TRUE(std::isfinite(report.residual));
    EXPECT_TRUE(report.converged || !report.message.empty());
  }
}

// A mirror image that its held end keeps so; no energy comes from nowhere in it.
TEST(Xpbd, TellsOfStepsThatEndWithInvertedElements) {
  Bar bar;
  bar.cells = kCoarse;
  SolverOptions options = xpbd(10);
  options.time_step_s = 1e-4;
  Simulation simulation = make_bar(bar, options);
  SimulationState state = simulation.state();
  state.positions_m.row(1) *= -1.0;
  state.element_forces_n.resize(0);
  simulation.set_state(state);
  const SolveReport report = simulation.step();
  EXPECT_GT(report.inverted_elements, 0);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.message.find("inverted elements"), report.message.find_first_of(' ') + 1) << report.message;
}

TEST(Xpbd, RepeatsToTheLastBit) {
  Bar bar;
  bar.cables = "compliance_m_n: 1.0e-5, pull_speed_m_s: 0.02";
  Simulation first = make_bar(bar, xpbd(40)), second = make_bar(bar, xpbd(40));
  SimulationState middle;
  for (int i = 0; i < 8; ++i) {
    first.set_command("upper", 0.9);
    first.step();
    if (i == 3) middle = first.state();
  }
  second.set_state(middle);
  for (int i = 4; i < 8; ++i) second.step();
  EXPECT_EQ((first.state().positions_m - second.state().positions_m).norm(), 0.0);
  EXPECT_EQ((first.state().element_forces_n - second.state().element_forces_n).norm(), 0.0);
}

XpbdState at_rest(const Body& body, const XpbdSolver& solver) {
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, body.mesh().node_count());
  return {{body.mesh().nodes_m, Eigen::VectorXd::Zero(body.mesh().tet_count()), {}},
          none,
          Eigen::VectorXd::Zero(solver.force_count())};
}

XpbdSolver solver_of(const Body& body, int threads) {
  return {std::make_shared<const XpbdTables>(body, std::vector<DrivenConstraint>{}), threads};
}

TEST(Xpbd, DoesNotDependOnTheNumberOfThreads) {
  Bar bar;
  bar.cells = {24, 6, 6};  // enough elements of a colour for two threads
  const Body body = make_body(bar);
  XpbdTask task;
  task.time_step_s = 0.002;
  task.substep_count = 4;
  std::vector<Eigen::Matrix3Xd> results;
  for (const int threads : {1, 2}) {
    XpbdSolver solver = solver_of(body, threads);
    XpbdState state = at_rest(body, solver);
    ASSERT_TRUE(solver.advance(task, state).finite);
    results.push_back(state.unknowns.positions_m);
  }
  EXPECT_GT((results[0] - body.mesh().nodes_m).norm(), 1e-5);
  EXPECT_EQ((results[0] - results[1]).norm(), 0.0);
}

TEST(Xpbd, KeepsMomentumInFreeFlight) {
  Body body(box_mesh({0, 0, 0}, {0.04, 0.02, 0.02}, {3, 2, 2}), {264200.0, 0.499, 1070.0});
  XpbdSolver solver = solver_of(body, 1);
  for (const bool from_zero : {false, true}) {
    XpbdState state = at_rest(body, solver);
    for (Eigen::Index node = 0; node < state.velocities_m_s.cols(); ++node)
      state.velocities_m_s.col(node) = Eigen::Vector3d(0.3, -0.2, 0.1) + 0.2 * Eigen::Vector3d::Random();
    const auto momentum = [&] { return Eigen::Vector3d(state.velocities_m_s * body.node_masses_kg()); };
    const Eigen::Vector3d before = momentum();
    XpbdTask task;
    task.substep_count = 100;
    task.multipliers_from_zero = from_zero;
    ASSERT_TRUE(solver.advance(task, state).finite);
    EXPECT_LT((momentum() - before).norm(), 1e-9 * before.norm());
    EXPECT_GT((state.unknowns.positions_m - body.mesh().nodes_m).norm(), 1e-3);
  }
}

TEST(Xpbd, TellsOfStepsThatCreateEnergy) {
  const Body body = make_body({});
  XpbdSolver solver = solver_of(body, 1);
  XpbdTask task;
  XpbdState fine = at_rest(body, solver), coarse = fine;
  task.substep_count = 100;
  EXPECT_TRUE(solver.advance(task, fine).stable);
  task.substep_count = 4;
  EXPECT_FALSE(solver.advance(task, coarse).stable);
}

TEST(Xpbd, LeavesTheStateWhereNothingIsFinite) {
  const Body body = make_body({});
  XpbdSolver solver = solver_of(body, 1);
  XpbdState state = at_rest(body, solver);
  state.velocities_m_s.setConstant(1e200);
  const Eigen::Matrix3Xd velocities = state.velocities_m_s;
  const XpbdReport report = solver.advance_stably({}, state);
  EXPECT_FALSE(report.finite);
  EXPECT_FALSE(report.stable);
  EXPECT_GT(report.rejected_steps, 1);
  EXPECT_EQ(state.unknowns.positions_m, body.mesh().nodes_m);
  EXPECT_EQ(state.velocities_m_s, velocities);
}

TEST(ElementColours, ShareNoNodeAndMissNoElement) {
  for (const bool quadratic : {true, false}) {
    const TetMesh mesh = box_mesh({0, 0, 0}, {0.04, 0.03, 0.02}, {4, 3, 2}, quadratic);
    std::vector<int> seen(mesh.tet_count(), 0);
    for (const std::vector<int>& colour : colour_elements(mesh)) {
      std::vector<int> used(mesh.node_count(), 0);
      for (const int element : colour) {
        ++seen[element];
        for (Eigen::Index a = 0; a < mesh.tets.rows(); ++a) EXPECT_EQ(used[mesh.tets(a, element)]++, 0);
      }
    }
    for (const int count : seen) EXPECT_EQ(count, 1);
  }
}

TEST(Xpbd, RefusesCountsOutOfRange) {
  for (const int wrong : {0, -1, 10001}) {
    SolverOptions options;
    options.substep_count = wrong;
    EXPECT_THROW(options.validate(), std::invalid_argument);
    options = {};
    options.iteration_count = wrong;
    EXPECT_THROW(options.validate(), std::invalid_argument);
  }
}

TEST(Xpbd, RefusesBdf2) {
  SolverOptions options = xpbd(20);
  EXPECT_NO_THROW(options.validate());
  options.integrator = Integrator::bdf2;
  EXPECT_THROW(options.validate(), std::invalid_argument);
  options.method = SolverOptions::Method::newton;
  EXPECT_NO_THROW(options.validate());
}

}  // namespace
}  // namespace soft_robot_lab
