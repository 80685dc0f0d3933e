// SPDX-License-Identifier: BSD-3-Clause
// The chart of stability on a small body: the default solver must not fail, and nothing may be other than finite.
#include "study/charts/stability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace soft_robot_lab {
namespace {

StabilityBench make_bench() {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return {options, std::string(SOFT_ROBOT_LAB_SOURCE) + "/config"};
}

// The quick chart's bodies that cost least: one with cables, one with a chamber.
std::vector<StabilityBody> small_bodies() {
  std::vector<StabilityBody> small;
  for (const StabilityBody& body : stability_bodies(true))
    if (body.name == "cantilever" || body.name == "cuboid") small.push_back(body);
  return small;
}

TEST(Stability, DefaultSolverSurvivesOrRecoversEverywhere) {
  StabilityBench bench = make_bench();
  int cells = 0;
  for (const StabilityBody& body : small_bodies()) {
    for (const StabilityMethod& method : stability_methods()) {
      for (const HardCase& hard_case : hard_cases(true)) {
        const bool other_integrator = !method.solver_overrides.empty();  // in safety_net_test
        if (!method.ours || other_integrator || !fits(body, method, hard_case)) continue;
        const StabilityCell cell = bench.run(body, method, hard_case);
        EXPECT_TRUE(is_good(cell.outcome)) << cell.body << ", " << cell.method << ", " << cell.hard_case << ": "
                                           << name_of(cell.outcome) << ": " << cell.message;
        ++cells;
      }
    }
  }
  EXPECT_GE(cells, 40);
}

// What --quick ends with 0 by.
TEST(Stability, QuickChartHoldsOurSolverAndBodiesThatBearBothCables) {
  StabilityBench bench = make_bench();
  for (const StabilityMethod& method : stability_methods(true)) EXPECT_TRUE(method.ours) << method.name;
  const auto all = hard_cases(true);
  const auto both = std::find_if(all.begin(), all.end(), [](const auto& one) { return one.contractions.size() == 2; });
  ASSERT_NE(both, all.end());
  for (const StabilityBody& body : stability_bodies(true)) {
    if (body.name != "Hammerbot") continue;
    const StabilityCell cell = bench.run(body, stability_methods(true).front(), *both);
    EXPECT_TRUE(is_good(cell.outcome)) << cell.message;
  }
}

// On the mesh as it is, in time, these ended with inverted elements.
TEST(Stability, DefaultSolverUnfoldsThePulledAndTheScrambledCantilever) {
  StabilityBench bench = make_bench();
  int cells = 0;
  for (const StabilityMethod& method : stability_methods()) {
    for (const HardCase& hard_case : hard_cases(false)) {
      const bool once_bad = hard_case.name == "contraction 1 to 0.5 at once" ||
                            hard_case.name == "the same, rigid cable" || hard_case.name == "scrambled nodes";
      if (method.name != "newton, in time" || !once_bad) continue;
      const StabilityCell cell = bench.run(stability_bodies(false).front(), method, hard_case);
      EXPECT_TRUE(is_good(cell.outcome)) << cell.hard_case << ": " << name_of(cell.outcome) << ": " << cell.message;
      ++cells;
    }
  }
  EXPECT_EQ(cells, 3);
}

// A step that found no solution took its unbalanced forces for work: 87 times the energy turned over.
TEST(Stability, LedgerOfACollapsedCuboidCloses) {
  StabilityBench bench = make_bench();
  for (const HardCase& hard_case : hard_cases(false)) {
    if (hard_case.name != "collapsed to a point") continue;
    const StabilityCell cell = bench.run(stability_bodies(false).back(), stability_methods()[1], hard_case);
    EXPECT_TRUE(is_good(cell.outcome)) << cell.message;
    EXPECT_LT(std::abs(cell.closure.value()), 0.01);
  }
}

// Of the methods that are there for comparison: xpbd's, or the others'.
int cells_with_finite_numbers(bool xpbd) {
  StabilityBench bench = make_bench();
  int cells = 0;
  for (const StabilityBody& body : small_bodies()) {
    for (const StabilityMethod& method : stability_methods()) {
      for (const HardCase& hard_case : hard_cases(true)) {
        const bool hard = hard_case.name == "time step 1 s" || hard_case.name == "scrambled nodes, driven";
        const bool wanted = (method.name.find("xpbd") == 0) == xpbd;
        if (method.ours || !fits(body, method, hard_case) || !hard || !wanted || (xpbd && body.chamber)) continue;
        const StabilityCell cell = bench.run(body, method, hard_case);
        EXPECT_NE(cell.outcome, Outcome::not_finite) << cell.body << ", " << cell.method << ", " << cell.hard_case;
        ++cells;
      }
    }
  }
  return cells;
}

TEST(Stability, NoMethodLeavesTheFiniteNumbers) { EXPECT_GE(cells_with_finite_numbers(false), 4); }

// It takes too long for a test on the chamber, and on the cantilever for every change.
TEST(Stability, XpbdDoesNotLeaveTheFiniteNumbers) { EXPECT_EQ(cells_with_finite_numbers(true), 4); }

// It converges to the rest state of elements that lock, and said nothing.
TEST(Stability, XpbdSaysThatItsLinearElementsLock) {
  StabilityBench bench = make_bench();
  for (const StabilityMethod& method : stability_methods()) {
    for (const HardCase& hard_case : hard_cases(false)) {
      if (method.name != "xpbd, linear" || hard_case.name != "Poisson's ratio 0.499") continue;
      const StabilityCell cell = bench.run(small_bodies().front(), method, hard_case);
      EXPECT_EQ(cell.outcome, Outcome::reported) << cell.message;
      EXPECT_EQ(cell.message, "the markers are in the wrong place; the scene was warned of: locking_elements");
    }
  }
}

TEST(Stability, XpbdMeetsABall) {
  StabilityBench bench = make_bench();
  for (const HardCase& hard_case : hard_cases(true)) {
    if (hard_case.name != "pressed by a ball, 8 mm") continue;
    for (const StabilityMethod& method : stability_methods()) {
      if (method.name != "xpbd") continue;
      ASSERT_TRUE(fits(small_bodies().front(), method, hard_case));
      const StabilityCell cell = bench.run(small_bodies().front(), method, hard_case);
      EXPECT_TRUE(is_good(cell.outcome)) << name_of(cell.outcome) << ": " << cell.message;
    }
  }
}

// The chart must be able to show a failure: linear elements lock, converge, and are in the wrong place. That is not
// silent, as the scene is warned of; coarse ones that do not lock are wrong without a word.
TEST(Stability, ShowsWhatIsInTheWrongPlace) {
  StabilityBench bench = make_bench();
  const StabilityBody body = small_bodies().front();
  StabilityMethod linear;
  linear.body_overrides.set({"body", "element"}, "linear");
  linear.equilibrium = true;
  HardCase hard_case = hard_cases(true).front();
  for (const auto& [ratio, outcome] : {std::pair{0.499999, Outcome::reported}, std::pair{0.3, Outcome::silent}}) {
    hard_case.name = std::to_string(ratio);
    hard_case.overrides.set({"body", "material", "poissons_ratio"}, ratio);
    const StabilityCell cell = bench.run(body, linear, hard_case);
    EXPECT_EQ(cell.outcome, outcome) << cell.message;
    EXPECT_GT(cell.off_m, 1e-3);
  }
}

TEST(Stability, DrawsEveryCellOnce) {
  StabilityCell cell{"bar", "newton", "scrambled", true, Outcome::recovered, 1, 0, 0.0, 0.1, {}, {}, ""};
  std::vector<StabilityCell> cells{cell};
  cell.hard_case = "slivers";
  cell.outcome = Outcome::silent;
  cells.push_back(cell);
  const Plot plot = stability_plot(cells);
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_EQ(plot.series[0].label, "recovered");
  EXPECT_EQ(plot.series[1].x, std::vector<double>{1.0});
  EXPECT_EQ(plot.x.ticks.size(), 2u);
  EXPECT_EQ(plot.y.ticks.size(), 1u);
}

TEST(Stability, ReadsItsTableAgain) {
  const StabilityCell cell{"bar", "newton, in time", "slivers",      true, Outcome::silent, 7, 2, 0.25, 1.5,
                           -2e-3, std::nullopt,      "wrong, \"so\""};
  std::istringstream file(stability_csv({cell, cell}));
  const std::vector<StabilityCell> read = read_stability_csv(file);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[1].method, cell.method);
  EXPECT_EQ(read[1].outcome, cell.outcome);
  EXPECT_EQ(read[1].failed_solves, 2);
  EXPECT_DOUBLE_EQ(read[1].cpu_s, 1.5);
  EXPECT_DOUBLE_EQ(read[1].closure.value(), -2e-3);
  EXPECT_FALSE(read[1].integrator.has_value());
  EXPECT_EQ(read[1].message, "wrong, 'so'");
  std::istringstream other("body,method\n");
  EXPECT_THROW(read_stability_csv(other), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
