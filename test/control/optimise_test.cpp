// SPDX-License-Identifier: BSD-3-Clause
// The program `optimise` as a user runs it.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

const std::string bar = SOFT_ROBOT_LAB_SOURCE "/test/data/scenes/cable_bar.yaml ";

Outcome optimise(const SceneFolder& folder, const std::string& arguments) {
  return run_program(SOFT_ROBOT_LAB_OPTIMISE, folder, arguments);
}

TEST(Optimise, TakesMarkersAndPosesInTheirOrder) {
  const SceneFolder folder;
  const Outcome outcome =
      optimise(folder, bar +
                           "--marker tip --target 0.01 0 -0.097 --weight 50 --marker middle --target 0.005 0 -0.05 "
                           "--then --marker middle --target -0.002 0 -0.05 --duration 3 --result " +
                           folder.path("result.json"));
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  const Json result = Json::parse(contents(folder.path("result.json")));
  ASSERT_EQ(result["poses"].size(), 2u);
  const Json& first = result["poses"][0]["nearest_m"];
  ASSERT_EQ(first.size(), 2u);
  EXPECT_NEAR(first["tip"][0].get<double>(), 0.01, 2e-4);  // the heavy one is reached, the other is not
  EXPECT_GT(std::abs(first["middle"][0].get<double>() - 0.005), 1e-3);
  const Json& second = result["poses"][1]["nearest_m"];
  ASSERT_EQ(second.size(), 1u);
  EXPECT_NEAR(second["middle"][0].get<double>(), -0.002, 2e-4);
  EXPECT_EQ(result["policy"]["steps"].back()["time_s"], 6.0);
}

// The service counts half a millimetre as reached where nobody says what does, and so does the program.
TEST(Optimise, CountsATargetAsReachedWithinHalfAMillimetre) {
  const SceneFolder folder;
  const auto nearest = [&](const std::string& target, const std::string& more) {
    const Outcome outcome =
        optimise(folder, bar + "--marker tip --target " + target + more + " --result " + folder.path("result.json"));
    EXPECT_EQ(outcome.exit_status, 0) << outcome.err;
    return Json::parse(contents(folder.path("result.json")))["poses"][0];
  };
  const Json at = nearest("0.01 0 -0.097", "")["nearest_m"]["tip"];
  const auto beside = [&](double across_m) {  // which no cable pulls to
    return std::to_string(at[0].get<double>()) + " " + std::to_string(at[1].get<double>() + across_m) + " " +
           std::to_string(at[2].get<double>());
  };
  EXPECT_TRUE(nearest(beside(2e-4), "")["target_reached"].get<bool>());
  EXPECT_FALSE(nearest(beside(2e-4), " --tolerance 1e-4")["target_reached"].get<bool>());
  EXPECT_FALSE(nearest(beside(1e-3), "")["target_reached"].get<bool>());
}

TEST(Optimise, AsksWhetherAFarTargetIsInMetres) {
  const SceneFolder folder;
  const Outcome far = optimise(folder, bar + "--marker tip --target 3 1 -10.5 --iterations 1");
  EXPECT_EQ(far.err.find("optimise: warning: the target of tip is 1.087e+04 mm away"), 0u) << far.err;
  EXPECT_NE(far.err.find("targets are in metres; are these numbers millimetres?"), std::string::npos) << far.err;
  const Outcome near = optimise(folder, bar + "--marker tip --target 0.1 0 -0.1 --iterations 1");
  EXPECT_EQ(near.err.find("warning"), std::string::npos) << near.err;
}

TEST(Optimise, NamesWhatIsWrongWithItsArguments) {
  const SceneFolder folder;
  const std::vector<std::pair<std::string, std::string>> table = {
      {"", "ROBOT is required\nUsage: optimise [OPTIONS] ROBOT\n"},
      {bar, "--marker is required"},
      {bar + "--target 0 0 0 --marker tip", "--target: comes after its --marker"},
      {bar + "--weight 2 --marker tip", "--weight: comes after its --marker"},
      {bar + "--marker tip --then --target 0 0 0", "--target: comes after its --marker"},
      {bar + "--marker tip", "--target: marker tip has none; give `--target X Y Z` [m] after its --marker"},
      {bar + "--marker tip --target 0 0 -0.1 --then --marker middle", "--target: marker middle has none"},
      {bar + "--marker tip --target 30000 10 -105", "--target: 30000 is not in [-1000, 1000] m\n"},
      {bar + "--marker tip --target 0 0", "--target: At least 3 required but received 2"},
      {bar + "--marker tip --target 0 0 -0.1m", "--target: '-0.1m' is no number"},
      {bar + "--marker tip --iterations 2.5", "--iterations: '2.5' is no whole number"},
      {bar + "--marker tip --method best", "method: 'best' is not one of gauss_newton"},
      {bar + "--marker tip --colour red", "unknown option --colour"},
      {bar + bar + "--marker tip", "not expected: " SOFT_ROBOT_LAB_SOURCE "/test/data/scenes/cable_bar.yaml"},
      {bar + "--marker tip --result a --result b", "--result: At Most 1 required but received 2"},
  };
  for (const auto& [arguments, words] : table) {
    SCOPED_TRACE(arguments);
    const Outcome outcome = optimise(folder, arguments);
    EXPECT_EQ(outcome.exit_status, 2);
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace soft_robot_lab
