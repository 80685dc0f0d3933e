// SPDX-License-Identifier: BSD-3-Clause
// Solves that are ended from without: they leave no trace.
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test_bar.h"

namespace soft_robot_lab {
namespace {

using Solve = std::function<SolveReport(Simulation&)>;

SolveReport rest(Simulation& simulation) { return simulation.solve_equilibrium(); }
SolveReport step(Simulation& simulation) { return simulation.step(); }

struct Case {
  std::string what;
  SolverOptions options;
  Solve solve;
  bool tangled = false, ledger = false;
};

SolverOptions solved_by(SolverOptions::Method method, Integrator integrator = Integrator::implicit_euler) {
  SolverOptions options;
  options.method = method;
  options.integrator = integrator;
  return options;
}

// In motion, with a new command; tangled: all free nodes in one place.
Simulation start_of(const Case& of) {
  Simulation simulation = hanging_bar("friction_coefficient: 0", of.options);
  if (of.ledger) simulation.keep_energy_ledger();
  for (int i = 0; i < 2; ++i) simulation.step();
  simulation.set_command("cable", 0.9);
  if (!of.tangled) return simulation;
  SimulationState state = simulation.state();
  for (Eigen::Index node = 0; node < state.positions_m.cols(); ++node)
    if (!simulation.body().fixed().col(node).any()) state.positions_m.col(node) << 0.0, -0.05, 0.0;
  simulation.set_state(state);
  return simulation;
}

std::vector<Case> cases() {
  const SolverOptions newton = solved_by(SolverOptions::Method::newton), xpbd = solved_by(SolverOptions::Method::xpbd);
  return {{"rest", newton, rest},
          {"rest from a tangle", newton, rest, true},
          {"step", newton, step},
          {"step of bdf2", solved_by(newton.method, Integrator::bdf2), step},
          {"step of tr_bdf2 with a ledger", solved_by(newton.method, Integrator::tr_bdf2), step, false, true},
          {"step from a tangle", newton, step, true},
          {"step of xpbd", xpbd, step},
          {"rest by xpbd", xpbd, rest}};
}

TEST(Interrupt, EndsAnySolveAtAnyPlaceAndGivesBackTheStateFromBefore) {
  for (const Case& of : cases()) {
    SCOPED_TRACE(of.what);
    Simulation whole = start_of(of);
    int asked = 0;
    whole.set_interrupt([&] { return ++asked, false; });
    const SolveReport expected = of.solve(whole);
    EXPECT_FALSE(expected.interrupted);
    ASSERT_GT(asked, expected.iterations);  // at least once in each of its iterations
    for (const int at : {1, asked / 2, asked}) {
      Simulation cut = start_of(of);
      const SimulationState before = cut.state();
      int until = at;
      cut.set_interrupt([&] { return --until <= 0; });
      const SolveReport report = of.solve(cut);
      EXPECT_TRUE(report.interrupted && !report.converged);
      EXPECT_EQ(report.message, "interrupted");
      EXPECT_EQ(until, 0) << "it went on after it was asked to end";
      EXPECT_TRUE(cut.state() == before) << "at ask " << at << " of " << asked;
      cut.set_interrupt({});
      EXPECT_EQ(of.solve(cut).converged, expected.converged);
      EXPECT_TRUE(cut.state() == whole.state()) << "at ask " << at << " of " << asked;
    }
  }
}

TEST(Interrupt, IsAskedOnlyWhileSomethingIsSolved) {
  Simulation simulation = start_of(cases().front());
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  simulation.set_interrupt([] { return true; });
  const SimulationState state = simulation.state();
  simulation.reaction_forces_n();
  simulation.marker_sensitivities();
  simulation.set_state(state);
  EXPECT_TRUE(simulation.state() == state);
}

TEST(Interrupt, ComesOfTheLimitOfTimeToo) {
  Case of = cases().front();
  of.options.time_limit_s = 1e-9;
  Simulation simulation = hanging_bar("friction_coefficient: 0", of.options);
  const SolveReport report = simulation.step();
  EXPECT_TRUE(report.interrupted && !report.converged);
  EXPECT_NE(report.message.find("solver.time_limit_s = 1e-09 s"), std::string::npos) << report.message;
  EXPECT_EQ(simulation.state().time_s, 0.0);
  of.options.time_limit_s = 0.0;
  EXPECT_THROW(of.options.validate(), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
