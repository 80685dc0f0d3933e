// SPDX-License-Identifier: BSD-3-Clause
#include "control/motion/svg_path.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

using Points = std::vector<Eigen::Vector2d>;

void expect_points(const std::string& d, const Points& expected) {
  const Points points = svg_points(d);
  ASSERT_EQ(points.size(), expected.size()) << d;
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((points[i] - expected[i]).norm(), 1e-12) << d << " " << i;
}

TEST(SvgPath, ReadsLinesInAllTheirForms) {
  const Points square = {{1, 2}, {4, 2}, {4, 6}, {1, 6}, {1, 2}};
  for (const std::string d : {"M 1 2 L 4 2 L 4 6 L 1 6 Z", "M1,2 4,2 4,6 1,6z", "m1 2 3 0 0 4-3 0z", "M1 2H4V6H1Z",
                              "m+1 2h3v4h-3v-4", "M.1e1 20e-1 L4,2\n4 6\t1,6,1,2"})
    expect_points(d, square);
  expect_points("M.5.5-1-1", {{0.5, 0.5}, {-1, -1}});
}

// At half of a curve its Bernstein weights are 1/8, 3/8, 3/8, 1/8 or 1/4, 1/2, 1/4.
TEST(SvgPath, CutsCurves) {
  const Points cubic = svg_points("M0 0C0 8 8 8 8 0");
  EXPECT_LT((cubic[cubic.size() / 2] - Eigen::Vector2d(4, 6)).norm(), 1e-12);
  EXPECT_LT((cubic.back() - Eigen::Vector2d(8, 0)).norm(), 1e-12);
  const Points quadratic = svg_points("M1 1q4 8 8 0");
  EXPECT_LT((quadratic[quadratic.size() / 2] - Eigen::Vector2d(5, 5)).norm(), 1e-12);
  EXPECT_EQ(svg_points("M0 0C0 8 8 8 8 0S16-8 16 0"), svg_points("M0 0C0 8 8 8 8 0C8-8 16-8 16 0"));
  EXPECT_EQ(svg_points("M1 1q4 8 8 0t8 0"), svg_points("M1 1q4 8 8 0q4-8 8 0"));
  EXPECT_EQ(svg_points("M0 0S8 8 8 0"), svg_points("M0 0C0 0 8 8 8 0"));  // no curve before: it starts at the pen
}

void expect_refusal(const std::string& d, const std::string& words) {
  try {
    svg_points(d);
    FAIL() << d;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << d << ": " << error.what();
  }
}

TEST(SvgPath, SaysWhatItDoesNotRead) {
  expect_refusal("L 1 2", "character 2: it must begin with M");
  expect_refusal("1 2", "a number without a command");
  expect_refusal("M0 0 L1 1 M2 2", "a marker cannot be lifted");
  expect_refusal("M0 0 Z 1 1", "a number without a command");
  expect_refusal("M0 0 A1 1 0 0 0 2 2", "arcs");
  expect_refusal("M0 0 X1", "'X' is no command");
  expect_refusal("M0 0 L1", "command L needs a number here");
  expect_refusal("M0 0 L1 nan", "needs a number here");
  expect_refusal("M0 0 L1 1e999", "needs a number here");
  expect_refusal("M0 0 L1 ++1", "needs a number here");
  std::string many = "M0 0";
  for (int i = 0; i < 501; ++i) many += " 1 " + std::to_string(i);
  expect_refusal(many, "more than 500 pieces");
  EXPECT_TRUE(svg_points("").empty());
}

}  // namespace
}  // namespace soft_robot_lab
