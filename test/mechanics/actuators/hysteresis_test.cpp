// SPDX-License-Identifier: BSD-3-Clause
// The loop of force over length in a cyclic pull.
#include <gtest/gtest.h>

#include <cmath>

#include "mechanics/box_mesh.h"
#include "soft_robot_lab/mechanics/actuators/cable.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

constexpr double kRelaxationTime_s = 0.1;
constexpr int kStepsPerCycle = 40;

// A block with a cable along its axis, and hardly any mass.
Simulation block(double ratio, const SolverOptions& options) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.03, 0.01, 0.01}, {2, 2, 2}), {264200.0, 0.49, 1.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  body.set_viscosity({0.0, 0.0, ratio, kRelaxationTime_s});
  const MeshLocator locator(body.mesh());
  std::vector<std::unique_ptr<Actuator>> cables;
  cables.push_back(std::make_unique<Cable>());
  cables[0]->initialise(YamlNode::parse("{name: axis, compliance_m_n: 0, plug_radius_m: 0.009, "
                                        "points_m: [[0, 0, 0], [0.03, 0, 0]]}",
                                        "block"),
                        body, locator);
  return Simulation(std::move(body), std::move(cables), {}, options);
}

// Tension per shortening at rest, about a shortening by 3 %.
double stiffness_at_rest_n_m() {
  Simulation simulation = block(0.0, {});
  double tensions_n[2], lengths_m[2];
  for (const int i : {0, 1}) {
    simulation.set_command("axis", i == 0 ? 0.95 : 0.99);
    EXPECT_TRUE(simulation.solve_equilibrium().converged);
    tensions_n[i] = *simulation.actuator_state(0).tension_n;
    lengths_m[i] = *simulation.actuator_state(0).length_m;
  }
  return (tensions_n[0] - tensions_n[1]) / (lengths_m[1] - lengths_m[0]);
}

// Work lost in the second cycle of a block that is shortened by 1 to 5 %, about a rest at 3 %.
double lost_work_j(double ratio, double frequency_times_relaxation) {
  SolverOptions options;
  options.integrator = Integrator::bdf2;
  options.dynamic_tolerance = 1e-6;
  options.time_step_s = 2.0 * M_PI * kRelaxationTime_s / frequency_times_relaxation / kStepsPerCycle;
  Simulation simulation = block(ratio, options);
  simulation.set_command("axis", 0.97);
  EXPECT_TRUE(simulation.solve_equilibrium().converged);
  double lost = 0.0, tension = 0.0, length = 0.0;
  for (int step = 1; step <= 2 * kStepsPerCycle; ++step) {
    const double phase = 2.0 * M_PI * step / kStepsPerCycle;
    simulation.set_command("axis", 0.97 + 0.02 * std::sin(phase));
    const SolveReport report = simulation.step();
    EXPECT_TRUE(report.converged) << report.message;
    const ActuatorReading cable = simulation.actuator_state(0);
    EXPECT_GT(*cable.tension_n, 0.0);
    if (step > kStepsPerCycle) lost -= 0.5 * (tension + *cable.tension_n) * (*cable.length_m - length);
    tension = *cable.tension_n;
    length = *cable.length_m;
  }
  return lost;
}

// To first order the loop's area goes as ratio * x / (1 + x^2) with x frequency times relaxation time.
TEST(Hysteresis, LosesWorkInACycleMostWhereItsTimeIsThatOfTheRelaxation) {
  const double most = lost_work_j(0.2, 1.0);
  EXPECT_GT(most, 1e-5);
  EXPECT_NEAR(lost_work_j(0.02, 1.0), 0.1 * most, 0.01 * most);
  EXPECT_LT(std::abs(lost_work_j(0.0, 1.0)), 1e-3 * most);
  const double slow = lost_work_j(0.2, 0.05), fast = lost_work_j(0.2, 20.0);
  EXPECT_NEAR(slow, 0.1 * most, 0.03 * most);
  EXPECT_NEAR(fast, 0.1 * most, 0.03 * most);
}

// Prony's branch is a spring of ratio times the stiffness at rest in series with a damper, so that a cycle of amplitude
// A loses pi A^2 ratio k x / (1 + x^2). The stiffness k at rest is that of a nearly incompressible body, all of it
// shear.
TEST(Hysteresis, LosesTheWorkThatPronysBranchSays) {
  const double amplitude_m = 0.02 * 0.03;
  for (const double x : {0.5, 1.0, 2.0}) {
    const double lost_j = M_PI * amplitude_m * amplitude_m * 0.1 * stiffness_at_rest_n_m() * x / (1.0 + x * x);
    EXPECT_NEAR(lost_work_j(0.1, x), lost_j, 0.1 * lost_j) << x;
  }
}

}  // namespace
}  // namespace soft_robot_lab
