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
  return (state.positions_m - body.mesh().nodes_m - peak).norm() / peak.norm();
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
