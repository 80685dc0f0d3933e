// SPDX-License-Identifier: BSD-3-Clause
#include "robot/casting/angles.h"

#include <gtest/gtest.h>

#include "shapes.h"

namespace soft_robot_lab {
namespace {

// A block with a notch from above that opens by an angle; its ground is rounded by some facets of a radius.
Surface notched(double opening_deg, double radius, int facets) {
  const double half = opening_deg / 2 * kPi / 180, depth = 0.01;
  std::vector<Eigen::Vector2d> right;  // from the ground up
  for (int i = 0; i <= facets && facets > 0; ++i) {
    const double turn = (kPi / 2 - half) * (i + 0.5) / (facets + 0.5);
    right.emplace_back(radius * std::sin(turn), radius * (1 - std::cos(turn)));
  }
  if (facets == 0) right.emplace_back(1e-9, 0);
  const Eigen::Vector2d last = right.back();
  right.emplace_back(last.x() + std::tan(half) * (depth - last.y()), depth);
  std::vector<Eigen::Vector2d> outline{{-0.02, -0.01}, {0.02, -0.01}, {0.02, depth}};
  Shape s;
  std::vector<int> front, back, front_low, back_low;
  std::vector<Eigen::Vector2d> line;
  for (auto it = right.rbegin(); it != right.rend(); ++it) line.emplace_back(-it->x(), it->y());
  line.insert(line.end(), right.begin(), right.end());
  line.insert(line.begin(), Eigen::Vector2d(-0.02, depth));
  line.emplace_back(0.02, depth);
  for (const auto& p : line) {
    front.push_back(s.vertex({p.x(), 0, p.y()})), back.push_back(s.vertex({p.x(), 0.02, p.y()}));
    front_low.push_back(s.vertex({p.x(), 0, -0.01})), back_low.push_back(s.vertex({p.x(), 0.02, -0.01}));
  }
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    s.quad(front[i], front[i + 1], back[i + 1], back[i]);
    s.quad(front_low[i], back_low[i], back_low[i + 1], front_low[i + 1]);
    s.quad(front_low[i], front_low[i + 1], front[i + 1], front[i]);
    s.quad(back_low[i], back[i], back[i + 1], back_low[i + 1]);
  }
  const size_t z = line.size() - 1;
  s.quad(front_low[0], front[0], back[0], back_low[0]);
  s.quad(front_low[z], back_low[z], back[z], front[z]);
  return s.surface();
}

TEST(Angles, MeasureTheOpeningOfANotch) {
  EXPECT_NEAR(measure_angles(notched(12, 0, 0), 0.0005, 15).notch.opening_deg, 12, 0.01);
  EXPECT_NEAR(measure_angles(notched(40, 0, 0), 0.0005, 15).notch.opening_deg, 40, 0.01);
}

TEST(Angles, AreNotFooledByANotchThatThreeFacetsRound) {
  const EdgeAngles angles = measure_angles(notched(12, 0.0001, 3), 0.0005, 15);
  EXPECT_NEAR(angles.notch.opening_deg, 12, 0.01);
  EXPECT_NEAR(angles.notch.length_m, 0.02, 0.15);
}

TEST(Angles, LetPassANotchRoundedByALargeRadius) {
  EXPECT_GT(measure_angles(notched(12, 0.003, 30), 0.0005, 15).notch.opening_deg, 90);
}

TEST(Angles, MeasureAWedge) {
  const double height = 0.02 * std::tan(20 * kPi / 180);
  const Surface wedge = prism({{0, 0}, {0.02, 0}, {0.02, height}}, 0.03, {0.015, 0.002}).surface();
  const EdgeAngles angles = measure_angles(wedge, 0.0005, 25);
  EXPECT_NEAR(angles.wedge.opening_deg, 20, 1e-6);
  EXPECT_NEAR(angles.wedge.length_m, 0.03, 1e-9);
  EXPECT_EQ(angles.notch.opening_deg, 180);
}

TEST(Angles, OfABoxAreRight) {
  const EdgeAngles angles = measure_angles(box({0.02, 0.02, 0.02}).surface(), 0.0005, 15);
  EXPECT_NEAR(angles.wedge.opening_deg, 90, 1e-9);
  EXPECT_EQ(angles.wedge.length_m, 0);
}

}  // namespace
}  // namespace soft_robot_lab
