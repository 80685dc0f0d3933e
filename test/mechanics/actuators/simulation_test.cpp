// SPDX-License-Identifier: BSD-3-Clause
// The mechanics as a whole, with the cable as its actuator.
#include "soft_robot_lab/mechanics/simulation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mechanics/simulation/actuator_warnings.h"
#include "mechanics/box_mesh.h"
#include "soft_robot_lab/mechanics/actuators/cable.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

struct Bar {
  double poissons_ratio = 0.499;
  double scale = 1.0;  // lengths; gravity goes down as they go up, so that one shape serves all
  Eigen::Vector3i cells = {8, 2, 2};
  bool quadratic = true;
  std::string cables = "";                                           // settings of two cables' common keys
  std::vector<double> via_m = {0.0, 0.02, 0.04, 0.06, 0.08, 0.095};  // their points along the bar
  SolverOptions options;
};

// The 100 x 20 x 20 mm cantilever of reference R1, clamped at x = 0, with an upper and a lower cable where asked for.
Simulation make_bar(const Bar& bar) {
  const double s = bar.scale;
  Body body(
      box_mesh(s * Eigen::Vector3d(0, -0.01, -0.01), s * Eigen::Vector3d(0.1, 0.01, 0.01), bar.cells, bar.quadratic),
      {264200.0, bar.poissons_ratio, 1070.0});
  body.fix_nodes({-10, -10, -10}, {1e-6 * s, 10, 10}, {true, true, true});
  body.set_gravity({0, -9.81 / s, 0});
  const MeshLocator locator(body.mesh());
  std::vector<std::unique_ptr<Actuator>> actuators;
  if (!bar.cables.empty()) {
    for (const double y : {0.006 * s, -0.006 * s}) {
      std::ostringstream settings;
      settings << "{name: " << (y > 0 ? "upper" : "lower") << ", " << bar.cables << ", sheath_radius_m: " << 0.001 * s
               << ", plug_radius_m: " << 0.003 * s << ", points_m: [";
      for (const double x : bar.via_m) settings << (x > 0 ? ", " : "") << "[" << s * x << ", " << y << ", 0]";
      settings << "]}";
      actuators.push_back(std::make_unique<Cable>());
      actuators.back()->initialise(YamlNode::parse(settings.str(), "bar"), body, locator);
    }
  }
  std::vector<Marker> markers;
  markers.emplace_back("tip", Eigen::Vector3d(0.1 * s, 0, 0), body.mesh(), locator);
  markers.emplace_back("flag", Eigen::Vector3d(0.06 * s, 0.02 * s, 0), body.mesh(), locator);
  return Simulation(std::move(body), std::move(actuators), std::move(markers), bar.options);
}

struct CountingCable : Cable {
  mutable std::vector<double> steps_s;
  void begin_step(const StepStart& start, DriveState& drive) const override {
    steps_s.push_back(start.time_step_s);
    Cable::begin_step(start, drive);
  }
};

TEST(Step, BeginsOnceForTheActuators) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {4, 1, 1}), {264200.0, 0.49, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  std::vector<std::unique_ptr<Actuator>> actuators;
  auto cable = std::make_unique<CountingCable>();
  const CountingCable& counting = *cable;
  actuators.push_back(std::move(cable));
  actuators.back()->initialise(YamlNode::parse("{name: cable, points_m: [[0, 0.005, 0], [0.095, 0.005, 0]]}", "bar"),
                               body, MeshLocator(body.mesh()));
  Simulation simulation(std::move(body), std::move(actuators), {}, {});
  simulation.set_command("cable", 0.95);
  counting.steps_s.clear();
  const SolveReport report = simulation.step();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_EQ(counting.steps_s, std::vector<double>{simulation.options().time_step_s});
}

TEST(Equilibrium, NeedsFewIterationsHoweverIncompressible) {
  for (const double poissons_ratio : {0.0, 0.3, 0.45, 0.499, 0.4999, 0.499999}) {
    Bar bar;
    bar.poissons_ratio = poissons_ratio;
    Simulation simulation = make_bar(bar);
    const SolveReport report = simulation.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    EXPECT_LE(report.iterations, 8) << poissons_ratio;
    EXPECT_EQ(report.inverted_elements, 0);
    // The reference's tip sags 14.62 mm at 0.499 and 0.13 mm more at 0.45; below that the clamp holds the section less.
    EXPECT_NEAR(simulation.marker_position(0).y(), -0.01462, (poissons_ratio < 0.4 ? 0.06 : 0.03) * 0.01462)
        << poissons_ratio;
  }
}

TEST(Equilibrium, LinearElementsAreTooStiff) {
  Bar bar;
  bar.quadratic = false;
  Simulation simulation = make_bar(bar);
  EXPECT_TRUE(simulation.solve_equilibrium().converged);
  EXPECT_GT(simulation.marker_position(0).y(), -0.010);
}

TEST(Equilibrium, DoesNotDependOnScale) {
  Bar bar;
  bar.cables = "compliance_m_n: 0";
  Simulation simulation = make_bar(bar);
  simulation.set_command("upper", 0.9);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  for (const double scale : {0.1, 10.0}) {
    bar.scale = scale;
    Simulation other = make_bar(bar);
    other.set_command("upper", 0.9);
    const SolveReport report = other.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    EXPECT_LT((other.marker_position(0) / scale - simulation.marker_position(0)).norm(), 1e-7);
  }
}

TEST(Equilibrium, CableReachesItsLengthAndNeverPushes) {
  Bar bar;
  bar.cables = "compliance_m_n: 0";
  Simulation simulation = make_bar(bar);
  simulation.set_command("upper", 0.8);
  simulation.set_command("lower", 1.2);
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  const ActuatorReading upper = simulation.actuator_state(0), lower = simulation.actuator_state(1);
  EXPECT_NEAR(*upper.length_m, 0.8 * *upper.rest_length_m, 1e-7);
  EXPECT_GT(*upper.tension_n, 1.0);
  EXPECT_EQ(*lower.tension_n, 0.0);
  EXPECT_LT(*lower.length_m, 1.2 * *lower.rest_length_m);
}

TEST(Equilibrium, CompliantCableStretchesByItsTension) {
  Bar bar;
  bar.cables = "compliance_m_n: 1.0e-3";
  Simulation simulation = make_bar(bar);
  simulation.set_command("upper", 0.9);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const ActuatorReading upper = simulation.actuator_state(0);
  EXPECT_NEAR(*upper.length_m, 0.9 * *upper.rest_length_m + 1.0e-3 * *upper.tension_n, 1e-7);
}

TEST(Equilibrium, SensitivitiesAgreeWithDifferences) {
  for (const std::string drive : {"contraction", "length_m", "tension_n"}) {
    Bar bar;
    bar.cables = "compliance_m_n: 1.0e-5, command: " + drive;
    bar.options.tolerance = 1e-10;
    Simulation simulation = make_bar(bar);
    const bool tension = drive == "tension_n";
    const double rest = *simulation.actuator_state(0).rest_length_m;
    const double unit = tension ? 1.0 : drive == "length_m" ? rest : 1.0;
    const Eigen::Vector2d at = tension ? Eigen::Vector2d(4.0, 2.0) : Eigen::Vector2d(0.88 * unit, 0.95 * unit);
    const auto solve = [&](const Eigen::Vector2d& commands) {
      simulation.set_command("upper", commands[0]);
      simulation.set_command("lower", commands[1]);
      const SolveReport report = simulation.solve_equilibrium();
      EXPECT_TRUE(report.converged) << report.message;
      Eigen::VectorXd markers(6);
      markers << simulation.marker_position(0), simulation.marker_position(1);
      return markers;
    };
    solve(at);
    ASSERT_GT(*simulation.actuator_state(0).tension_n, 0.0);
    ASSERT_GT(*simulation.actuator_state(1).tension_n, 0.0);
    const Eigen::MatrixXd exact = simulation.marker_sensitivities();
    const double h = 1e-5 * unit;
    for (int i = 0; i < 2; ++i) {
      const Eigen::VectorXd difference =
          (solve(at + h * Eigen::Vector2d::Unit(i)) - solve(at - h * Eigen::Vector2d::Unit(i))) / (2.0 * h);
      EXPECT_LT((exact.col(i) - difference).norm(), 2e-3 * difference.norm()) << drive << " " << i;
    }
  }
}

TEST(Equilibrium, BucklesUnderItsOwnCables) {
  // Straight from end to end and pulled alike, both cables press the bar until it gives way to the side; there the
  // stiffness of body and tensions alone is not positive, the cables' lengths hold it.
  Bar bar;
  bar.cables = "compliance_m_n: 0";
  bar.via_m = {0.0, 0.095};
  bar.options.tolerance = 1e-9;
  Simulation simulation = make_bar(bar);
  const auto solve = [&](double upper) {
    simulation.set_command("upper", upper);
    simulation.set_command("lower", 0.8);
    const SolveReport report = simulation.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    return simulation.marker_position(0);
  };
  const Eigen::Vector3d tip = solve(0.8);
  EXPECT_GT(std::abs(tip.z()), 0.005);
  const Eigen::Vector3d exact = simulation.marker_sensitivities().block<3, 1>(0, 0);
  const Eigen::Vector3d difference = (solve(0.8 + 1e-5) - solve(0.8 - 1e-5)) / 2e-5;
  EXPECT_LT((exact - difference).norm(), 2e-3 * difference.norm());
}

TEST(Equilibrium, FollowsABuckledBodyWithoutLosingItsWay) {
  // Where the stiffness of body and tensions has a negative eigenvalue a step was taken for one uphill, and the command
  // change cut into 64.
  Bar bar;
  bar.cables = "compliance_m_n: 0";
  bar.via_m = {0.0, 0.095};
  Simulation simulation = make_bar(bar);
  const auto solve = [&](double upper, double lower) {
    simulation.set_command("upper", upper);
    simulation.set_command("lower", lower);
    return simulation.solve_equilibrium();
  };
  ASSERT_TRUE(solve(0.8, 0.8).converged);
  ASSERT_TRUE(solve(0.72, 0.84).converged);
  for (double turn = 0.0; turn < 6.2; turn += 0.4) {
    const SolveReport report = solve(0.72 + 0.004 * std::cos(turn), 0.84 + 0.004 * std::sin(turn));
    EXPECT_TRUE(report.converged) << report.message;
    EXPECT_EQ(report.rejected_steps, 0) << turn;
    EXPECT_LE(report.iterations, 5) << turn;
  }
}

TEST(Equilibrium, FollowsALongPullWithoutCuttingSteps) {
  // The bar bends by about a right angle. Straight steps, which stretch what they turn, were cut three times there.
  for (const bool quadratic : {true, false}) {
    Bar bar;
    bar.quadratic = quadratic;
    bar.cables = "compliance_m_n: 0";
    Simulation simulation = make_bar(bar);
    ASSERT_TRUE(simulation.solve_equilibrium().converged);
    simulation.set_command("upper", 0.8);
    simulation.set_command("lower", 1.2);
    const SolveReport report = simulation.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    EXPECT_EQ(report.rejected_steps, 0) << quadratic;
    EXPECT_LE(report.factorisations, 6) << quadratic;
  }
}

TEST(Equilibrium, IsReachedByTheLastFactorFromNearby) {
  Bar bar;
  bar.cables = "compliance_m_n: 0";
  Simulation simulation = make_bar(bar);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  simulation.set_command("upper", 0.97);
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged);
  EXPECT_GT(report.iterations, report.factorisations);
  EXPECT_LE(report.factorisations, 2);
}

TEST(Equilibrium, SlackCableHasNoSensitivity) {
  Bar bar;
  bar.cables = "compliance_m_n: 0";
  Simulation simulation = make_bar(bar);
  simulation.set_command("upper", 0.9);
  simulation.set_command("lower", 1.3);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  EXPECT_EQ(simulation.marker_sensitivities().col(1).norm(), 0.0);
  EXPECT_GT(simulation.marker_sensitivities().col(0).norm(), 0.0);
}

TEST(Dynamics, SettlesAtTheEquilibrium) {
  Bar bar;
  bar.cables = "compliance_m_n: 1.0e-5, pull_speed_m_s: 0.02";
  Simulation moving = make_bar(bar), resting = make_bar(bar);
  moving.set_command("upper", 0.85);
  resting.set_command("upper", 0.85);
  for (int i = 0; i < 480; ++i) ASSERT_TRUE(moving.step().converged) << i;
  ASSERT_TRUE(resting.solve_equilibrium().converged);
  EXPECT_NEAR(moving.state().time_s, 8.0, 1e-9);
  EXPECT_LT((moving.marker_position(0) - resting.marker_position(0)).norm(), 2e-5);
}

TEST(Dynamics, FallsFreelyAtFirst) {
  Bar bar;
  bar.options.time_step_s = 1e-4;
  Simulation simulation = make_bar(bar);
  for (int i = 0; i < 50; ++i) simulation.step();
  // Implicit Euler adds g h / 2 per unit of time to the path.
  EXPECT_NEAR(simulation.marker_position(0).y(), -0.5 * 9.81 * 0.005 * 0.0051, 2e-7);
}

class EitherIntegrator : public testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(Dynamics, EitherIntegrator, testing::Values(Integrator::implicit_euler, Integrator::bdf2),
                         [](const auto& param) { return param.param == Integrator::bdf2 ? "bdf2" : "implicit_euler"; });

TEST_P(EitherIntegrator, RepeatsToTheLastBit) {
  Bar bar;
  bar.options.integrator = GetParam();
  bar.cables = "compliance_m_n: 1.0e-5, pull_speed_m_s: 0.02";
  Simulation first = make_bar(bar), second = make_bar(bar);
  SimulationState middle;
  for (int i = 0; i < 40; ++i) {
    first.set_command("upper", 0.9);
    first.step();
    if (i == 19) middle = first.state();
  }
  second.set_state(middle);
  for (int i = 20; i < 40; ++i) second.step();
  EXPECT_EQ((first.state().positions_m - second.state().positions_m).norm(), 0.0);
  EXPECT_EQ(first.state().time_s, second.state().time_s);
}

// As a search starts its trials: a solver keeps the factors of some states, and one that comes anew to a state makes
// it.
TEST(Equilibrium, FromASavedStateIsTheSameInAnySolverToTheLastBit) {
  Bar bar;
  bar.cells = {4, 1, 1};
  bar.cables = "compliance_m_n: 1.0e-5";
  Simulation searching = make_bar(bar);
  std::vector<SimulationState> saved;
  for (int k = 0; k < 13; ++k) {  // more than it keeps
    searching.set_command("upper", 1.0 - 0.01 * k);
    searching.set_command("lower", 1.0 - 0.003 * k);
    ASSERT_TRUE(searching.solve_equilibrium().converged);
    saved.push_back(searching.state());
  }
  for (const std::size_t from : {12u, 3u, 7u, 3u, 0u, 12u, 11u, 7u}) {
    searching.set_state(saved[from]);
    Simulation anew(searching.model());
    anew.set_state(saved[from]);
    for (Simulation* simulation : {&searching, &anew}) {
      simulation->set_command("upper", 0.931 + 0.001 * static_cast<double>(from));
      ASSERT_TRUE(simulation->solve_equilibrium().converged);
    }
    EXPECT_TRUE(searching.state().positions_m == anew.state().positions_m) << from;
    EXPECT_TRUE(searching.marker_sensitivities() == anew.marker_sensitivities()) << from;
  }
}

TEST_P(EitherIntegrator, SurvivesASuddenStrongPull) {
  Bar bar;
  bar.cables = "compliance_m_n: 0";
  bar.options.integrator = GetParam();
  Simulation simulation = make_bar(bar);
  simulation.set_command("upper", 0.7);
  for (int i = 0; i < 60; ++i) {
    const SolveReport report = simulation.step();
    ASSERT_TRUE(report.converged) << i << ": " << report.message;
    ASSERT_TRUE(simulation.state().positions_m.allFinite());
  }
  EXPECT_NEAR(*simulation.actuator_state(0).length_m / *simulation.actuator_state(0).rest_length_m, 0.7, 1e-3);
}

TEST_P(EitherIntegrator, SleepsAtRestAndWakesOnACommandOrAnotherState) {
  Bar bar;
  bar.cells = {4, 1, 1};
  bar.cables = "compliance_m_n: 1.0e-5";
  bar.options.integrator = GetParam();
  Simulation simulation = make_bar(bar);
  simulation.set_command("upper", 0.95);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const Eigen::Vector3d rest = simulation.marker_position(0);
  for (int i = 0; i < 30 && !simulation.state().rest_residual; ++i) ASSERT_TRUE(simulation.step().converged);
  ASSERT_TRUE(simulation.state().rest_residual);
  EXPECT_LT((simulation.marker_position(0) - rest).norm(), 1e-6 * 0.1);

  const SimulationState asleep = simulation.state();
  const SolveReport report = simulation.step();
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_LE(report.residual, bar.options.tolerance);
  EXPECT_EQ(simulation.state().positions_m, asleep.positions_m);
  EXPECT_NEAR(simulation.state().time_s, asleep.time_s + bar.options.time_step_s, 1e-12);

  simulation.set_state(asleep);  // as it was: sleeps on
  EXPECT_EQ(simulation.step().iterations, 0);
  for (const char* change : {"velocity", "position", "tension"}) {
    SimulationState changed = asleep;
    if (change[0] == 'v') changed.velocities_m_s(1, changed.velocities_m_s.cols() - 1) = 0.01;
    if (change[0] == 'p') changed.positions_m(1, changed.positions_m.cols() - 1) += 1e-4;
    if (change[0] == 't') changed.constraint_multipliers[0] *= 1.01;
    simulation.set_state(changed);
    EXPECT_GT(simulation.step().iterations, 0) << change;
  }
  simulation.set_state(asleep);
  simulation.set_command("lower", 0.9);
  for (int i = 0; i < 30; ++i) EXPECT_TRUE(simulation.step().converged);
  EXPECT_LT(simulation.marker_position(0).y(), rest.y() - 1e-3);
}

TEST(Simulation, TellsOfACommandThatTheBodyDoesNotLetItReach) {
  Bar bar;
  bar.cells = {4, 1, 1};
  bar.cables = "compliance_m_n: 1.0e-2";  // 10 mm of stretch a newton
  Simulation simulation = make_bar(bar);
  simulation.set_command("upper", 0.7);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_EQ(report.warnings.size(), 1u);
  const SolveWarning& warning = report.warnings[0];
  EXPECT_EQ(warning.kind, "command_not_reached");
  EXPECT_EQ(warning.actuator, "upper");
  const ActuatorReading reading = simulation.actuator_state(0);
  EXPECT_NEAR(*warning.commanded, 0.7 * *reading.rest_length_m, 1e-12);
  EXPECT_EQ(*warning.reached, *reading.length_m);
  EXPECT_NEAR(warning.size, 1.0e-2 * *reading.tension_n, 1e-6);
  EXPECT_GT(warning.size, 0.001);
}

TEST(Simulation, TellsOfASlackCableThatWasToPull) {
  Bar bar;
  bar.cells = {4, 1, 1};
  bar.cables = "compliance_m_n: 0";
  bar.via_m = {0.0, 0.095};
  Simulation simulation = make_bar(bar);
  simulation.set_command("lower", 0.999);
  simulation.set_command("upper", 1.2);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);  // its weight bends the bar to the lower side by more
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0].kind, "slack");
  EXPECT_EQ(report.warnings[0].actuator, "lower");
  EXPECT_LT(report.warnings[0].size, -0.01 * 0.095);
}

TEST(Simulation, TellsOfATensionBeyondAnySense) {
  Simulation simulation = make_bar(Bar{});
  const double most_n = 264200.0 * std::pow(simulation.body().size_m(), 2) / 50.0;
  ASSERT_NEAR(most_n, 55.0, 5.0);
  ActuatorReading reading;
  reading.name = "upper";
  reading.tension_n = 0.99 * most_n;
  EXPECT_TRUE(actuator_warnings(reading, simulation.body()).empty());
  reading.tension_n = 1.01 * most_n;
  const std::vector<SolveWarning> warnings = actuator_warnings(reading, simulation.body());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].kind, "excessive_tension");
  EXPECT_EQ(warnings[0].actuator, "upper");
  EXPECT_EQ(warnings[0].size, *reading.tension_n);
  EXPECT_EQ(warnings[0].unit, "N");
}

TEST(Simulation, TellsWhereTheResidualIs) {
  Bar bar;
  bar.cells = {4, 1, 1};
  bar.options.max_iterations = 1;
  bar.options.dynamic_tolerance = 1e-12;
  Simulation simulation = make_bar(bar);
  SimulationState state = simulation.state();
  for (Eigen::Index i = 0; i < state.positions_m.cols(); ++i)
    if (state.positions_m(0, i) > 0.074) state.positions_m(0, i) = 0.14 - state.positions_m(0, i);  // folded back
  simulation.set_state(state);
  const SolveReport report = simulation.step();
  EXPECT_FALSE(report.converged);
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_EQ(report.warnings[0].kind, "residual_not_met");
  EXPECT_EQ(report.warnings[0].size, report.residual);
  ASSERT_TRUE(report.warnings[0].rest_position_m);
  EXPECT_NE(report.message, "");
}

TEST(Simulation, RefusesWhatCannotBeSimulated) {
  const auto body = [] { return Body(box_mesh({0, 0, 0}, {0.02, 0.01, 0.01}, {2, 1, 1}), Material{}); };
  EXPECT_THROW(Simulation(body(), {}, {}, {}), std::invalid_argument);  // nothing holds it

  SolverOptions options;
  struct Case {
    double SolverOptions::*field;
    double value;
  };
  for (const Case& wrong : {Case{&SolverOptions::time_step_s, 0.0}, Case{&SolverOptions::time_step_s, 1.5},
                            Case{&SolverOptions::tolerance, -1.0}, Case{&SolverOptions::tolerance, std::nan("")},
                            Case{&SolverOptions::dynamic_tolerance, 1.0}}) {
    SolverOptions bad;
    bad.*wrong.field = wrong.value;
    EXPECT_THROW(bad.validate(), std::invalid_argument);
  }
  options.max_iterations = 0;
  EXPECT_THROW(options.validate(), std::invalid_argument);
}

TEST(Simulation, NamesWhatItDoesNotKnow) {
  Bar bar;
  bar.cables = "compliance_m_n: 0";
  Simulation simulation = make_bar(bar);
  try {
    simulation.set_command("middle", 0.9);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "unknown actuator 'middle'; known: upper, lower");
  }
  EXPECT_THROW(simulation.marker_index("nose"), std::invalid_argument);
  SimulationState state = simulation.state();
  state.positions_m(0, 0) = std::nan("");
  EXPECT_THROW(simulation.set_state(state), std::invalid_argument);
  EXPECT_TRUE(simulation.state().positions_m.allFinite());
}

}  // namespace
}  // namespace soft_robot_lab
