// SPDX-License-Identifier: BSD-3-Clause
// Searches for the thickness of a short bar at which its cables move its tip farthest.
#include "study/search/design_search.h"

#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace soft_robot_lab {
namespace {

class DesignSearchTest : public testing::Test {
 protected:
  std::string search(const std::string& more) const {
    return folder_.write("search.yaml",
                         "robot: " + robot_ +
                             "\nsteps: 2\none_at_a_time: true\nobjectives: [reach_m]\npopulation: 5\nseed: 3\n"
                             "method: differential_evolution\n" +
                             more + "parameters:\n  thickness_m: {}\n");
  }
  Outcome run(const std::string& more, const std::string& output) const {
    return run_program(SOFT_ROBOT_LAB_SEARCH, folder_, search(more) + " --output " + folder_.path(output));
  }
  std::vector<std::string> designs(const std::string& output) const {
    std::vector<std::string> lines;
    std::istringstream text(contents(folder_.path(output + "/designs.csv")));
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    return lines;
  }

  SceneFolder folder_;
  const std::string robot_ = folder_.write(
      "robot.yaml",
      "include: bar.yaml\nbody: {element: linear}\n"
      "cables: {left: {min_contraction: 0.95}, right: {min_contraction: 0.95}}\n"
      "casting: {min_thickness_m: 0.019}\n"
      "parameters:\n  thickness_m: {range: [0.016, 0.026], factors: {\"body.solid.box.size_m[1]\": 1}}\n");
};

double thickness_m(const std::string& line) { return std::stod(line.substr(line.find(',') + 1)); }
double reach_m(const std::string& line) { return std::stod(line.substr(line.find(',', line.find(',') + 1) + 1)); }

TEST_F(DesignSearchTest, FindsABetterBarAndGoesOnWhereItEnded) {
  const Outcome whole = run("castable: false\ndesigns: 10\n", "whole");
  ASSERT_EQ(whole.exit_status, 0) << whole.err;
  const std::vector<std::string> all = designs("whole");
  ASSERT_EQ(all.size(), 11u);

  ASSERT_EQ(run("castable: false\ndesigns: 5\n", "parts").exit_status, 0);
  const std::vector<std::string> half = designs("parts");
  EXPECT_EQ(half.size(), 6u);
  ASSERT_EQ(run("castable: false\ndesigns: 10\n", "parts").exit_status, 0);
  EXPECT_EQ(designs("parts"), all) << "what was known is not tried again, and nothing else is";

  const std::string best =
      whole.out.substr(whole.out.find("design_"), whole.out.find(": reach_m") - whole.out.find("design_"));
  const std::size_t place = std::stoul(best.substr(7));
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LE(reach_m(all[i]), reach_m(all[place])) << all[i];
  EXPECT_GT(place, 5u) << "the first population, which is drawn, holds nothing as good";
  const Outcome again = run_program(SOFT_ROBOT_LAB_ASSESS, folder_,
                                    folder_.path("whole/" + best + ".yaml") + " --steps 2 --one-at-a-time");
  ASSERT_EQ(again.exit_status, 0) << again.err;
  EXPECT_NE(contents(folder_.path("whole/report.html")).find("Best design"), std::string::npos);
}

TEST_F(DesignSearchTest, AssessesOnlyWhatCanBeCast) {
  const Outcome outcome = run("designs: 5\n", "castable");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  int thin = 0;
  const std::vector<std::string> all = designs("castable");
  for (std::size_t i = 1; i < all.size(); ++i) {
    const bool refused = all[i].find("not castable: thickness") != std::string::npos;
    EXPECT_EQ(refused, thickness_m(all[i]) < 0.019) << all[i];
    thin += refused;
  }
  EXPECT_GT(thin, 0);
  EXPECT_LT(thin, 5);
  EXPECT_NE(contents(folder_.path("castable/report.html")).find("not castable: thickness"), std::string::npos);
}

TEST_F(DesignSearchTest, RefusesBadSearches) {
  const auto refusal = [&](const std::string& more) {
    const Outcome outcome = run(more, "bad");
    EXPECT_EQ(outcome.exit_status, 2) << more;
    return outcome.err;
  };
  EXPECT_NE(refusal("designs: 2\n").find("designs"), std::string::npos);
  const std::string file =
      folder_.write("bad.yaml", "robot: robot.yaml\nobjectives: [beauty]\nparameters: {thickness_m: {}}\n");
  const Outcome unknown = run_program(SOFT_ROBOT_LAB_SEARCH, folder_, file + " --output " + folder_.path("bad"));
  EXPECT_NE(unknown.err.find("'beauty' is not one of reach_m"), std::string::npos) << unknown.err;
  const std::string several = folder_.write(
      "several.yaml",
      "robot: robot.yaml\nobjectives: [reach_m, mass_kg]\npopulation: 10\nparameters: {thickness_m: {}}\n");
  const Outcome odd = run_program(SOFT_ROBOT_LAB_SEARCH, folder_, several + " --output " + folder_.path("bad"));
  EXPECT_NE(odd.err.find("multiple of 4"), std::string::npos) << odd.err;
}

Design design(std::vector<double> fitness, bool good = true) { return {{}, good, "", std::move(fitness), {}}; }

TEST(ParetoFront, HoldsWhatNothingIsBetterThan) {
  EXPECT_EQ(pareto_front({design({3, 1}), design({2, 2}), design({1, 3}), design({2, 3}), design({3, 3}),
                          design({0, 0}, false), design({2, 2})}),
            (std::vector<std::size_t>{2, 1, 0}));
  EXPECT_EQ(pareto_front({design({3}), design({1}), design({2})}), (std::vector<std::size_t>{1}));
  EXPECT_TRUE(pareto_front({design({1}, false)}).empty());
}

}  // namespace
}  // namespace soft_robot_lab
