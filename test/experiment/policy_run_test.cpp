#include "experiment/policy_run.h"

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

PolicyRun run_through(std::vector<double> distance_m) {
  PolicyRun run;
  run.distance_m = std::move(distance_m);
  for (size_t i = 0; i < run.distance_m.size(); ++i) run.cpu_s.push_back(0.1 * static_cast<double>(i + 1));
  return run;
}

TEST(PolicyRun, TellsHowItSwings) {
  const PolicyRun swinging = run_through({0.06, 0.05, 0.09, 0.04, 0.07, 0.0700001, 0.03});
  EXPECT_EQ(swinging.turns(), 4);
  EXPECT_DOUBLE_EQ(swinging.largest_rise_m(), 0.04);
  const PolicyRun steady = run_through({0.06, 0.05, 0.0500005, 0.04});  // half a micrometre is no turn
  EXPECT_EQ(steady.turns(), 0);
  EXPECT_LT(steady.largest_rise_m(), 1e-6);
}

TEST(PolicyRun, KnowsWhenItWasAsNear) {
  const PolicyRun run = run_through({0.06, 0.02, 0.03, 0.01});
  EXPECT_DOUBLE_EQ(run.cpu_until_s(0.025).value(), 0.2);
  EXPECT_DOUBLE_EQ(run.cpu_until_s(0.01).value(), 0.4);
  EXPECT_FALSE(run.cpu_until_s(0.009).has_value());
}

}  // namespace
}  // namespace soft_robot_lab
