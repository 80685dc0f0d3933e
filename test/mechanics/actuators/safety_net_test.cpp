// SPDX-License-Identifier: BSD-3-Clause
// What the solver does where Newton's method alone finds no way, and that neither scale, time step nor method of
// solution shows in where a body comes to rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

#include "mechanics/box_mesh.h"
#include "soft_robot_lab/mechanics/actuators/cable.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

struct Bar {
  double length_m = 0.1, thickness_m = 0.02;
  Eigen::Vector3i cells = {5, 1, 1};
  double scale = 1.0;  // of all lengths; gravity goes down as they go up, so that one shape serves all
  std::string cable = "compliance_m_n: 0";
  SolverOptions options;
};

// Clamped at x = 0, under gravity, with one cable above its middle.
Simulation make_bar(const Bar& bar) {
  const double s = bar.scale, length = s * bar.length_m, half = 0.5 * s * bar.thickness_m;
  Body body(box_mesh({0, -half, -half}, {length, half, half}, bar.cells), {264200.0, 0.499, 1070.0});
  body.fix_nodes({-10, -10, -10}, {1e-6 * s, 10, 10}, {true, true, true});
  body.set_gravity({0, -9.81 / s, 0});
  const MeshLocator locator(body.mesh());
  std::ostringstream settings;
  settings.precision(17);  // as the scaled number is, to its last bit
  settings << "{name: upper, " << bar.cable << ", sheath_radius_m: " << 0.05 * s * bar.thickness_m
           << ", plug_radius_m: " << 0.15 * s * bar.thickness_m << ", points_m: [";
  for (const double fraction : {0.0, 0.3, 0.6, 0.95})
    settings << (fraction > 0.0 ? ", " : "") << "[" << fraction * length << ", " << 0.6 * half << ", 0]";
  settings << "]}";
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::make_unique<Cable>());
  actuators.back()->initialise(YamlNode::parse(settings.str(), "bar"), body, locator);
  std::vector<Marker> markers;
  markers.emplace_back("tip", Eigen::Vector3d(length, 0, 0), body.mesh(), locator);
  return Simulation(std::move(body), std::move(actuators), std::move(markers), bar.options);
}

void move_free_nodes(Simulation& simulation, const std::function<Eigen::Vector3d(int)>& place) {
  SimulationState state = simulation.state();
  for (int node = 0; node < static_cast<int>(state.positions_m.cols()); ++node)
    if (!simulation.body().fixed().col(node).any()) state.positions_m.col(node) = place(node);
  simulation.set_state(state);
}

// From a fixed linear congruence: the same everywhere.
Eigen::Vector3d anywhere_in_the_box(int node) {
  const auto fraction = [&](int axis) { return std::fmod(0.5 + 0.6180339887498949 * (3 * node + axis), 1.0); };
  return {0.1 * fraction(0), 0.02 * (fraction(1) - 0.5), 0.02 * (fraction(2) - 0.5)};
}

Eigen::Vector3d one_point(int) { return {0.05, 0.0, 0.0}; }

TEST(SafetyNet, FindsTheRestStateOfATangledBody) {
  Simulation careful = make_bar({});
  careful.set_command("upper", 0.9);
  ASSERT_TRUE(careful.solve_equilibrium().converged);
  for (const auto& tangle : {anywhere_in_the_box, one_point}) {
    Simulation tangled = make_bar({});
    tangled.set_command("upper", 0.9);
    move_free_nodes(tangled, tangle);
    const SolveReport report = tangled.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    EXPECT_EQ(report.inverted_elements, 0);
    EXPECT_LT((tangled.marker_position(0) - careful.marker_position(0)).norm(), 1e-6);
  }
}

TEST(SafetyNet, UntanglesABodyInTime) {
  for (const auto& tangle : {anywhere_in_the_box, one_point}) {
    Simulation bar = make_bar({});
    move_free_nodes(bar, tangle);
    SolveReport report;
    for (int i = 0; i < 60; ++i) {
      report = bar.step();
      ASSERT_TRUE(bar.state().positions_m.allFinite()) << i;
      ASSERT_TRUE(bar.state().velocities_m_s.allFinite()) << i;
    }
    EXPECT_TRUE(report.converged) << report.message;
    EXPECT_EQ(report.inverted_elements, 0);
  }
}

// A step tries it where the last 1, 2, 4, 8, ... have ended so.
TEST(SafetyNet, LaysOutAnewWhatStaysInverted) {
  for (const int inverted_steps : {1, 3}) {
    Simulation bar = make_bar({});
    SimulationState folded = bar.state();
    folded.positions_m.rightCols(8).row(0).array() -= 0.05;  // the tip into the middle
    folded.inverted_steps = inverted_steps;
    bar.set_state(folded);
    const SolveReport report = bar.step();
    EXPECT_TRUE(report.converged) << report.message;
    const bool warned = std::any_of(report.warnings.begin(), report.warnings.end(),
                                    [](const SolveWarning& warning) { return warning.kind == "untangled"; });
    EXPECT_EQ(warned, inverted_steps == 1);
    EXPECT_EQ(bar.state().inverted_steps, report.inverted_elements > 0 ? inverted_steps + 1 : 0);
    EXPECT_TRUE(!warned || report.inverted_elements == 0);
  }
}

TEST(SafetyNet, TakesHalfTheContractionInOneStep) {
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2}) {
    Bar bar;
    bar.options.integrator = integrator;
    Simulation simulation = make_bar(bar);
    simulation.set_command("upper", 0.5);
    for (int i = 0; i < 20; ++i) {
      const SolveReport report = simulation.step();
      EXPECT_TRUE(report.converged) << i << ": " << report.message;
    }
    const ActuatorReading cable = simulation.actuator_state(0);
    EXPECT_LT(*cable.length_m / *cable.rest_length_m, 0.501);
    EXPECT_GT(*cable.length_m / *cable.rest_length_m, 0.49);  // where the bar swings the cable may be slack
  }
}

// Time scales with length here: material and wave speed stay. Powers of four, whose square roots are exact too: every
// number of one run is that of another to its last bit. By other factors rounding differs, and where a line search
// stands on an edge so do counts of iterations, on one processor and not on another.
TEST(SafetyNet, DoesNotDependOnScaleInTime) {
  std::vector<Eigen::Vector3d> tips;
  std::vector<int> iterations;
  for (const double scale : {1.0 / 64, 1.0, 16.0}) {
    Bar bar;
    bar.scale = scale;
    bar.options.time_step_s = scale / 60.0;
    Simulation simulation = make_bar(bar);
    simulation.set_command("upper", 0.7);
    int work = 0;
    for (int i = 0; i < 12; ++i) {
      const SolveReport report = simulation.step();
      EXPECT_TRUE(report.converged) << report.message;
      work += report.iterations;
    }
    tips.push_back(simulation.marker_position(0) / scale);
    iterations.push_back(work);
  }
  for (const std::size_t other : {0u, 2u}) {
    EXPECT_EQ((tips[other] - tips[1]).norm(), 0.0);
    EXPECT_EQ(iterations[other], iterations[1]);
  }
}

// Steps in time, and stops the motion whenever it slows down (kinetic damping), since short steps damp little: without
// that a body at 1 ms swings for thousands of steps. It changes how a body comes to rest, not where.
void settle_in_time(Simulation& simulation, int steps) {
  double before = 0.0;
  for (int i = 0; i < steps; ++i) {
    simulation.step();
    const double kinetic = simulation.state().velocities_m_s.squaredNorm();
    if (kinetic < before) {
      SimulationState still = simulation.state();
      still.velocities_m_s.setZero();
      still.previous_step_s = 0.0;
      still.previous_positions_m.resize(3, 0);
      still.previous_velocities_m_s.resize(3, 0);
      still.previous_element_multipliers_pa.resize(0);
      still.previous_constraint_multipliers.resize(0);
      still.previous_pressures_pa.resize(0);
      simulation.set_state(still);
    }
    before = kinetic;
  }
}

TEST(Rest, IsTheSameForEveryTimeStepAndSolver) {
  Bar bar;
  bar.length_m = 0.02;
  bar.thickness_m = 0.01;
  bar.cells = {2, 1, 1};
  bar.cable = "compliance_m_n: 1.0e-5";
  Simulation resting = make_bar(bar);
  resting.set_command("upper", 0.95);
  ASSERT_TRUE(resting.solve_equilibrium().converged);

  struct Way {
    SolverOptions::Method method;
    Integrator integrator;
  };
  using Method = SolverOptions::Method;
  for (const Way& way : {Way{Method::newton, Integrator::implicit_euler}, Way{Method::newton, Integrator::bdf2},
                         Way{Method::xpbd, Integrator::implicit_euler}}) {
    for (const double time_step_s : {0.001, 0.01, 0.1}) {
      bar.options.method = way.method;
      bar.options.integrator = way.integrator;
      bar.options.time_step_s = time_step_s;
      bar.options.dynamic_tolerance = bar.options.tolerance;
      // xpbd in substeps of 0.2 ms throughout: of a step of 100 ms it needs 500, with fewer this bar does not
      // rest.
      bar.options.substep_count = time_step_s < 0.005 ? 5 : time_step_s < 0.05 ? 50 : 500;
      Simulation moving = make_bar(bar);
      moving.set_command("upper", 0.95);
      settle_in_time(moving, time_step_s < 0.005 ? 300 : time_step_s < 0.05 ? 60 : 20);
      EXPECT_LT((moving.marker_position(0) - resting.marker_position(0)).norm(), 1e-6)
          << "method " << static_cast<int>(way.method) << ", integrator " << static_cast<int>(way.integrator)
          << ", time step " << time_step_s;
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
