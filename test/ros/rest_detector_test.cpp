// SPDX-License-Identifier: BSD-3-Clause
#include "ros/rest_detector.h"

#include <cmath>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

std::vector<geometry_msgs::Point> at(double x_m) {
  std::vector<geometry_msgs::Point> points(2);
  points[1].x = x_m;
  return points;
}

TEST(RestDetector, RestsOnlyAfterTheWholeDuration) {
  RestDetector rest({5.0e-5, 0.5});
  EXPECT_FALSE(rest.update(10.0, at(0.0)));
  EXPECT_FALSE(rest.update(10.4, at(1.0e-5)));
  EXPECT_TRUE(rest.update(10.5, at(0.0)));
}

TEST(RestDetector, StartsAnewWhenAMarkerMoves) {
  RestDetector rest({5.0e-5, 0.5});
  rest.update(0.0, at(0.0));
  EXPECT_FALSE(rest.update(0.5, at(1.0e-4)));
  EXPECT_FALSE(rest.update(0.9, at(1.0e-4)));
  EXPECT_TRUE(rest.update(1.0, at(1.0e-4)));
}

TEST(RestDetector, SeesASlowDrift) {
  RestDetector rest({5.0e-5, 0.5});
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(rest.update(0.1 * i, at(2.0e-5 * i))) << i;
}

TEST(RestDetector, NeverRestsWithoutMarkersOrWithNotANumber) {
  RestDetector rest({5.0e-5, 0.5});
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(rest.update(0.1 * i, {}));
  for (int i = 20; i < 40; ++i) EXPECT_FALSE(rest.update(0.1 * i, at(NAN)));
}

}  // namespace
}  // namespace soft_robot_lab
