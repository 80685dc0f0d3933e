// SPDX-License-Identifier: BSD-3-Clause
// Shapes on which contact has no clear normal (after Erleben 2018, "Methodology for assessing mesh-based contact point
// methods"): spikes, ridges, a crack, a cliff's edge. One soft body falls on another of such a shape.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "contact_bodies.h"
#include "mechanics/contact/contact_term.h"

namespace soft_robot_lab {
namespace {

using Height = std::function<double(double x_m, double z_m)>;  // of the top, above the bottom

constexpr double kLow_m = 0.006, kHigh_m = 0.02;

double flat(double /*x_m*/, double /*z_m*/) { return kHigh_m; }
double ridge(double x_m, double /*z_m*/) { return std::abs(x_m) < 1e-9 ? kHigh_m : kLow_m; }
double crossed_ridge(double /*x_m*/, double z_m) { return std::abs(z_m) < 1e-9 ? kHigh_m : kLow_m; }
double crack(double x_m, double /*z_m*/) { return std::abs(x_m) < 1e-9 ? kLow_m : kHigh_m; }
double spike(double x_m, double z_m) { return std::abs(x_m) + std::abs(z_m) < 1e-9 ? kHigh_m : kLow_m; }

// 24 x 24 mm, its bottom at y = 0.
TetMesh shape(const Height& height_m) {
  TetMesh mesh = box_mesh({-0.012, 0, -0.012}, {0.012, kHigh_m, 0.012}, {2, 1, 2}, false);
  for (int node = 0; node < mesh.node_count(); ++node)
    if (mesh.nodes_m(1, node) > 0.0) mesh.nodes_m(1, node) = height_m(mesh.nodes_m(0, node), mesh.nodes_m(2, node));
  return mesh;
}

// Upside down, its lowest point 0.2 mm above the highest of the lower shape.
TetMesh hanging(const Height& height_m, double aside_m, double lowest_m) {
  TetMesh mesh = shape(height_m);
  mesh.nodes_m.row(1) = (lowest_m + kHigh_m - mesh.nodes_m.row(1).array()).matrix();
  mesh.nodes_m.row(2) *= -1.0;  // turned, not mirrored
  mesh.nodes_m.row(0).array() += aside_m;
  return mesh;
}

struct Fall {
  std::string name;
  Height lower, upper;
  double aside_m;
  double lowest_m = kHigh_m + 0.0002;
};

Body both(const Fall& fall, double g_m_s2) {
  TetMesh mesh = make_quadratic(shape(fall.lower));
  add_body("upper", make_quadratic(hanging(fall.upper, fall.aside_m, fall.lowest_m)), mesh);
  Body body(std::move(mesh), kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, 1e-9, 1}, {true, true, true});
  body.set_gravity({0, -g_m_s2, 0});
  body.let_skin_touch({{0, 1, 0.3}});
  return body;
}

Simulation falling(const Fall& fall, double g_m_s2) {
  SolverOptions options;
  options.time_step_s = 0.005;
  return Simulation(both(fall, g_m_s2), {}, {}, options);
}

// `most_failed`: steps in a row that may have no solution and end at rest; it goes on by itself after them.
void expect_clean(const Fall& fall, int steps, int most_failed = 0, double g_m_s2 = 9.81) {
  SCOPED_TRACE(fall.name);
  Simulation simulation = falling(fall, g_m_s2);
  simulation.keep_energy_ledger();
  double deepest_m = 0.0, pressed_n = 0.0;
  int failed = 0;
  for (int i = 0; i < steps; ++i) {
    const SolveReport report = simulation.step();
    failed = report.converged ? 0 : failed + 1;
    ASSERT_LE(failed, most_failed) << i << ": " << report.message;
    EXPECT_EQ(report.inverted_elements, 0) << i;
    if (simulation.contacts().empty()) continue;
    deepest_m = std::max(deepest_m, simulation.contacts().back().largest_penetration_m);
    pressed_n = std::max(pressed_n, simulation.contacts().back().normal_force_n);
  }
  ASSERT_TRUE(simulation.state().positions_m.allFinite());
  EXPECT_GT(pressed_n, 0.0) << "they meet";
  EXPECT_LE(deepest_m, 1e-4);
  const EnergyLedger& ledger = *simulation.energy_ledger();
  EXPECT_LE(std::abs(ledger.closure_error_j), 0.01 * ledger.turned_over_j);
  EXPECT_GE(ledger.integrator_j, -0.01 * ledger.turned_over_j) << "it gives no energy";
}

TEST(DegenerateShapes, MeetWithoutPassingThroughOrGainingEnergy) {
  for (const Fall& fall :
       {Fall{"spike on spike", spike, spike, 0.0}, Fall{"spike on ridge", ridge, spike, 0.0},
        Fall{"spike on cliff", flat, spike, 0.012}, Fall{"ridge across ridge", ridge, crossed_ridge, 0.0},
        Fall{"ridge in crack", crack, ridge, 0.0, kLow_m + 0.0002}, Fall{"block over a cliff", flat, flat, 0.008}})
    expect_clean(fall, 30);
}

// These stood still for ever, or for five steps, as long as a point beyond an edge could count as inside.
TEST(DegenerateShapes, RecoverFromStepsWithoutASolution) {
  constexpr int kMostFailed = 4;
  expect_clean({"edge on edge", flat, flat, 0.024}, 30, kMostFailed);
  expect_clean({"spike in crack", crack, spike, 0.0, kLow_m + 0.0002}, 30, kMostFailed);
  expect_clean({"ridge along ridge", ridge, ridge, 0.0}, 100, kMostFailed);
  expect_clean({"ridge across ridge", ridge, crossed_ridge, 0.0}, 100, kMostFailed);
  expect_clean({"spike on spike", spike, spike, 0.0}, 100, kMostFailed);
  expect_clean({"spike on ridge", ridge, spike, 0.0}, 60, kMostFailed, 5.0 * 9.81);
}

// A face of the upper ridge that is in front of the lower's right side is millimetres behind its left one, which it
// faces; and an edge beside an edge is behind the top whose plane goes on there. Corners are left out.
TEST(DegenerateShapes, DoNotTouchWhereTheyDoNotOverlap) {
  const double beside_m = 0.002, height_m = kHigh_m - beside_m / 0.012 * (kHigh_m - kLow_m);
  for (const Fall& fall : {Fall{"ridge beside ridge", ridge, ridge, beside_m, height_m + 1e-4},
                           Fall{"edge beside edge", flat, flat, 0.024 + 5e-5, kHigh_m - 4e-5}}) {
    SCOPED_TRACE(fall.name);
    const Body body = both(fall, 9.81);
    const ContactTerm term(body);
    const Eigen::Matrix3Xd& rest_m = body.mesh().nodes_m;
    for (const ContactTouch& touch : term.sums(rest_m, term.untouched(rest_m, 0.0)).touches)
      EXPECT_GT(std::abs(term.skin().points().at(touch.pair, rest_m).z()), 0.0119) << 1e6 * touch.gap_m << " um";
  }
}

}  // namespace
}  // namespace soft_robot_lab
