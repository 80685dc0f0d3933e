// SPDX-License-Identifier: BSD-3-Clause
// Held regions that move, forces at points and edges, and weights that hang, against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "box_mesh.h"
#include "mechanics/simulation/modal.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

constexpr double kFar = 10.0, kThin = 1e-6;
const Eigen::Matrix<bool, 3, 1> kAll = Eigen::Matrix<bool, 3, 1>::Constant(true);

// Along x from 0 to 100 mm, 10 x 10 mm.
Body bar(const Material& material) {
  return Body(box_mesh({0, -0.005, -0.005}, {0.1, 0.005, 0.005}, {10, 1, 1}), material);
}

Body clamped_bar(const Material& material) {
  Body body = bar(material);
  body.fix_nodes({-kFar, -kFar, -kFar}, {kThin, kFar, kFar}, kAll);
  return body;
}

Simulation solver_of(Body body, SolverOptions options = {}) {
  const MeshLocator locator(body.mesh());
  std::vector<Marker> markers;
  markers.emplace_back("tip", Eigen::Vector3d(0.1, 0, 0), body.mesh(), locator);
  return Simulation(std::move(body), {}, std::move(markers), options);
}

SolverOptions exact() {
  SolverOptions options;
  options.tolerance = 1e-8;
  return options;
}

Eigen::Vector3d reaction_n(const Simulation& simulation, std::size_t hold) {
  const Eigen::Matrix3Xd forces_n = simulation.reaction_forces_n();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int node : simulation.body().holds().at(hold).nodes) sum += forces_n.col(node);
  return sum;
}

EmbeddedPoint corner(const Body& body) { return MeshLocator(body.mesh()).embed(Eigen::Vector3d(0.1, 0.005, 0.005)); }

TEST(Holds, StretchOfABarTakesItsModulusTimesAreaTimesStrain) {
  Body body = clamped_bar({264200.0, 0.0, 1070.0});
  const double strain = 1e-4;
  body.fix_nodes({0.1 - kThin, -kFar, -kFar}, {kFar, kFar, kFar}, kAll, {{0.0}, {1.0, {0.1 * strain, 0, 0}}}, "grip");
  Simulation simulation = solver_of(std::move(body), exact());
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  EXPECT_NEAR(simulation.marker_position(0).x(), 0.1 * (1.0 + strain), 1e-12);
  const double force_n = 264200.0 * 1e-4 * strain;
  EXPECT_NEAR(reaction_n(simulation, 1).x(), force_n, 1e-3 * force_n);
  EXPECT_NEAR(reaction_n(simulation, 0).x(), -force_n, 1e-3 * force_n);
}

TEST(Holds, ThatTurnTogetherLeaveABodyWithoutForce) {
  Body body = bar({264200.0, 0.49, 1070.0});
  const Eigen::Vector3d turn(0, 0, 0.5 * M_PI);
  body.fix_nodes({-kFar, -kFar, -kFar}, {kThin, kFar, kFar}, kAll, {{0.0}, {1.0, {0, 0, 0}, turn}}, "base");
  body.fix_nodes({0.1 - kThin, -kFar, -kFar}, {kFar, kFar, kFar}, kAll, {{0.0}, {1.0, {-0.1, 0.1, 0}, turn}}, "grip");
  Simulation simulation = solver_of(std::move(body));
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_LT((simulation.marker_position(0) - Eigen::Vector3d(0, 0.1, 0)).norm(), 1e-7);
  EXPECT_LT(reaction_n(simulation, 0).norm(), 1e-8);
}

// A stiff bar follows its base, so that its base carries mass times acceleration.
TEST(Holds, BaseThatSwingsCarriesMassTimesAcceleration) {
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
    const double h = 0.001, acceleration_m_s2 = 3.0, mass_kg = 1e-5 * 1070.0;
    Body body = bar({1e7, 0.3, 1070.0});
    body.set_viscosity({0.0, 0.002, 0.0, 1.0});
    std::vector<ObstaclePose> motion;
    for (int i = 0; i <= 200; ++i)
      motion.push_back({i * h, {0.5 * acceleration_m_s2 * std::pow(i * h, 2), 0, 0}, {0, 0, 0}});
    body.fix_nodes({-kFar, -kFar, -kFar}, {kThin, kFar, kFar}, kAll, motion, "base");
    SolverOptions options;
    options.time_step_s = h;
    options.integrator = integrator;
    options.dynamic_tolerance = 1e-7;
    Simulation simulation = solver_of(std::move(body), options);
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(simulation.step().converged);
    EXPECT_NEAR(reaction_n(simulation, 0).x(), mass_kg * acceleration_m_s2, 0.01 * mass_kg * acceleration_m_s2);
    const SimulationState saved = simulation.state();
    simulation.reset();
    simulation.set_state(saved);
    EXPECT_TRUE(simulation.state() == saved);
  }
}

TEST(Holds, WakeASleepingBodyWhereTheyMove) {
  Body body = bar({264200.0, 0.3, 1070.0});
  body.fix_nodes({-kFar, -kFar, -kFar}, {kThin, kFar, kFar}, kAll, {{0.0}, {1.0}, {2.0, {0.01, 0, 0}}}, "base");
  Simulation simulation = solver_of(std::move(body));
  for (int i = 0; i < 50; ++i) simulation.step();
  EXPECT_TRUE(simulation.state().rest_residual.has_value());
  for (int i = 0; i < 80; ++i) simulation.step();
  EXPECT_GT(simulation.marker_position(0).x(), 0.1 + 0.009);
}

// A grip that is lifted and turned: where the bar rests, and that its work is known, so that no step counts as one that
// creates energy.
TEST(Holds, ThatMoveTakeABarAlongWithXpbd) {
  const auto gripped = [](const SolverOptions& options) {
    Body body = clamped_bar({264200.0, 0.49, 1070.0});
    body.fix_nodes({0.1 - kThin, -kFar, -kFar}, {kFar, kFar, kFar}, kAll,
                   {{0.0}, {0.2, {-0.005, 0.02, 0}, {0, 0, 0.5}}}, "grip");
    return solver_of(std::move(body), options);
  };
  SolverOptions local;
  local.method = SolverOptions::Method::xpbd;
  local.substep_count = 80;
  local.tolerance = 1e-4;
  Simulation newton = gripped({}), rested = gripped(local), moved = gripped(local);
  ASSERT_TRUE(newton.solve_equilibrium().converged);
  const SolveReport report = rested.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  const auto apart_m = [&](const Simulation& other) {
    return (other.state().positions_m - newton.state().positions_m).colwise().norm().maxCoeff();
  };
  EXPECT_LT(apart_m(rested), 0.01 * 0.02);
  for (int i = 0; i < 12; ++i) {
    const SolveReport step = moved.step();
    EXPECT_TRUE(step.converged) << step.message;
    EXPECT_EQ(step.rejected_steps, 0) << i;
  }
  EXPECT_LT(apart_m(moved), 0.005);  // it swings about the rest shape
}

TEST(Holds, RefuseMotionsThatCannotBe) {
  Body body = bar({264200.0, 0.3, 1070.0});
  const Eigen::Vector3d min(-kFar, -kFar, -kFar), max(kThin, kFar, kFar);
  EXPECT_THROW(body.fix_nodes(min, max, kAll, {{0.0, {0.01, 0, 0}}}, ""), std::invalid_argument);
  EXPECT_THROW(body.fix_nodes(min, max, kAll, {{1.0}, {0.5}}, ""), std::invalid_argument);
  EXPECT_THROW(body.fix_nodes(min, max, {true, false, false}, {{0.0}, {1.0, {0, 0, 0}, {0, 0, 1}}}, ""),
               std::invalid_argument);
  body.fix_nodes(min, max, kAll);
  EXPECT_THROW(body.fix_nodes(min, max, kAll, {{0.0}, {1.0, {0.01, 0, 0}}}, ""), std::invalid_argument);
}

// Timoshenko's beam: P L^3 / 3 E I + P L / k G A with k = 5/6.
TEST(Loads, ForceOnTheEndsEdgeBendsACantileverAsABeam) {
  const double e = 264200.0, nu = 0.0, force_n = 1e-4, inertia_m4 = std::pow(0.01, 4) / 12.0;
  Body body = clamped_bar({e, nu, 1070.0});
  body.add_force({0.1 - kThin, 0.005 - kThin, -kFar}, {kFar, kFar, kFar}, {0, force_n, 0});
  Simulation simulation = solver_of(std::move(body), exact());
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const double sag_m = force_n * 1e-3 / (3.0 * e * inertia_m4) + force_n * 0.1 / (5.0 / 6.0 * 0.5 * e * 1e-4);
  EXPECT_NEAR(simulation.marker_position(0).y(), sag_m, 0.02 * sag_m);
  EXPECT_NEAR(reaction_n(simulation, 0).y(), -force_n, 1e-6 * force_n);
}

TEST(Loads, HungWeightPullsAsItsWeightDoes) {
  const Material material{264200.0, 0.49, 1070.0};
  Body pulled = clamped_bar(material), hung = clamped_bar(material);
  for (Body* body : {&pulled, &hung}) body->set_gravity({0, -9.81, 0});
  pulled.add_force(corner(pulled), {0, -0.002 * 9.81, 0});
  hung.hang(corner(hung), 0.002);
  Simulation one = solver_of(std::move(pulled), exact()), other = solver_of(std::move(hung), exact());
  ASSERT_TRUE(one.solve_equilibrium().converged);
  ASSERT_TRUE(other.solve_equilibrium().converged);
  EXPECT_LT((one.marker_position(0) - other.marker_position(0)).norm(), 1e-9);
  EXPECT_NEAR(reaction_n(other, 0).y(), (0.002 + 1e-5 * 1070.0) * 9.81, 1e-6);
}

// On a bar of next to no mass a weight swings with the frequency sqrt(k / m).
TEST(Loads, HungWeightHasInertia) {
  const Material light{264200.0, 0.3, 0.01};
  const double mass_kg = 0.005, force_n = 1e-5;
  Body pushed = clamped_bar(light);
  pushed.add_force(corner(pushed), {0, force_n, 0});
  std::vector<Marker> markers;
  const MeshLocator locator(pushed.mesh());
  markers.emplace_back("corner", Eigen::Vector3d(0.1, 0.005, 0.005), pushed.mesh(), locator);
  Simulation simulation(std::move(pushed), {}, std::move(markers), exact());
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const double stiffness_n_m = force_n / (simulation.marker_position(0).y() - 0.005);
  Body hung = clamped_bar(light);
  hung.hang(corner(hung), mass_kg);
  // The corner bends and twists the bar: by symmetry its two lowest modes are along the diagonals.
  const double lowest_hz = modal_analysis(hung, 1).frequencies_hz[0];
  EXPECT_NEAR(lowest_hz, std::sqrt(stiffness_n_m / mass_kg) / (2.0 * M_PI), 0.15 * lowest_hz);
}

TEST(Loads, WeightWithoutMassIsRefused) {
  Body body = clamped_bar({264200.0, 0.3, 1070.0});
  EXPECT_THROW(body.hang(corner(body), 0.0), std::invalid_argument);
  EXPECT_THROW(body.hang(corner(body), -1.0), std::invalid_argument);
}

TEST(Equilibrium, SaysWhichMotionNothingResists) {
  Body body = bar({264200.0, 0.3, 1070.0});
  body.fix_nodes({-kFar, -kFar, -kFar}, {kThin, kFar, kFar}, {true, false, false});
  body.set_gravity({0, -9.81, 0});
  Simulation simulation = solver_of(std::move(body));
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_FALSE(report.converged);
  EXPECT_NE(report.message.find("nothing keeps the body from moving along y, z and turning about x"), std::string::npos)
      << report.message;
}

TEST(Equilibrium, OfABodyThatIsHeldWarnsOfNoFreeMotion) {
  Simulation simulation = solver_of(clamped_bar({264200.0, 0.3, 1070.0}));
  EXPECT_TRUE(simulation.solve_equilibrium().warnings.empty());
}

}  // namespace
}  // namespace soft_robot_lab
