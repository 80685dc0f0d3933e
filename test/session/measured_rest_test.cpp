// SPDX-License-Identifier: BSD-3-Clause
#include "session/measured_rest.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

MarkerFrame tip_at(double time_s, double x_m) { return {time_s, {{"tip", {x_m, 0.0, 0.0}}}}; }

TEST(MeasuredRest, AveragesTheNoiseOfAMarkerAtRest) {
  MeasuredRest rest;
  rest.start(10.0);
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(i >= 9 || !rest.at_rest()) << i;  // two windows
    rest.add(tip_at(10.1 + 0.1 * i, i % 2 == 0 ? 0.0009 : 0.0011));
  }
  ASSERT_TRUE(rest.at_rest());
  EXPECT_NEAR(rest.at_rest()->at("tip").x(), 0.001, 5e-5);
}

TEST(MeasuredRest, WaitsWhileAMarkerMoves) {
  MeasuredRest rest;
  rest.start(10.0);
  for (int i = 0; i < 30; ++i) {
    rest.add(tip_at(10.1 + 0.1 * i, 0.001 * i));
    EXPECT_FALSE(rest.at_rest()) << i;
  }
}

// Another marker beside the tip.
MarkerFrame with_middle_at(MarkerFrame frame, double x_m) {
  frame.seen.push_back({"middle", {x_m, 0.0, 0.0}});
  return frame;
}

TEST(MeasuredRest, IsToldThoughAMarkerIsSeenBadly) {
  for (const double rate_hz : {30.0, 10.0, 5.0}) {
    std::mt19937 random(1);
    std::normal_distribution<double> noise_m(0.0, 3e-3), little_m(0.0, 5e-5);
    MeasuredRest rest;
    rest.start(10.0);
    int frames = 0, at_rest = 0;
    for (; frames < static_cast<int>(20.0 * rate_hz); ++frames) {
      rest.add(with_middle_at(tip_at(10.0 + frames / rate_hz, noise_m(random)), little_m(random)));
      if (rest.at_rest()) ++at_rest;
    }
    EXPECT_GT(at_rest, 0.8 * frames) << rate_hz;
  }
}

TEST(MeasuredRest, TellsNoPlaceBetweenTwoWhereAMarkerJumps) {
  for (const double rate_hz : {30.0, 10.0, 5.0, 3.0}) {
    const int frames = static_cast<int>(4.0 * rate_hz);
    for (int jump = 1; jump < frames; ++jump) {
      std::mt19937 random(1);
      std::normal_distribution<double> noise_m(0.0, 5e-5);
      MeasuredRest rest;
      rest.start(10.0);
      for (int i = 0; i < frames; ++i) {
        rest.add(tip_at(10.0 + i / rate_hz, (i < jump ? 0.0 : 0.004) + noise_m(random)));
        if (!rest.at_rest()) continue;
        const double x_m = rest.at_rest()->at("tip").x();
        EXPECT_LT(std::min(std::abs(x_m), std::abs(x_m - 0.004)), 6e-4) << rate_hz << " Hz, jump at " << jump;
      }
    }
  }
}

TEST(MeasuredRest, TellsOfAMarkerThatIsSeenNowAndThen) {
  MeasuredRest rest;
  rest.start(10.0);
  for (int i = 0; i < 20; ++i)  // five frames a second, so three or four a window
    rest.add(i % 3 == 0 ? tip_at(10.0 + 0.2 * i, 0.001) : with_middle_at(tip_at(10.0 + 0.2 * i, 0.001), 0.002));
  ASSERT_TRUE(rest.at_rest());
  EXPECT_EQ(rest.at_rest()->count("middle"), 1u);
}

TEST(MeasuredRest, DoesNotCountWhatWasNotSeenOrCameBefore) {
  MeasuredRest rest;
  rest.start(10.0);
  for (int i = 0; i < 30; ++i) EXPECT_TRUE(rest.add(tip_at(9.9, 0.001)));
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(rest.add({10.1 + 0.1 * i, {}}));
  EXPECT_FALSE(rest.at_rest());
}

}  // namespace
}  // namespace soft_robot_lab
