// SPDX-License-Identifier: BSD-3-Clause
// The thesis's cable of springs, implicit and explicit; and what all models share.
#include <cmath>

#include <gtest/gtest.h>

#include "test_bar.h"

namespace soft_robot_lab {
namespace {

std::string refusal(const std::string& settings) {
  try {
    hanging_bar(settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(CableSprings, EachPullsByItsOwnStretch) {
  Simulation simulation = hanging_bar("model: springs, stiffness_n_m: 2000");
  simulation.set_command("cable", 0.9);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const ActuatorReading at = simulation.actuator_state(0);
  ASSERT_EQ(at.span_tensions_n.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    const double rest = i < 4 ? 0.02 : 0.015, length = (at.path_m[i + 1] - at.path_m[i]).norm();
    EXPECT_NEAR(at.span_tensions_n[i], 2000.0 * (length - 0.9 * rest), 1e-5);
  }
}

TEST(CableSprings, ExplicitOnesRestWhereImplicitOnesDo) {
  Simulation implicit = hanging_bar("model: springs, stiffness_n_m: 300"),
             explicit_ = hanging_bar("model: springs, stiffness_n_m: 300, integration: explicit");
  implicit.set_command("cable", 0.9);
  explicit_.set_command("cable", 0.9);
  ASSERT_TRUE(implicit.solve_equilibrium().converged);
  ASSERT_TRUE(explicit_.solve_equilibrium().converged);
  EXPECT_LT((implicit.marker_position(0) - explicit_.marker_position(0)).norm(), 1e-9);
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(explicit_.step().converged);
  EXPECT_LT((implicit.marker_position(0) - explicit_.marker_position(0)).norm(), 1e-6);
  EXPECT_NEAR(*implicit.actuator_state(0).tension_n, *explicit_.actuator_state(0).tension_n, 1e-3);
}

// How much the tip still moves from step to step, half a second after the pull.
double unrest_m(const std::string& integration, double stiffness_n_m) {
  Simulation simulation =
      hanging_bar("model: springs, pull_speed_m_s: 0.02, stiffness_n_m: " + std::to_string(stiffness_n_m) +
                  ", integration: " + integration);
  simulation.set_command("cable", 0.95);
  double unrest = 0.0;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d before = simulation.marker_position(0);
    simulation.step();
    if (i >= 35) unrest = std::max(unrest, (simulation.marker_position(0) - before).norm());
  }
  return unrest;
}

TEST(CableSprings, StiffOnesTrembleOnlyWhereExplicit) {
  EXPECT_LT(unrest_m("explicit", 100), 1e-4);
  EXPECT_GT(unrest_m("explicit", 2500), 3e-4);
  EXPECT_LT(unrest_m("implicit", 25000), 1e-5);
}

TEST(CableSprings, DampersSlowTheMotionAndLeaveTheRestState) {
  Simulation free = hanging_bar("model: springs, stiffness_n_m: 500"),
             damped = hanging_bar("model: springs, stiffness_n_m: 500, damping_n_s_m: 300");
  for (Simulation* simulation : {&free, &damped}) {
    simulation->set_command("cable", 0.9);
    for (int i = 0; i < 4; ++i) ASSERT_TRUE(simulation->step().converged);
  }
  EXPECT_LT(damped.marker_position(0).x(), 0.7 * free.marker_position(0).x());
  for (Simulation* simulation : {&free, &damped}) ASSERT_TRUE(simulation->solve_equilibrium().converged);
  EXPECT_LT((free.marker_position(0) - damped.marker_position(0)).norm(), 1e-8);
}

TEST(CableSprings, PseudoInverseMultipliesTheForce) {
  const std::string settings = "model: springs, stiffness_n_m: 20, integration: explicit, coupling: ";
  Simulation plain = hanging_bar(settings + "transpose"), multiplied = hanging_bar(settings + "pseudo_inverse");
  for (Simulation* simulation : {&plain, &multiplied}) {
    simulation->set_command("cable", 0.9);
    ASSERT_TRUE(simulation->step().converged);
  }
  EXPECT_GT(multiplied.marker_position(0).x(), 2.0 * plain.marker_position(0).x());
  EXPECT_THROW(multiplied.solve_equilibrium(), std::invalid_argument);
  EXPECT_NE(refusal("model: springs, stiffness_n_m: 20, coupling: pseudo_inverse").find("needs integration: explicit"),
            std::string::npos);
}

TEST(CableModels, SensitivitiesAgreeWithDifferences) {
  SolverOptions options;
  options.tolerance = 1e-10;
  for (const std::string model :
       {"compliance_m_n: 0", "compliance_m_n: 1.0e-3", "model: springs, stiffness_n_m: 3000",
        "model: springs, stiffness_n_m: 3000, integration: explicit", "model: friction, friction_coefficient: 0.3",
        "model: friction, friction_coefficient: 0.3, compliance_m_n: 1.0e-3"}) {
    SCOPED_TRACE(model);
    Simulation simulation = hanging_bar(model, options);
    const auto tip_at = [&](double command) {
      simulation.set_command("cable", command);
      EXPECT_TRUE(simulation.solve_equilibrium().converged);
      return simulation.marker_position(0);
    };
    tip_at(0.92);
    const double step = 1e-5;  // onwards, as friction's derivative means it
    const Eigen::Vector3d before = tip_at(0.9 + step), at = tip_at(0.9);
    const Eigen::Vector3d exact = simulation.marker_sensitivities();
    const Eigen::Vector3d after = tip_at(0.9 - step);
    EXPECT_LT(((before - after) / (2 * step) - exact).norm(), 2e-3 * exact.norm())
        << at.transpose() << " | " << exact.transpose() << " | " << ((before - after) / (2 * step)).transpose();
  }
}

TEST(CableModels, DoNotDependOnScale) {
  // Stiffness goes with E times length, tension with E times length squared.
  const auto tip = [](const std::string& settings, double scale) {
    Simulation simulation = hanging_bar(settings, {}, scale);
    simulation.set_command("cable", 0.9);
    const SolveReport report = simulation.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    return Eigen::Vector3d(simulation.marker_position(0) / scale);
  };
  for (const double scale : {0.1, 10.0}) {
    const std::string friction = "model: friction, friction_coefficient: 0.3, compliance_m_n: 0";
    EXPECT_LT((tip(friction, scale) - tip(friction, 1.0)).norm(), 1e-7);
    EXPECT_LT((tip("model: springs, stiffness_n_m: " + std::to_string(3000 * scale), scale) -
               tip("model: springs, stiffness_n_m: 3000", 1.0))
                  .norm(),
              1e-7);
  }
}

TEST(CableModels, ReportStretchSlackAndPretension) {
  Simulation simulation = hanging_bar("compliance_m_n: 1.0e-3, pretension_n: 0.5");
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const ActuatorReading at_rest = simulation.actuator_state(0);
  EXPECT_EQ(*at_rest.pretension_n, 0.5);
  EXPECT_NEAR(*at_rest.stretch_m, 1.0e-3 * *at_rest.tension_n, 1e-8);
  EXPECT_EQ(*at_rest.slack_m, 0.0);
  simulation.set_command("cable", 1.2);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const ActuatorReading slack = simulation.actuator_state(0);
  EXPECT_EQ(*slack.tension_n, 0.0);
  EXPECT_NEAR(*slack.slack_m, 1.2 * 0.095 - 0.0005 - *slack.length_m, 1e-9);
  EXPECT_EQ(*slack.stretch_m, 0.0);
}

TEST(CableModels, DriveFollowsTheSteppersLaw) {
  // x mm take 50.4 x + 19.9 ms.
  Simulation simulation = hanging_bar("pull_speed_m_s: 0.01984127, pull_delay_s: 0.0199");
  const Actuator& cable = *simulation.actuators()[0];
  DriveState drive = cable.rest_state();
  const double rest = 0.095, pull = 0.005, needed_s = 0.0504 * 5.0 + 0.0199;
  cable.set_command(1.0 - pull / rest, drive);
  cable.advance(0.01, drive);
  EXPECT_EQ(drive.actuated_command, 1.0);
  cable.advance(needed_s - 0.01 - 1e-4, drive);
  EXPECT_GT(drive.actuated_command, drive.command);
  cable.advance(2e-4, drive);
  EXPECT_EQ(drive.actuated_command, drive.command);
}

TEST(CableModels, RefuseBadSettings) {
  struct Case {
    std::string settings, words;
  };
  const Case cases[] = {
      {"model: springs", "stiffness_n_m"},
      {"model: springs, stiffness_n_m: 0", "(0, inf)"},
      {"model: springs, stiffness_n_m: 10, damping_n_s_m: -1", "damping_n_s_m"},
      {"model: springs, stiffness_n_m: 10, integration: leapfrog", "integration"},
      {"model: friction", "friction_coefficient"},
      {"model: friction, friction_coefficient: -0.1", "friction_coefficient"},
      {"model: friction, friction_coefficient: 3", "[0, 2]"},
      {"compliance_m_n: 0, pretension_n: 1", "pretension_n"},
      {"pull_delay_s: -1", "pull_delay_s"},
  };
  for (const Case& wrong : cases)
    EXPECT_NE(refusal(wrong.settings).find(wrong.words), std::string::npos) << refusal(wrong.settings);
}

}  // namespace
}  // namespace soft_robot_lab
