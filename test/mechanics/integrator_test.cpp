// SPDX-License-Identifier: BSD-3-Clause
// Accuracy in time, on the bar of reference R1 clamped at x = 0.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "reference_table.h"
#include "box_mesh.h"
#include "mechanics/simulation/modal.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

Simulation cantilever(const Eigen::Vector3i& cells, const Eigen::Vector3d& gravity_m_s2, const SolverOptions& options) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, cells), {264200.0, 0.49, 1070.0});
  body.fix_nodes(Eigen::Vector3d::Constant(-1.0), {1e-6, 1, 1}, {true, true, true});
  body.set_gravity(gravity_m_s2);
  std::vector<Marker> markers;
  markers.emplace_back("tip", Eigen::Vector3d(0.1, 0, 0), body.mesh(), MeshLocator(body.mesh()));
  return Simulation(std::move(body), {}, std::move(markers), options);
}

// Relative error after a quarter period of a small swing in the first mode, x = rest + amplitude shape sin(omega t),
// made in pairs of steps of which the second is `ratio` times as long as the first.
double swing_error(Integrator integrator, int pairs, double ratio = 1.0) {
  SolverOptions options;
  options.integrator = integrator;
  options.dynamic_tolerance = 1e-6;  // only the error in time is to be seen
  const Body body = cantilever({4, 1, 1}, Eigen::Vector3d::Zero(), options).body();
  const ModalResult modes = modal_analysis(body, 1);
  const double omega = 2.0 * M_PI * modes.frequencies_hz[0];
  options.time_step_s = 0.25 / modes.frequencies_hz[0] / pairs / (1.0 + ratio);
  Simulation first = cantilever({4, 1, 1}, Eigen::Vector3d::Zero(), options);
  options.time_step_s *= ratio;
  Simulation second = cantilever({4, 1, 1}, Eigen::Vector3d::Zero(), options);
  const Eigen::Matrix3Xd peak =
      1e-6 * Eigen::Map<const Eigen::Matrix3Xd>(modes.shapes.data(), 3, body.mesh().node_count());
  SimulationState state = first.state();
  state.velocities_m_s = omega * peak;
  for (int i = 0; i < pairs; ++i) {
    for (Simulation* simulation : {&first, &second}) {
      simulation->set_state(state);
      EXPECT_TRUE(simulation->step().converged);
      state = simulation->state();
    }
  }
  // Where the swing turns an error of its phase shows in the velocity alone.
  const double off = (state.positions_m - body.mesh().nodes_m - peak).norm() / peak.norm();
  return integrator == Integrator::tr_bdf2 ? std::hypot(off, state.velocities_m_s.norm() / omega / peak.norm()) : off;
}

TEST(Integrator, ImplicitEulerIsOfFirstOrder) {
  const double coarse = swing_error(Integrator::implicit_euler, 20), fine = swing_error(Integrator::implicit_euler, 40);
  EXPECT_NEAR(std::log2(coarse / fine), 1.0, 0.1) << coarse << " " << fine;
}

TEST(Integrator, Bdf2IsOfSecondOrderAlsoWhereStepsChange) {
  for (const double ratio : {1.0, 0.5, 2.0}) {
    const double coarse = swing_error(Integrator::bdf2, 20, ratio), fine = swing_error(Integrator::bdf2, 40, ratio);
    EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.2) << ratio << ": " << coarse << " " << fine;
    EXPECT_LT(fine, 2e-3);
  }
}

// Beyond 1 + sqrt(2) BDF2 would be unstable.
TEST(Integrator, Bdf2GivesWayToImplicitEulerWhereAStepGrowsTooFast) {
  SolverOptions options;
  options.integrator = Integrator::bdf2;
  options.time_step_s = 0.001;
  Simulation before = cantilever({4, 1, 1}, {0, -9.81, 0}, options);
  before.step();
  for (const double growth : {1.9, 2.1}) {
    const auto stepped = [&](Integrator integrator) {
      options.integrator = integrator;
      options.time_step_s = growth * 0.001;
      Simulation after = cantilever({4, 1, 1}, {0, -9.81, 0}, options);
      after.set_state(before.state());
      after.step();
      return after.state().positions_m;
    };
    EXPECT_EQ(stepped(Integrator::bdf2) == stepped(Integrator::implicit_euler), growth > 2.0) << growth;
  }
}

TEST(Integrator, Bdf2SwingsAsTheReferenceAfterARelease) {
  SolverOptions options;
  options.integrator = Integrator::bdf2;
  options.time_step_s = 0.002;
  Simulation simulation = cantilever({15, 3, 3}, {0, -9.81, 0}, options);
  const std::vector<ReferenceRow> reference = read_reference("r6_release");
  std::vector<double> sag{0.0}, expected{0.0};
  for (int i = 1; i <= 105; ++i) {
    ASSERT_TRUE(simulation.step().converged);
    ASSERT_NEAR(simulation.state().time_s, reference[i].number("t_s"), 1e-9);
    sag.push_back(simulation.marker_position(0).y());
    expected.push_back(reference[i].number("tip_uy_m"));
    EXPECT_NEAR(sag[i], expected[i], 0.03 * 0.0289) << "at " << simulation.state().time_s << " s";
  }
  // First minimum, and the return to the top a period after the start.
  const auto index_of_lowest = [](const std::vector<double>& y) {
    return std::min_element(y.begin(), y.end()) - y.begin();
  };
  const auto index_of_return = [](const std::vector<double>& y) {
    return std::max_element(y.begin() + 60, y.end()) - y.begin();
  };
  const auto lowest = index_of_lowest(sag);
  EXPECT_NEAR(sag[lowest], expected[index_of_lowest(expected)], 0.02 * 0.0289);
  EXPECT_NEAR(0.002 * lowest, 0.101, 0.02 * 0.101 + 0.001);
  EXPECT_NEAR(0.002 * index_of_return(sag), 0.197, 0.02 * 0.197);
  EXPECT_NEAR(sag[index_of_return(sag)], 0.0, 0.02 * 0.0289);
}

TEST(Integrator, TrBdf2IsOfSecondOrderAndFarCloserThanBdf2) {
  const double coarse = swing_error(Integrator::tr_bdf2, 4), fine = swing_error(Integrator::tr_bdf2, 8);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.2) << coarse << " " << fine;
  EXPECT_LT(fine, swing_error(Integrator::bdf2, 8) / 5.0);
}

// The first step starts from the forces of a state that moves: viscosity and the branch of hysteresis are among them.
TEST(Integrator, TrBdf2IsOfSecondOrderFromADampedStart) {
  const auto reached = [](double step_s) {
    SolverOptions options;
    options.integrator = Integrator::tr_bdf2;
    options.dynamic_tolerance = 1e-8;
    options.time_step_s = step_s;
    Body body = cantilever({2, 1, 1}, Eigen::Vector3d::Zero(), options).body();
    body.set_viscosity({3.0, 0.02, 0.3, 0.1});
    Simulation simulation(std::move(body), {}, {}, options);
    SimulationState state = simulation.state();
    state.velocities_m_s.row(1) = 50.0 * state.positions_m.row(0).cwiseAbs2();
    simulation.set_state(state);
    while (simulation.state().time_s < 0.0319) EXPECT_TRUE(simulation.step().converged);
    return simulation.state().positions_m;
  };
  const Eigen::Matrix3Xd fine_m = reached(0.0005);
  const double coarse = (reached(0.004) - fine_m).norm(), half = (reached(0.002) - fine_m).norm();
  EXPECT_GT(std::log2(coarse / half), 1.8) << coarse << " " << half;
}

// What remains of a mode after each step, q_(k+1) = 2 r cos(theta) q_k - r^2 q_(k-1), by least squares.
struct Ring {
  double frequency_hz, damping_ratio;
};

Ring ring_of(const std::vector<double>& q, double step_s) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t k = 1; k + 1 < q.size(); ++k) {
    const Eigen::Vector2d row(q[k], q[k - 1]);
    normal += row * row.transpose();
    right += q[k + 1] * row;
  }
  const Eigen::Vector2d fit = normal.inverse() * right;
  const double r = std::sqrt(-fit[1]), theta = std::acos(0.5 * fit[0] / r), decay = -std::log(r);
  return {theta / (2.0 * M_PI * step_s), decay / std::hypot(theta, decay)};
}

// The bar of R6 with Rayleigh damping of its first mode, at the tolerance that scenes have.
Ring damped_ring(Integrator integrator, double damping_ratio, const Eigen::Vector3i& cells, double step_s) {
  SolverOptions options;
  options.integrator = integrator;
  options.time_step_s = step_s;
  Simulation undamped = cantilever(cells, Eigen::Vector3d::Zero(), options);
  const ModalResult modes = modal_analysis(undamped.body(), 1);
  Body body = undamped.body();
  body.set_viscosity({0.0, damping_ratio / (M_PI * modes.frequencies_hz[0]), 0.0, 1.0});
  Simulation simulation(std::move(body), {}, {}, options);
  const Eigen::Map<const Eigen::Matrix3Xd> shape(modes.shapes.data(), 3, simulation.body().mesh().node_count());
  const Eigen::Matrix3Xd weight = shape * simulation.body().node_masses_kg().asDiagonal();
  SimulationState state = simulation.state();
  state.velocities_m_s = 0.05 / shape.cwiseAbs().maxCoeff() * shape;
  simulation.set_state(state);
  std::vector<double> q;
  while (simulation.state().time_s < 0.7) {
    EXPECT_TRUE(simulation.step().converged);
    q.push_back((simulation.state().positions_m - simulation.body().mesh().nodes_m).cwiseProduct(weight).sum());
  }
  return ring_of(q, options.time_step_s);
}

constexpr double kDefaultStep_s = 1.0 / 60.0;

TEST(Integrator, TrBdf2RingsAsTheReferenceInStepsOfTheDefaultLength) {
  const double reference_hz = read_reference("r6_modal").at(1).number("f1_bend_Hz");
  const Ring ring = damped_ring(Integrator::tr_bdf2, 0.03, {15, 3, 3}, kDefaultStep_s);
  EXPECT_NEAR(ring.frequency_hz, reference_hz, 0.02 * reference_hz);
}

TEST(Integrator, TrBdf2DampsAsTheSiliconeInStepsOfTheDefaultLength) {
  for (const double ratio : {0.03, 0.06}) {
    const Ring fine = damped_ring(Integrator::tr_bdf2, ratio, {8, 2, 2}, kDefaultStep_s / 6.0),
               ring = damped_ring(Integrator::tr_bdf2, ratio, {8, 2, 2}, kDefaultStep_s);
    EXPECT_NEAR(ring.damping_ratio, fine.damping_ratio, 0.02 * fine.damping_ratio) << ratio;
    EXPECT_NEAR(fine.damping_ratio, ratio, 0.03 * ratio);  // what is damped is shear, not volume
  }
  EXPECT_GT(damped_ring(Integrator::implicit_euler, 0.03, {8, 2, 2}, kDefaultStep_s).damping_ratio, 0.2);
}

TEST(Integrator, TrBdf2ComesToOneRestWhateverTheStep) {
  SolverOptions options;
  options.integrator = Integrator::tr_bdf2;
  Eigen::Vector3d rest_m = Eigen::Vector3d::Zero();
  for (const double step_s : {0.0, 0.001, 0.016, 0.1}) {
    if (step_s > 0.0) options.time_step_s = step_s;
    Body body = cantilever({4, 1, 1}, {0, -9.81, 0}, options).body();
    body.set_viscosity({5.0, 0.02, 0.0, 1.0});
    std::vector<Marker> markers;
    markers.emplace_back("tip", Eigen::Vector3d(0.1, 0, 0), body.mesh(), MeshLocator(body.mesh()));
    Simulation simulation(std::move(body), {}, std::move(markers), options);
    if (step_s == 0.0) {
      ASSERT_TRUE(simulation.solve_equilibrium().converged);
      rest_m = simulation.marker_position(0);
      continue;
    }
    while (simulation.state().time_s < 3.0 && !simulation.state().rest_residual) simulation.step();
    EXPECT_LT((simulation.marker_position(0) - rest_m).norm(), 1e-5) << step_s;
  }
}

TEST(Integrator, TrBdf2GoesOnFromASavedStateToTheLastBit) {
  SolverOptions options;
  options.integrator = Integrator::tr_bdf2;
  Simulation simulation = cantilever({4, 1, 1}, {0, -9.81, 0}, options);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(simulation.step().converged);
  const SimulationState saved = simulation.state();
  Simulation other = cantilever({4, 1, 1}, {0, -9.81, 0}, options);
  other.set_state(saved);
  for (Simulation* one : {&simulation, &other})
    for (int i = 0; i < 3; ++i) one->step();
  EXPECT_TRUE(simulation.state() == other.state());
}

TEST(Integrator, Bdf2StartsAnewAfterAnEquilibriumAndAReset) {
  SolverOptions options;
  options.integrator = Integrator::bdf2;
  Simulation simulation = cantilever({4, 1, 1}, {0, -9.81, 0}, options);
  simulation.step();
  simulation.step();
  EXPECT_EQ(simulation.state().previous_step_s, options.time_step_s);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  EXPECT_EQ(simulation.state().previous_step_s, 0.0);
  const Eigen::Vector3d rest = simulation.marker_position(0);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(simulation.step().converged);
  EXPECT_LT((simulation.marker_position(0) - rest).norm(), 1e-6);
  simulation.reset();
  EXPECT_EQ(simulation.state().previous_positions_m.cols(), 0);
}

TEST(Integrator, RefusesAHistoryThatItCannotHave) {
  SolverOptions options;
  options.integrator = Integrator::bdf2;
  Simulation simulation = cantilever({4, 1, 1}, {0, -9.81, 0}, options);
  simulation.step();
  const SimulationState good = simulation.state();
  SimulationState wrong = good;
  wrong.previous_positions_m.resize(3, 0);
  EXPECT_THROW(simulation.set_state(wrong), std::invalid_argument);
  wrong = good;
  wrong.previous_constraint_multipliers.resize(7);
  EXPECT_THROW(simulation.set_state(wrong), std::invalid_argument);
  wrong = good;
  wrong.previous_pressures_pa.resize(7);
  EXPECT_THROW(simulation.set_state(wrong), std::invalid_argument);
  wrong = good;
  wrong.previous_element_multipliers_pa[3] = std::nan("");
  EXPECT_THROW(simulation.set_state(wrong), std::invalid_argument);
  wrong = good;
  wrong.previous_velocities_m_s(1, 2) = std::nan("");
  EXPECT_THROW(simulation.set_state(wrong), std::invalid_argument);
  for (const double step_s : {-0.1, 2.0, std::nan("")}) {
    wrong = good;
    wrong.previous_step_s = step_s;
    EXPECT_THROW(simulation.set_state(wrong), std::invalid_argument) << step_s;
  }
  EXPECT_NO_THROW(simulation.set_state(good));
}

TEST(Integrator, ImplicitEulerStaysImplicitEulerWithAHistoryOfBdf2) {
  SolverOptions options;
  Simulation first_order = cantilever({4, 1, 1}, {0, -9.81, 0}, options);
  options.integrator = Integrator::bdf2;
  Simulation second_order = cantilever({4, 1, 1}, {0, -9.81, 0}, options);
  second_order.step();
  first_order.step();  // the first step is the same
  EXPECT_EQ(first_order.state().positions_m, second_order.state().positions_m);
  first_order.set_state(second_order.state());
  first_order.step();
  second_order.step();
  EXPECT_GT((first_order.state().positions_m - second_order.state().positions_m).norm(), 1e-6);
}

}  // namespace
}  // namespace soft_robot_lab
