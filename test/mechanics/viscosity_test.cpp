// SPDX-License-Identifier: BSD-3-Clause
// Damping and hysteresis of the silicone: how motion dies away, and what must not change.
#include "soft_robot_lab/mechanics/viscosity.h"

#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/Geometry>

#include "box_mesh.h"
#include "mechanics/simulation/modal.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

const Viscosity kAll{1.0, 0.002, 0.3, 0.02};

Body cantilever(const Viscosity& viscosity) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {5, 1, 1}), {264200.0, 0.499, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  body.set_viscosity(viscosity);
  return body;
}

Simulation released(const Viscosity& viscosity, SolverOptions options) {
  Body body = cantilever(viscosity);
  body.set_gravity({0, -9.81, 0});
  return Simulation(std::move(body), {}, {}, options);
}

SolverOptions stepping(Integrator integrator, double time_step_s) {
  SolverOptions options;
  options.integrator = integrator;
  options.time_step_s = time_step_s;
  options.dynamic_tolerance = 1e-7;
  return options;
}

// The rate at which the first mode's amplitude decays, over the mode's angular frequency.
double decay_over_frequency(const Viscosity& damping_over_frequency, SolverOptions options) {
  const ModalResult modes = modal_analysis(cantilever({}), 1);
  const double omega = 2.0 * M_PI * modes.frequencies_hz[0];
  Viscosity viscosity;
  viscosity.rayleigh_mass_per_s = damping_over_frequency.rayleigh_mass_per_s * omega;
  viscosity.rayleigh_stiffness_s = damping_over_frequency.rayleigh_stiffness_s / omega;
  options.time_step_s = 2.0 * M_PI / omega / 100.0;
  Simulation simulation(cantilever(viscosity), {}, {}, options);
  const Body& body = simulation.body();
  const Eigen::Map<const Eigen::Matrix3Xd> shape(modes.shapes.data(), 3, body.mesh().node_count());
  const auto amplitude = [&] {
    const auto along = [&](const Eigen::Matrix3Xd& vectors) {
      return shape.cwiseProduct(vectors * body.node_masses_kg().asDiagonal()).sum();
    };
    return std::hypot(along(simulation.state().positions_m - body.mesh().nodes_m),
                      along(simulation.state().velocities_m_s) / omega);
  };
  SimulationState state = simulation.state();
  state.positions_m += 1e-4 / shape.cwiseAbs().maxCoeff() * shape;
  simulation.set_state(state);
  const double start = amplitude();
  for (int i = 0; i < 300; ++i) EXPECT_TRUE(simulation.step().converged);
  return std::log(start / amplitude()) / simulation.state().time_s / omega;
}

TEST(Viscosity, DampsTheFirstModeAsRayleighsFormulaSays) {
  const SolverOptions options = stepping(Integrator::bdf2, 1.0);
  EXPECT_LT(std::abs(decay_over_frequency({}, options)), 3e-4);  // the integrator's own
  EXPECT_NEAR(decay_over_frequency({0.1, 0.0}, options), 0.05, 0.001);
  EXPECT_NEAR(decay_over_frequency({0.0, 0.1}, options), 0.05, 0.001);
  EXPECT_NEAR(decay_over_frequency({0.06, 0.04}, options), 0.05, 0.001);
}

// A rod whose sides are free to move in and out, or held: along it most of the second mode's stiffness is bulk.
Body rod(double poissons_ratio, bool confined) {
  Body body(box_mesh({0, 0, 0}, {0.1, 0.01, 0.01}, {6, 1, 1}), {264200.0, poissons_ratio, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, false, false});
  const double far_m = confined ? 1.0 : 1e-6;
  body.fix_nodes({-1, -1, -1}, {1, far_m, 1}, {false, true, false});
  body.fix_nodes({-1, -1, -1}, {1, 1, far_m}, {false, false, true});
  return body;
}

// Over what b omega^2 / 2 says.
double bulk_decay(double poissons_ratio, bool confined, SolverOptions options) {
  const ModalResult modes = modal_analysis(rod(poissons_ratio, confined), 1);
  const double omega = 2.0 * M_PI * modes.frequencies_hz[0];
  options.time_step_s = 2.0 * M_PI / omega / 100.0;
  const auto decay = [&](double over_omega) {
    Body body = rod(poissons_ratio, confined);
    body.set_viscosity({0.0, over_omega / omega, 0.0, 1.0});
    Simulation simulation(std::move(body), {}, {}, options);
    simulation.keep_energy_ledger();
    const Eigen::Matrix3Xd& rest_m = simulation.body().mesh().nodes_m;
    const Eigen::Map<const Eigen::Matrix3Xd> shape(modes.shapes.data(), 3, rest_m.cols());
    const auto along = [&](const Eigen::Matrix3Xd& vectors) {
      return shape.cwiseProduct(vectors * simulation.body().node_masses_kg().asDiagonal()).sum();
    };
    SimulationState state = simulation.state();
    state.positions_m += 1e-4 / shape.cwiseAbs().maxCoeff() * shape;
    simulation.set_state(state);
    const double start = along(state.positions_m - rest_m);
    for (int i = 0; i < 200; ++i) EXPECT_TRUE(simulation.step().converged);
    const double end =
        std::hypot(along(simulation.state().positions_m - rest_m), along(simulation.state().velocities_m_s) / omega);
    if (options.method == SolverOptions::Method::newton && over_omega > 0.0) {
      const EnergyLedger& ledger = *simulation.energy_ledger();
      EXPECT_NEAR(ledger.closure_error_j, 0.0, 1e-3 * ledger.turned_over_j) << poissons_ratio;
      EXPECT_GT(ledger.material_j, 0.0);
    }
    return std::log(start / end) / simulation.state().time_s;
  };
  return (decay(0.1) - decay(0.0)) / (0.05 * omega);
}

TEST(Viscosity, OfTheVolumeIsThatOfTheFormulaAtEveryPoissonsRatio) {
  for (const Integrator integrator : {Integrator::bdf2, Integrator::tr_bdf2})
    for (const bool confined : {false, true})
      for (const double ratio : {0.3, 0.45, 0.4999})
        EXPECT_NEAR(bulk_decay(ratio, confined, stepping(integrator, 1.0)), 1.0, 0.02) << ratio << confined;
}

TEST(Viscosity, DampsAlikeWithXpbd) {
  SolverOptions options;
  options.method = SolverOptions::Method::xpbd;
  options.substep_count = 20;
  const double own = decay_over_frequency({}, options);
  EXPECT_NEAR(decay_over_frequency({0.1, 0.0}, options) - own, 0.05, 0.003);
  EXPECT_NEAR(decay_over_frequency({0.0, 0.1}, options) - own, 0.05, 0.003);
}

TEST(Viscosity, OfXpbdIsThatOfTheGlobalSolverWithItsSubsteps) {
  SolverOptions fine, local;
  fine.time_step_s = 1.0 / 3000.0;
  local.method = SolverOptions::Method::xpbd;
  local.substep_count = 50;
  for (const Viscosity& viscosity : {Viscosity{0.0, 0.01, 0.0, 1.0}, Viscosity{0.0, 0.0, 1.0, 0.05}, kAll}) {
    Simulation newton = released(viscosity, fine), swept = released(viscosity, local), none = released({}, fine);
    for (int i = 0; i < 6; ++i) {
      ASSERT_TRUE(swept.step().converged);
      for (int k = 0; k < 50; ++k) ASSERT_TRUE(newton.step().converged && none.step().converged);
    }
    const auto apart_m = [&](const Simulation& other) {
      return (newton.state().positions_m - other.state().positions_m).colwise().norm().maxCoeff();
    };
    EXPECT_GT(apart_m(none), 2e-3);
    EXPECT_LT(apart_m(swept), 0.1 * apart_m(none));
    const Eigen::VectorXd &stress = newton.state().branch_stress_pa, &other = swept.state().branch_stress_pa;
    ASSERT_EQ(stress.size(), other.size());
    EXPECT_LE((stress - other).norm(), 0.1 * stress.norm());
  }
}

// A cube on a slippery floor, spun about the vertical.
TEST(Viscosity, OfStrainLeavesASpinningBodyItsEnergy) {
  std::vector<double> energies;
  for (const Viscosity& viscosity : {Viscosity{}, Viscosity{0.0, 0.05, 1.0, 0.1}}) {
    Body body(box_mesh({-0.01, -0.01, 0}, {0.01, 0.01, 0.01}, {2, 2, 1}), {264200.0, 0.45, 1070.0});
    body.fix_nodes({-1, -1, -1}, {1, 1, 1e-9}, {false, false, true});
    body.set_viscosity(viscosity);
    Simulation simulation(std::move(body), {}, {}, stepping(Integrator::bdf2, 0.005));
    SimulationState state = simulation.state();
    for (Eigen::Index node = 0; node < state.positions_m.cols(); ++node)
      state.velocities_m_s.col(node) = Eigen::Vector3d(0, 0, 10.0).cross(state.positions_m.col(node));
    simulation.set_state(state);
    const auto energy = [&] {
      return simulation.state().velocities_m_s.colwise().squaredNorm().dot(simulation.body().node_masses_kg());
    };
    const double start = energy();
    for (int i = 0; i < 130; ++i) ASSERT_TRUE(simulation.step().converged);  // a full turn
    energies.push_back(energy() / start);
  }
  EXPECT_GT(energies[0], 0.99);  // the integrator's own
  EXPECT_NEAR(energies[1], energies[0], 1e-3);
}

TEST(Viscosity, ConvergesWithTheTimeStepInTheOrderOfTheIntegrator) {
  const auto tip_m = [](Integrator integrator, int steps) {
    Simulation simulation = released(kAll, stepping(integrator, 0.08 / steps));
    for (int i = 0; i < steps; ++i) EXPECT_TRUE(simulation.step().converged);
    return simulation.state().positions_m.row(1).minCoeff();
  };
  for (const bool second : {false, true}) {
    const Integrator integrator = second ? Integrator::bdf2 : Integrator::implicit_euler;
    const double coarse = tip_m(integrator, 20), middle = tip_m(integrator, 40), fine = tip_m(integrator, 80);
    const double order = std::log2(std::abs((coarse - middle) / (middle - fine)));
    EXPECT_NEAR(order, second ? 2.0 : 1.0, 0.35);
  }
}

// Sought from the midst of its motion, when velocities and the branch's stress would lead elsewhere if they counted.
TEST(Viscosity, LeavesTheEquilibriumAloneThatIsSoughtWhileItMoves) {
  Simulation plain = released({}, {}), moving = released(kAll, {});
  ASSERT_TRUE(plain.solve_equilibrium().converged);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(moving.step().converged);
  EXPECT_GT(moving.state().branch_stress_pa.cwiseAbs().maxCoeff(), 100.0);
  const auto apart_m = [&] {
    return (plain.state().positions_m - moving.state().positions_m).colwise().norm().maxCoeff();
  };
  EXPECT_GT(apart_m(), 1e-3);
  ASSERT_TRUE(moving.solve_equilibrium().converged);
  EXPECT_LT(apart_m(), 1e-7);
  EXPECT_EQ(moving.state().branch_stress_pa.norm(), 0.0);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(moving.step().converged);
  EXPECT_LT(apart_m(), 1e-6);  // and rests there
}

TEST(Viscosity, ComesToRestAtTheEquilibrium) {
  Simulation plain = released({}, {}), viscous = released(kAll, {});
  ASSERT_TRUE(plain.solve_equilibrium().converged);
  for (int i = 0; i < 65; ++i) ASSERT_TRUE(viscous.step().converged);
  EXPECT_LT((plain.state().positions_m - viscous.state().positions_m).colwise().norm().maxCoeff(), 2e-5);
}

TEST(Viscosity, GoesOnFromASavedStateToTheLastBit) {
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
    SolverOptions options;
    options.integrator = integrator;
    Simulation first = released(kAll, options), second = released(kAll, options);
    SimulationState middle;
    for (int i = 0; i < 8; ++i) {
      ASSERT_TRUE(first.step().converged);
      if (i == 3) middle = first.state();
    }
    second.set_state(middle);
    for (int i = 4; i < 8; ++i) ASSERT_TRUE(second.step().converged);
    EXPECT_EQ((first.state().positions_m - second.state().positions_m).norm(), 0.0);
    EXPECT_EQ((first.state().branch_stress_pa - second.state().branch_stress_pa).norm(), 0.0);
  }
}

TEST(Viscosity, RefusesAStateWithoutItsHysteresis) {
  Simulation plain = released({}, {}), viscous = released(kAll, {});
  EXPECT_THROW(viscous.set_state(plain.state()), std::invalid_argument);
}

TEST(Viscosity, RefusesWhatIsOutOfRange) {
  const std::pair<Viscosity, const char*> cases[] = {
      {{-1.0, 0, 0, 1}, "damping.rayleigh_mass_per_s: -1 is out of range [0"},
      {{0, -1.0, 0, 1}, "damping.rayleigh_stiffness_s: -1 is out of range [0"},
      {{0, std::nan(""), 0, 1}, "damping.rayleigh_stiffness_s: nan"},
      {{0, 0, -0.1, 1}, "hysteresis.stiffness_ratio: -0.1 is out of range [0"},
      {{0, 0, 0.1, 0}, "hysteresis.relaxation_time_s: 0 is out of range (0"}};
  for (const auto& [viscosity, words] : cases) {
    try {
      cantilever(viscosity);
      ADD_FAILURE() << words;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
