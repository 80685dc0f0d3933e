// SPDX-License-Identifier: BSD-3-Clause
// Coulomb friction on rigid obstacles, against references and closed forms.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "compare_with_reference.h"
#include "contact_bodies.h"
#include "mechanics/round_mesh.h"
#include "reference_table.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.81;

Simulation block_on_slope(double friction, double angle_rad, const SolverOptions& options) {
  Body body = loose_block();
  body.set_gravity(kGravity * Vector3d(std::sin(angle_rad), -std::cos(angle_rad), 0));
  body.set_obstacles({{"slope", Plane{{0, 0, 0}, {0, 1, 0}}, {}, friction}});
  return Simulation(std::move(body), {}, {}, options);
}

SolverOptions steps_of(double time_step_s, Integrator integrator = Integrator::implicit_euler) {
  SolverOptions options;
  options.time_step_s = time_step_s;
  options.integrator = integrator;
  return options;
}

void run(Simulation& simulation, double duration_s) {
  const auto steps = std::lround(duration_s / simulation.options().time_step_s);
  for (long i = 0; i < steps; ++i) ASSERT_TRUE(simulation.step().converged);
}

double speed_m_s(const Simulation& simulation) {
  const Eigen::VectorXd& masses_kg = simulation.body().node_masses_kg();
  return simulation.state().velocities_m_s.row(0).dot(masses_kg.transpose()) / masses_kg.sum();
}

const double kSlope = std::atan(0.5);  // 26.565 degrees

// A block of 20 x 40 x 20 mm, uphill faces in x, tips where tan exceeds its width over its height.
double top_moves_m(double over_degrees, double time_step_s, const Eigen::Vector3i& cells) {
  const double angle_rad = std::atan(0.02 / 0.04) + over_degrees / 180.0 * M_PI;
  Body body(box_mesh({-0.01, 0, -0.01}, {0.01, 0.04, 0.01}, cells), {5e6, 0.45, 1070.0});
  Viscosity viscosity;
  viscosity.rayleigh_mass_per_s = 20.0;
  body.set_viscosity(viscosity);
  body.set_gravity(kGravity * Vector3d(std::sin(angle_rad), -std::cos(angle_rad), 0));
  body.set_obstacles({{"slope", Plane{{0, 0, 0}, {0, 1, 0}}, {}, 1.5}});
  std::vector<Marker> markers;
  markers.emplace_back("top", Vector3d(0, 0.04, 0), body.mesh(), MeshLocator(body.mesh()));
  Simulation simulation(std::move(body), {}, std::move(markers), steps_of(time_step_s));
  run(simulation, 0.8);
  return simulation.marker_position(0).x();
}

TEST(Friction, ABlockTipsOverTheEdgeOfItsFoot) {
  for (const Eigen::Vector3i& cells : {Eigen::Vector3i(1, 2, 1), Eigen::Vector3i(2, 4, 2)}) {
    EXPECT_LT(top_moves_m(-0.3, 1.0 / 120.0, cells), 2e-4);
    EXPECT_GT(top_moves_m(0.3, 1.0 / 120.0, cells), 5e-4);
  }
}

TEST(Friction, ARoundBodyThatRollsOnLessThanAFaceIsNamed) {
  Body body(quarter_ball(0.015, 2), kSilicone);
  body.set_gravity({0, -kGravity, 0});
  body.set_obstacles({{"floor", Plane{{0, -0.015, 0}, {0, 1, 0}}, {}, 0.5}});
  Simulation rolls(std::move(body), {}, {}, steps_of(0.004));
  Simulation stands = block_on_slope(0.5, 0.1, steps_of(0.004));
  const auto named = [](const SolveReport& report) {
    return std::any_of(report.warnings.begin(), report.warnings.end(), [](const SolveWarning& warning) {
      return warning.kind == "coarse_contact" && warning.text.find("'floor'") != std::string::npos;
    });
  };
  bool is_named = false;
  for (int i = 0; i < 10; ++i) is_named = named(rolls.step()) || is_named;
  EXPECT_TRUE(is_named);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(stands.step().warnings.empty());
}

TEST(Friction, ASlopeHoldsABlockAtItsCoefficientAndNotBelow) {
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
    // From rest: a block that slides already goes on at just its speed.
    Simulation sticks = block_on_slope(0.50, 26.565 / 180.0 * M_PI, steps_of(0.005, integrator));
    const SolveReport rest = sticks.solve_equilibrium();
    ASSERT_TRUE(rest.converged) << rest.message;
    const double settled_m = middle_m(sticks).x();
    run(sticks, 0.3);
    EXPECT_NEAR(middle_m(sticks).x(), settled_m, 1e-7);

    Simulation slides = block_on_slope(0.49, kSlope, steps_of(0.005, integrator));
    run(slides, 0.1);  // gravity comes at once, so at first it bounces a little
    const double before_m_s = speed_m_s(slides);
    run(slides, 0.4);
    const double acceleration = kGravity * (std::sin(kSlope) - 0.49 * std::cos(kSlope));
    EXPECT_NEAR((speed_m_s(slides) - before_m_s) / 0.4, acceleration, 0.02 * acceleration);
  }
}

// While all of its foot slips, x_cm + mu y_cm moves as a point does, whatever the body's stiffness.
TEST(Friction, WithXpbdASlopeHoldsABlockAtItsCoefficientAndNotBelow) {
  const auto on_slope = [](double friction) {
    Body body = loose_block({2, 1, 2});
    body.set_gravity(kGravity * Vector3d(std::sin(kSlope), -std::cos(kSlope), 0));
    body.set_viscosity({0.0, 0.002, 0.0, 1.0});
    body.set_obstacles({{"slope", Plane{{0, 0, 0}, {0, 1, 0}}, {}, friction}});
    return Simulation(std::move(body), {}, {}, xpbd(40, 0.005));
  };
  Simulation sticks = on_slope(0.55);
  run(sticks, 0.2);
  const double settled_m = middle_m(sticks).x();
  run(sticks, 0.2);
  EXPECT_NEAR(middle_m(sticks).x(), settled_m, 1e-6);

  Simulation slides = on_slope(0.4);
  run(slides, 0.1);
  const double before_m_s = speed_m_s(slides);
  run(slides, 0.2);
  const double acceleration = kGravity * (std::sin(kSlope) - 0.4 * std::cos(kSlope));
  EXPECT_NEAR((speed_m_s(slides) - before_m_s) / 0.2, acceleration, 0.02 * acceleration);
}

TEST(Friction, ASlidingBlockMovesAsAPointDoes) {
  const double mu = 0.4, angle_rad = 35.0 / 180.0 * M_PI;
  Simulation simulation = block_on_slope(mu, angle_rad, steps_of(0.005, Integrator::bdf2));
  const Vector3d start_m = middle_m(simulation);
  run(simulation, 0.2);
  const Vector3d moved_m = middle_m(simulation) - start_m;
  EXPECT_NEAR(moved_m.x() + mu * moved_m.y(), 0.5 * 2.41244 * 0.2 * 0.2, 0.3e-3);
  const ContactReading contact = simulation.contacts()[0];
  EXPECT_NEAR(contact.force_n.x(), -mu * contact.force_n.y(), 1e-3 * contact.force_n.y());
  EXPECT_NEAR(contact.slipping_area_m2, contact.area_m2, 1e-12);
}

TEST(Friction, ABlockThatWasPushedStopsAfterItsStoppingDistanceAndStays) {
  const double mu = 0.5, speed_m_s = 0.5;
  Simulation simulation = block_on_slope(mu, 0.0, steps_of(0.001, Integrator::bdf2));
  run(simulation, 0.1);
  SimulationState state = simulation.state();
  state.velocities_m_s.row(0).array() += speed_m_s;
  if (state.previous_velocities_m_s.size() > 0) state.previous_velocities_m_s.row(0).array() += speed_m_s;
  if (state.previous_positions_m.size() > 0)
    state.previous_positions_m.row(0).array() -= speed_m_s * simulation.options().time_step_s;
  state.rest_residual.reset();
  simulation.set_state(state);
  const double start_m = middle_m(simulation).x();
  run(simulation, 0.3);
  const double stopped_m = middle_m(simulation).x();
  const double expected_m = speed_m_s * speed_m_s / (2.0 * mu * kGravity);
  EXPECT_NEAR(stopped_m - start_m, expected_m, 0.02 * expected_m);
  run(simulation, 0.3);
  EXPECT_NEAR(middle_m(simulation).x(), stopped_m, 1e-7);
}

TEST(Friction, ABlockAtRestOnASlopeSleepsWithoutCreep) {
  Simulation simulation = block_on_slope(0.5, 20.0 / 180.0 * M_PI, steps_of(0.01));
  run(simulation, 1.0);
  EXPECT_TRUE(simulation.state().rest_residual.has_value());
  const Eigen::Matrix3Xd before_m = simulation.state().positions_m;
  run(simulation, 60.0);
  EXPECT_LT((simulation.state().positions_m - before_m).cwiseAbs().maxCoeff(), 1e-8);
  const double weight_n = kGravity * simulation.body().node_masses_kg().sum();
  EXPECT_NEAR(simulation.contacts()[0].force_n.norm(), weight_n, 1e-5);
}

// R10: pressed, then pulled along in stages, on 5 mm; partial slip grows from the ends.
TEST(Friction, APressedBlockShearsAsInTheReference) {
  SimulationState state;
  for (const ReferenceRow& row : read_reference("r10_friction_block_planestrain")) {
    const double shear_pa = row.number("shear_Pa");
    if (row.text("law") != "design" || shear_pa == 3400.0 || shear_pa > 4000.0) continue;
    Body body(box_mesh({-0.02, 0, 0}, {0.02, 0.012, 0.01}, {16, 5, 2}), kSilicone);
    hold_slab(body);
    body.add_traction({-1, 0.012 - 1e-6, -1}, {1, 1, 1}, {shear_pa, -10000, 0});
    body.set_obstacles({{"floor", Plane{{0, 0, 0}, {0, 1, 0}}, {}, 0.5}});
    std::vector<Marker> markers;
    markers.emplace_back("top", Vector3d(0, 0.012, 0.005), body.mesh(), MeshLocator(body.mesh()));
    Simulation simulation(std::move(body), {}, std::move(markers), SolverOptions{});
    if (state.positions_m.size() > 0) simulation.set_state(state);
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    const ContactReading contact = simulation.contacts()[0];
    EXPECT_NEAR(contact.force_n.x(), -shear_pa * 4e-4, 1e-5);
    EXPECT_NEAR(contact.force_n.y(), 4.0, 1e-5);
    const double expected_m = row.number("top_centre_ux_m");
    expect_near_reference("R10, sheared block, " + rounded(shear_pa) + " Pa | 2.5 mm | top [m]",
                          simulation.marker_position(0).x(), expected_m,
                          shear_pa > 3500.0 ? 0.03 * expected_m : 0.01 * expected_m + 5e-6);
    state = simulation.state();
    state.linearisation = nullptr;
  }
}

// Beyond the limit there is no rest: pulled with more than mu N, it slides on the floor and not on the wall behind.
TEST(Friction, AnEquilibriumBeyondTheLimitOfFrictionSaysWhatSlides) {
  Body body = loose_block({2, 1, 2});
  body.set_gravity(kGravity * Vector3d(0.55, -1, 0));
  body.set_obstacles(
      {{"floor", Plane{{0, 0, 0}, {0, 1, 0}}, {}, 0.5}, {"wall", Plane{{-0.02, 0, 0}, {1, 0, 0}}, {}, 0.5}});
  Simulation simulation(std::move(body), {}, {}, SolverOptions{});
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_FALSE(report.converged);
  EXPECT_NE(report.message.find("the body slides on 'floor': friction does not hold it; it goes along (1, 0, 0)"),
            std::string::npos)
      << report.message;
  EXPECT_LT(report.iterations, 400);
}

// A table that turns under a block takes it along.
TEST(Friction, ATurningTableTakesTheBlockAlong) {
  SolverOptions options = steps_of(0.01);
  Body body = loose_block({2, 1, 2});
  body.set_gravity({0, -kGravity, 0});
  body.set_obstacles({{"table",
                       RoundedBox{{0, -0.02, 0}, {0.3, 0.04, 0.3}, 0.005},
                       {{0.1, kZero, kZero}, {1.1, kZero, {0, 0.5, 0}}},
                       0.8}});
  Simulation simulation(std::move(body), {}, {}, options);
  run(simulation, 1.3);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.5, Vector3d::UnitY()).toRotationMatrix();
  const Eigen::Matrix3Xd expected_m = turn * simulation.body().mesh().nodes_m;
  EXPECT_LT((simulation.state().positions_m - expected_m).colwise().norm().maxCoeff(), 1e-4);
}

}  // namespace
}  // namespace soft_robot_lab
