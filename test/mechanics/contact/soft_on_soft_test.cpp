// SPDX-License-Identifier: BSD-3-Clause
// Soft bodies that touch one another, with and without friction, against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "contact_bodies.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

TetMesh together(TetMesh one, const TetMesh& other) {
  add_body("upper", other, one);
  return one;
}

// A column in a frictionless tube, cut across and loaded from above: its strain is the same everywhere,
// p / (lambda + 2 mu).
TEST(SoftOnSoft, ACutColumnIsPressedEvenly) {
  constexpr double kPressure = 5000.0;
  struct Case {
    Vector3i above;
    double tolerance;
  };
  for (const Case& one : {Case{{3, 2, 3}, 1e-8}, Case{{4, 2, 4}, 0.01}}) {
    Body body(together(box_mesh({0, 0, 0}, {0.02, 0.01, 0.02}, {3, 2, 3}),
                       box_mesh({0, 0.01, 0}, {0.02, 0.02, 0.02}, one.above)),
              {264200.0, 0.3, 1070.0});
    body.fix_nodes({-1, -1, -1}, {1, 1e-9, 1}, {false, true, false});
    for (const double side : {0.0, 0.02}) {
      body.fix_nodes({side - 1e-9, -1, -1}, {side + 1e-9, 1, 1}, {true, false, false});
      body.fix_nodes({-1, -1, side - 1e-9}, {1, 1, side + 1e-9}, {false, false, true});
    }
    body.add_traction({-1, 0.02 - 1e-9, -1}, {1, 1, 1}, {0, -kPressure, 0});
    body.let_skin_touch({{0, 1, 0.0}});
    const double strain = kPressure / (body.material().lame_lambda_pa() + 2.0 * body.material().lame_mu_pa());
    SolverOptions options;
    options.tolerance = 1e-9;
    Simulation simulation(std::move(body), {}, {}, options);
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    const Eigen::Matrix3Xd& rest_m = simulation.body().mesh().nodes_m;
    const Eigen::Matrix3Xd moved_m = simulation.state().positions_m - rest_m;
    // Between the blocks the contact gives way by its compliance, alike everywhere.
    const double sunk_m = simulation.contacts().back().largest_penetration_m;
    double worst = 0.0;
    for (Eigen::Index node = 0; node < rest_m.cols(); ++node) {
      if (std::abs(rest_m(1, node) - 0.01) < 1e-9) continue;  // of which of both?
      const double expected_m = -strain * rest_m(1, node) - (rest_m(1, node) > 0.01 ? sunk_m : 0.0);
      worst = std::max(worst, std::abs(moved_m(1, node) - expected_m) / (0.02 * strain));
    }
    EXPECT_LT(worst, one.tolerance) << one.above.transpose();
    const ContactReading contact = simulation.contacts().back();
    EXPECT_NEAR(contact.area_m2, 4e-4, 1e-6);
    EXPECT_EQ(contact.on + " " + contact.surface, "body upper");
    EXPECT_NEAR(contact.force_n.y(), -kPressure * 4e-4, 1e-6);  // of the upper on the lower
    EXPECT_NEAR(contact.normal.y(), -1.0, 1e-6);
  }
}

constexpr double kGravity = 9.81;
const double kSlope = std::atan(0.5);  // 26.565 degrees

SolverOptions steps_of(double time_step_s) {
  SolverOptions options;
  options.time_step_s = time_step_s;
  return options;
}

// A block on a bed as soft as itself, which is clamped below.
Simulation block_on_bed(double friction, double angle_rad, const SolverOptions& options) {
  Body body(together(box_mesh({-0.04, -0.01, -0.03}, {0.06, 0, 0.03}, {5, 1, 3}),
                     box_mesh({-0.02, 0, -0.02}, {0.02, 0.02, 0.02}, {2, 1, 2})),
            kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, -0.01 + 1e-9, 1}, {true, true, true});
  body.set_gravity(kGravity * Vector3d(std::sin(angle_rad), -std::cos(angle_rad), 0));
  body.let_skin_touch({{0, 1, friction}});
  return Simulation(std::move(body), {}, {}, options);
}

// Of the block: all that lies above the bed.
Vector3d block_m(const Simulation& simulation, const Eigen::Matrix3Xd& columns) {
  const Eigen::Matrix3Xd& rest_m = simulation.body().mesh().nodes_m;
  Vector3d sum = Vector3d::Zero();
  double mass_kg = 0.0;
  for (Eigen::Index node = 0; node < rest_m.cols(); ++node) {
    if (rest_m(1, node) < 1e-9) continue;
    sum += simulation.body().node_masses_kg()[node] * columns.col(node);
    mass_kg += simulation.body().node_masses_kg()[node];
  }
  return sum / mass_kg;
}

void run(Simulation& simulation, double duration_s) {
  const auto steps = std::lround(duration_s / simulation.options().time_step_s);
  for (long i = 0; i < steps; ++i) ASSERT_TRUE(simulation.step().converged);
}

TEST(SoftOnSoft, AnInclinedBedHoldsABlockAtItsCoefficientAndNotBelow) {
  Simulation sticks = block_on_bed(0.50, 26.5 / 180.0 * M_PI, steps_of(0.01));
  run(sticks, 0.4);
  const double settled_m = block_m(sticks, sticks.state().positions_m).x();
  run(sticks, 0.4);
  EXPECT_NEAR(block_m(sticks, sticks.state().positions_m).x(), settled_m, 2e-6);

  Simulation slides = block_on_bed(0.49, kSlope, steps_of(0.005));
  run(slides, 0.1);  // gravity comes at once, so at first it bounces a little
  const double before_m_s = block_m(slides, slides.state().velocities_m_s).x();
  run(slides, 0.3);
  const double acceleration_m_s2 = kGravity * (std::sin(kSlope) - 0.49 * std::cos(kSlope));
  EXPECT_NEAR((block_m(slides, slides.state().velocities_m_s).x() - before_m_s) / 0.3, acceleration_m_s2,
              0.02 * acceleration_m_s2);
  const ContactReading contact = slides.contacts().back();
  EXPECT_GT(contact.slipping_area_m2, 0.9 * contact.area_m2);
}

// At rest on a slope, held by friction; and in time, beyond what friction holds.
TEST(SoftOnSoft, WithXpbdABlockLiesOnABedAsWithNewton) {
  const double angle_rad = 20.0 / 180.0 * M_PI;
  Simulation newton = block_on_bed(0.5, angle_rad, {}), local = block_on_bed(0.5, angle_rad, xpbd(100));
  for (Simulation* simulation : {&newton, &local}) {
    const SolveReport report = simulation->solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
  }
  const Eigen::Matrix3Xd &expected_m = newton.state().positions_m, &found_m = local.state().positions_m;
  const double way_m = (expected_m - newton.body().mesh().nodes_m).colwise().norm().maxCoeff();
  EXPECT_LT((found_m - expected_m).colwise().norm().maxCoeff(), 0.01 * way_m);
  const Vector3d expected_n = newton.contacts().back().force_n;
  EXPECT_LT((local.contacts().back().force_n - expected_n).norm(), 0.01 * expected_n.norm());

  Simulation slides = block_on_bed(0.3, angle_rad, xpbd(40, 0.005));
  run(slides, 0.1);
  const double before_m_s = block_m(slides, slides.state().velocities_m_s).x();
  run(slides, 0.2);
  const double acceleration_m_s2 = kGravity * (std::sin(angle_rad) - 0.3 * std::cos(angle_rad));
  EXPECT_NEAR((block_m(slides, slides.state().velocities_m_s).x() - before_m_s) / 0.2, acceleration_m_s2,
              0.02 * acceleration_m_s2);
}

TEST(SoftOnSoft, BodiesThatAreNotListedPassThroughOneAnother) {
  Body body(together(box_mesh({0, 0, 0}, {0.02, 0.01, 0.02}, {1, 1, 1}),
                     box_mesh({0, 0.011, 0}, {0.02, 0.02, 0.02}, {1, 1, 1})),
            kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, 1e-9, 1}, {true, true, true});
  body.set_gravity({0, -kGravity, 0});
  body.let_skin_touch({{0, 0, 0.0}, {1, 1, 0.0}});
  Simulation simulation(std::move(body), {}, {}, SolverOptions{});
  run(simulation, 0.1);
  const Eigen::Matrix3Xd fallen_m = simulation.state().positions_m - simulation.body().mesh().nodes_m;
  EXPECT_LT(fallen_m.row(1).minCoeff(), -0.02);
}

// A bar sags onto a block's edge and rubs a little there. The way down in artificial time came to where nothing moved,
// and went on 500 times with a longer step, until its square was infinite: 2262 iterations.
TEST(SoftOnSoft, AWayDownOnWhichNothingMovesEnds) {
  Body body(together(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {10, 2, 2}),
                     box_mesh({0.05, -0.04, -0.015}, {0.08, -0.014, 0.017}, {3, 3, 3})),
            kSilicone);
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  body.fix_nodes({-1, -1, -1}, {1, -0.0399, 1}, {true, true, true});
  body.set_gravity({0, -2.0 * kGravity, 0});
  body.let_skin_touch({{0, 1, 0.1}});
  Simulation simulation(std::move(body), {}, {}, SolverOptions{});
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  EXPECT_LT(report.iterations, 1800);
  EXPECT_NEAR(simulation.contacts()[0].normal_force_n, 0.352, 0.004);
}

TEST(SoftOnSoft, RefusesWhatCannotBe) {
  const auto refusal = [](double bottom_m, std::vector<TouchingBodies> pairs) -> std::string {
    Body body(together(box_mesh({0, 0, 0}, {0.02, 0.01, 0.02}, {2, 1, 2}),
                       box_mesh({0.002, bottom_m, 0.002}, {0.012, 0.02, 0.012}, {2, 1, 2})),
              kSilicone);
    try {
      body.let_skin_touch(std::move(pairs));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(0.01, {{0, 1, 0.5}, {0, 0, 0.0}}), "");
  EXPECT_EQ(refusal(0.009, {{0, 0, 0.0}}), "");
  EXPECT_NE(refusal(0.009, {{1, 0, 0.0}}).find("body 'upper' is 0.001 m inside body 'body' at the start, at"),
            std::string::npos)
      << refusal(0.009, {{1, 0, 0.0}});
  EXPECT_EQ(refusal(0.01, {{0, 1, -0.1}}), "friction of skin on skin: -0.1 is out of range [0, inf)");
  EXPECT_EQ(refusal(0.01, {{0, 2, 0.1}}), "contact of bodies 0 and 2: there are 2");
  EXPECT_EQ(refusal(0.01, {{0, 1, 0.1}, {1, 0, 0.1}}), "contact of 'upper' and 'body' is given twice");
}

}  // namespace
}  // namespace soft_robot_lab
