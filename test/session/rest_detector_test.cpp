// SPDX-License-Identifier: BSD-3-Clause
#include "session/rest_detector.h"

#include <cmath>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

std::vector<Eigen::Vector3d> at(double x_m) { return {Eigen::Vector3d::Zero(), x_m * Eigen::Vector3d::UnitX()}; }

TEST(RestDetector, RestsOnlyAfterTheWholeDuration) {
  RestDetector rest;
  EXPECT_FALSE(rest.update(10.0, at(0.0)));
  EXPECT_FALSE(rest.update(10.4, at(1.0e-5)));
  EXPECT_TRUE(rest.update(10.5, at(0.0)));
}

TEST(RestDetector, StartsAnewWhenAMarkerMoves) {
  RestDetector rest;
  rest.update(0.0, at(0.0));
  EXPECT_FALSE(rest.update(0.5, at(1.0e-4)));
  EXPECT_FALSE(rest.update(0.9, at(1.0e-4)));
  EXPECT_TRUE(rest.update(1.0, at(1.0e-4)));
}

TEST(RestDetector, SeesASlowDrift) {
  RestDetector rest;
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(rest.update(0.1 * i, at(2.0e-5 * i))) << i;
}

TEST(RestDetector, NeverRestsWithoutMarkersOrWithNotANumber) {
  RestDetector rest;
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(rest.update(0.1 * i, {}));
  for (int i = 20; i < 40; ++i) EXPECT_FALSE(rest.update(0.1 * i, at(NAN)));
}

}  // namespace
}  // namespace soft_robot_lab
