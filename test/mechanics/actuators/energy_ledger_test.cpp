// SPDX-License-Identifier: BSD-3-Clause
// The account of energy closes, whatever drives the body.
#include <cmath>

#include <gtest/gtest.h>

#include "hollow_mesh.h"
#include "soft_robot_lab/mechanics/actuators/chamber.h"
#include "test_bar.h"

namespace soft_robot_lab {
namespace {

SolverOptions options_of(Integrator integrator) {
  SolverOptions options;
  options.integrator = integrator;
  return options;
}

Simulation cantilever(Integrator integrator) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {6, 2, 2}), {264200.0, 0.49, 1070.0});
  body.fix_nodes({-10, -10, -10}, {1e-6, 10, 10}, {true, true, true});
  body.set_gravity({0, -9.81, 0});
  body.set_viscosity({0.5, 0.002, 0.0, 1.0});
  return Simulation(std::move(body), {}, {}, options_of(integrator));
}

Simulation chamber_robot(Integrator integrator) {
  Body body(hollow_cube(1.0), {264200.0, 0.49, 1070.0});
  body.fix_nodes(Eigen::Vector3d::Constant(-10), {10, 10, -0.0149}, {true, true, true});
  body.set_gravity({0, 0, -9.81});
  auto chamber = std::make_unique<Chamber>();
  chamber->initialise(YamlNode::parse("{name: air, surface: cavity}", "chamber"), body, MeshLocator(body.mesh()));
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::move(chamber));
  return Simulation(std::move(body), std::move(actuators), {}, options_of(integrator));
}

EnergyLedger run(Simulation simulation, const std::vector<std::pair<std::string, double>>& commands) {
  simulation.keep_energy_ledger();
  for (const auto& [actuator, command] : commands) simulation.set_command(actuator, command);
  for (int i = 0; i < 60; ++i) EXPECT_TRUE(simulation.step().converged) << i;
  return *simulation.energy_ledger();
}

void expect_closed(const EnergyLedger& ledger, const std::string& what) {
  EXPECT_GT(ledger.turned_over_j, 0.0) << what;
  EXPECT_LT(std::abs(ledger.closure_error_j), 0.01 * ledger.turned_over_j)
      << what << ": turned over " << ledger.turned_over_j << ", integrator " << ledger.integrator_j;
  EXPECT_GE(ledger.material_j, 0.0) << what;
  EXPECT_GE(ledger.friction_j, 0.0) << what;
}

class EnergyLedgerOf : public testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(Integrators, EnergyLedgerOf,
                         testing::Values(Integrator::implicit_euler, Integrator::bdf2, Integrator::tr_bdf2));

TEST_P(EnergyLedgerOf, AFallingCantileverCloses) {
  const EnergyLedger ledger = run(cantilever(GetParam()), {});
  expect_closed(ledger, "cantilever");
  EXPECT_LT(ledger.gravity_j, 0.0);
  EXPECT_GT(ledger.elastic_j, 0.0);
  EXPECT_GT(ledger.material_j, 0.0);
  EXPECT_EQ(ledger.actuators_j, 0.0);
}

TEST_P(EnergyLedgerOf, ARobotWithACableCloses) {
  for (const char* cable : {"model: sliding", "model: friction, friction_coefficient: 0.3"}) {
    const EnergyLedger ledger = run(hanging_bar(cable, options_of(GetParam())), {{"cable", 0.9}});
    expect_closed(ledger, cable);
    EXPECT_GT(ledger.actuators_j, 0.0);
    EXPECT_EQ(ledger.friction_j > 0.0, std::string(cable) != "model: sliding");
  }
}

TEST_P(EnergyLedgerOf, ARobotWithAChamberCloses) {
  const EnergyLedger ledger = run(chamber_robot(GetParam()), {{"air", 1.2}});
  expect_closed(ledger, "chamber");
  EXPECT_GT(ledger.gas_j, 0.0);
}

TEST(EnergyLedger, OfTrBdf2HasNextToNothingForTheIntegrator) {
  const EnergyLedger ledger = run(cantilever(Integrator::tr_bdf2), {});
  EXPECT_LT(std::abs(ledger.integrator_j), 0.15 * ledger.material_j);
  const EnergyLedger euler = run(cantilever(Integrator::implicit_euler), {});
  EXPECT_GT(euler.integrator_j, 2.0 * euler.material_j);
}

TEST(EnergyLedger, ChangesNothingElse) {
  Simulation with = hanging_bar("model: sliding"), without = hanging_bar("model: sliding");
  with.keep_energy_ledger();
  for (Simulation* simulation : {&with, &without}) {
    simulation->set_command("cable", 0.9);
    for (int i = 0; i < 10; ++i) simulation->step();
  }
  EXPECT_TRUE(with.state() == without.state());
}

}  // namespace
}  // namespace soft_robot_lab
