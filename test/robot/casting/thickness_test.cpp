// SPDX-License-Identifier: BSD-3-Clause
#include "robot/casting/thickness.h"

#include <gtest/gtest.h>

#include "shapes.h"

namespace soft_robot_lab {
namespace {

Thickness measure(const Surface& surface, double limit_m) { return measure_thickness(RayTree(surface), limit_m); }

TEST(Thickness, IsThatOfAPlate) {
  const Thickness t = measure(box({0.03, 0.03, 0.003}).surface(), 0.004);
  EXPECT_NEAR(t.ball.worst_m, 0.003, 0.003 * 1e-3);
  EXPECT_NEAR(t.cone.worst_m, 0.003, 0.003 * 1e-3);
  EXPECT_NEAR(t.ball.area_m2, 2 * 9e-4, 0.1 * 2 * 9e-4);  // but for its rim
}

TEST(Thickness, OfARodIsItsDiameterThoughTheSourcesConeSeesNothing) {
  const Thickness t = measure(rod(0.001, 0.02, 96).surface(), 0.003);
  EXPECT_NEAR(t.ball.worst_m, 0.002, 0.002 * 0.01);
  EXPECT_GT(t.cone.worst_m, 1);
}

TEST(Thickness, OfATubeIsItsWall) {
  const Thickness t = measure(pipe(0.01, 0.0085, 0.03, 96).surface(), 0.002);
  EXPECT_NEAR(t.ball.worst_m, 0.0015, 0.0015 * 0.01);
  EXPECT_NEAR(t.cone.worst_m, 0.0015, 0.0015 * 0.01);
}

TEST(Thickness, FindsNothingThinInACubeWithItsRightAngles) {
  const Thickness t = measure(box({0.02, 0.02, 0.02}).surface(), 0.002);
  EXPECT_NEAR(t.ball.worst_m, 0.02, 1e-5);
  EXPECT_GT(t.cone.worst_m, 1);
  EXPECT_EQ(t.ball.area_m2, 0);
}

TEST(Thickness, OfAWedgeOfTwentyDegreesGoesToZero) {
  const double height = 0.02 * std::tan(20 * kPi / 180);
  const Thickness t = measure(prism({{0, 0}, {0.02, 0}, {0.02, height}}, 0.03, {0.015, 0.002}).surface(), 0.002);
  EXPECT_LT(t.ball.worst_m, 0.0003);
  EXPECT_LT(t.ball.at_m.x(), 0.001);
}

TEST(Thickness, OfTheSourcesConeLeavesOutTheSideOfARim) {
  // A place on the top farther from the rim than the limit, nearer to the side, is joined to it by no path within the
  // limit; but adjacent surfaces are no back side.
  const Thickness t = measure(frustum({0.015, 0.015}, {0.02, 0.02}, 0.03).surface(), 0.002);
  EXPECT_GT(t.cone.worst_m, 0.02);
  EXPECT_GT(t.ball.worst_m, 0.02);
}

TEST(Thickness, OfTheSourcesConeCountsTheSideOfAKnifesEdge) {
  const double height = 0.02 * std::tan(20 * kPi / 180);
  const Thickness t = measure(prism({{0, 0}, {0.02, 0}, {0.02, height}}, 0.03, {0.015, 0.002}).surface(), 0.002);
  EXPECT_LT(t.cone.worst_m, 0.001);
}

TEST(Thickness, DoesNotCountAGrooveBetweenTwoPlates) {
  // Two plates of 4 mm across a groove of 1 mm, on a common floor.
  const std::vector<Eigen::Vector2d> u{{-0.0045, -0.004}, {0.0045, -0.004}, {0.0045, 0.008},  {0.0005, 0.008},
                                       {0.0005, 0},       {-0.0005, 0},     {-0.0005, 0.008}, {-0.0045, 0.008}};
  Shape s;
  const int n = 8;
  for (const double y : {0.0, 0.03})
    for (const auto& c : u) s.vertex({c.x(), y, c.y()});
  for (int i = 0; i < n; ++i) s.quad(i, n + i, n + (i + 1) % n, (i + 1) % n);
  for (const auto& q : {std::array{0, 5, 6, 7}, {0, 1, 4, 5}, {1, 2, 3, 4}}) {
    s.quad(q[0], q[1], q[2], q[3]);
    s.quad(n + q[3], n + q[2], n + q[1], n + q[0]);
  }
  const Thickness t = measure(s.surface(), 0.0035);
  EXPECT_NEAR(t.ball.worst_m, 0.004, 1e-5);
  EXPECT_GT(t.cone.worst_m, 1);
}

}  // namespace
}  // namespace soft_robot_lab
