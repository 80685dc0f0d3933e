// SPDX-License-Identifier: BSD-3-Clause
// An energy of an actuator's own, which a plugin hands out: the magnet of test/example_plugin.
#define EXAMPLE_PLUGIN_WITHOUT_ROS
#include "example_plugin/magnet.cpp"

#include <cmath>

#include <gtest/gtest.h>

#include "box_mesh.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

constexpr double kModulus_pa = 1e5, kLength_m = 0.1, kWidth_m = 0.01, kMoment_a_m2 = 0.05;

// A cantilever along x with a magnet along x near its end, in a field along y; some 1 mm of it in four elements.
Simulation magnet_bar(const SolverOptions& options = {}, bool threads = false, double modulus_pa = kModulus_pa,
                      const std::string& field_axis = "[0, 1, 0]") {
  Body body(box_mesh({0, -0.005, -0.005}, {kLength_m, 0.005, 0.005}, {12, 2, 2}), {modulus_pa, 0.45, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  if (threads) body.add_fibre({"thread", {{{0, 0.003, 0}, {kLength_m, 0.003, 0}}}, 5.0, true});
  const MeshLocator locator(body.mesh());
  auto magnet = std::make_unique<example_plugin::Magnet>();
  magnet->initialise(YamlNode::parse("{name: magnet, south_m: [0.08, 0, 0], north_m: [0.1, 0, 0], moment_a_m2: 0.05, "
                                     "field_axis: " +
                                         field_axis + ", max_field_t: 0.1}",
                                     "magnet"),
                     body, locator);
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::move(magnet));
  std::vector<Marker> markers{Marker("tip", {kLength_m, 0, 0}, body.mesh(), locator)};
  return Simulation(std::move(body), std::move(actuators), std::move(markers), options);
}

TEST(EnergyTerm, AMagnetBendsABarByItsMoment) {
  Simulation simulation = magnet_bar();
  constexpr double kField_t = 1e-4;
  simulation.set_command("magnet", kField_t);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  // The moment acts half at either pole's side: evenly over the magnet's length.
  const double bending = kModulus_pa * std::pow(kWidth_m, 4) / 12.0, moment = kMoment_a_m2 * kField_t;
  const double tip_m = moment / bending * (0.08 * 0.08 / 2 + 0.08 * 0.02 + 0.02 * 0.02 / 3);
  EXPECT_NEAR(simulation.marker_position(0).y() / tip_m, 1.0, 0.02);
}

TEST(EnergyTerm, ItsSensitivityIsThatOfDifferences) {
  for (const bool threads : {false, true}) {
    Simulation simulation = magnet_bar({}, threads);
    const auto tip_m = [&](double field_t) {
      simulation.set_command("magnet", field_t);
      EquilibriumOptions exact;
      EXPECT_TRUE(simulation.solve_equilibrium(exact).converged);
      return simulation.marker_position(0);
    };
    constexpr double kField_t = 0.02, kStep_t = 2e-5;
    const Eigen::Vector3d by_difference = (tip_m(kField_t + kStep_t) - tip_m(kField_t - kStep_t)) / (2 * kStep_t);
    tip_m(kField_t);
    const Eigen::Vector3d exact = simulation.marker_sensitivities().col(0);
    EXPECT_LT((exact - by_difference).norm(), 0.002 * exact.norm()) << threads;
    EXPECT_GT(exact.norm(), 0.1);
  }
}

// A field along the bar leaves it straight and makes it stiffer.
TEST(EnergyTerm, AnotherCommandAtTheSameShapeHasAnotherStiffness) {
  Simulation without = magnet_bar({}, false, kModulus_pa, "[1, 0, 0]"),
             with = magnet_bar({}, false, kModulus_pa, "[1, 0, 0]");
  ASSERT_TRUE(without.solve_equilibrium().converged);
  const Eigen::MatrixXd soft = without.marker_compliances();
  without.set_command("magnet", 0.02);
  ASSERT_TRUE(without.solve_equilibrium().converged);
  with.set_command("magnet", 0.02);
  ASSERT_TRUE(with.solve_equilibrium().converged);
  const Eigen::MatrixXd stiff = with.marker_compliances();
  EXPECT_LT(stiff.col(1).norm(), 0.9 * soft.col(1).norm());
  EXPECT_NEAR(without.marker_compliances().col(1).norm(), stiff.col(1).norm(), 1e-9 * stiff.col(1).norm());
}

TEST(EnergyTerm, TheAccountOfEnergyCloses) {
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2, Integrator::tr_bdf2})
    for (const bool threads : {false, true}) {
      SolverOptions options;
      options.integrator = integrator;
      Simulation simulation = magnet_bar(options, threads);
      simulation.keep_energy_ledger();
      simulation.set_command("magnet", 0.01);
      for (int i = 0; i < 40; ++i) ASSERT_TRUE(simulation.step().converged) << i;
      const EnergyLedger ledger = *simulation.energy_ledger();
      EXPECT_GT(ledger.actuators_j, 0.0);
      EXPECT_GT(ledger.elastic_j, 0.0);
      EXPECT_LT(std::abs(ledger.closure_error_j), 0.01 * ledger.turned_over_j);
    }
}

TEST(EnergyTerm, IsRefusedByXpbd) {
  SolverOptions options;
  options.method = SolverOptions::Method::xpbd;
  EXPECT_THROW(magnet_bar(options), std::invalid_argument);
}

TEST(EnergyTerm, AModulusLeavesMagnetAndThreadsAlone) {
  Simulation simulation = magnet_bar({}, true);
  simulation.set_command("magnet", 0.01);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  Eigen::MatrixXd slipped_m;
  const Eigen::VectorXd exact = simulation.parameter_sensitivities({{"youngs_modulus_pa", {}}}, slipped_m).col(0);
  const auto tip_m = [](double modulus_pa) {
    Simulation other = magnet_bar({}, true, modulus_pa);
    other.set_command("magnet", 0.01);
    EXPECT_TRUE(other.solve_equilibrium().converged);
    return other.marker_position(0);
  };
  const double step_pa = 1e-3 * kModulus_pa;
  const Eigen::Vector3d by_difference = (tip_m(kModulus_pa + step_pa) - tip_m(kModulus_pa - step_pa)) / (2.0 * step_pa);
  EXPECT_LT((exact - by_difference).norm(), 0.01 * exact.norm());
}

}  // namespace
}  // namespace soft_robot_lab
