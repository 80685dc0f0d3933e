// SPDX-License-Identifier: BSD-3-Clause
#include "perception/calibration/point_matching.h"

#include <random>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

Eigen::Matrix3Xd random_points(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> coordinate(-0.15, 0.15);
  Eigen::Matrix3Xd points_m(3, count);
  for (double& value : points_m.reshaped()) value = coordinate(random);
  return points_m;
}

Eigen::Isometry3d some_motion() {
  return Eigen::Translation3d(0.1, -0.4, 0.6) * Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized());
}

Eigen::Matrix3Xd columns(const Eigen::Matrix3Xd& points_m, const std::vector<int>& order) {
  return points_m(Eigen::all, order);
}

// Points that a mirror brings to each other but no motion: three and their images in the plane z = 0, unlike heights.
Eigen::Matrix3Xd mirrored_solid() {
  Eigen::Matrix3Xd points_m(3, 6);
  points_m.leftCols(3) << 0.1, -0.05, 0.02, 0.0, 0.12, -0.08, 0.03, 0.07, 0.11;
  points_m.rightCols(3) = Eigen::Vector3d(1, 1, -1).asDiagonal() * points_m.leftCols(3);
  return points_m;
}

TEST(PointMatching, FindsTheOrderOfPoints) {
  std::mt19937 random(1);
  for (int count : {5, 6, 8}) {
    const Eigen::Matrix3Xd points_m = random_points(random, count);
    std::vector<int> order(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) order[static_cast<std::size_t>(i)] = (i + 2) % count;
    Eigen::Matrix3Xd moved_m = some_motion() * columns(points_m, order);
    moved_m += 0.003 * random_points(random, count);  // noise of up to 0.45 mm
    const PointMatching matching = match_points(moved_m, points_m, 0.004, 5);
    ASSERT_EQ(matching.best.size(), static_cast<std::size_t>(count));
    EXPECT_TRUE(matching.rival.empty());
    for (const PointMatch& match : matching.best) EXPECT_EQ(match.second, order[static_cast<std::size_t>(match.first)]);
  }
}

TEST(PointMatching, LeavesOutWhatTheOtherDoesNotSee) {
  std::mt19937 random(2);
  const Eigen::Matrix3Xd points_m = random_points(random, 7);
  const PointMatching matching = match_points(columns(points_m, {0, 1, 2, 3, 4, 5}),
                                              some_motion() * columns(points_m, {6, 5, 4, 3, 2, 1}), 0.004, 5);
  ASSERT_EQ(matching.best.size(), 5u);
  EXPECT_TRUE(matching.rival.empty());
  for (const PointMatch& match : matching.best) EXPECT_EQ(match.second, 6 - match.first);
}

TEST(PointMatching, FindsNothingWhereDistancesDiffer) {
  std::mt19937 random(3);
  const Eigen::Matrix3Xd points_m = random_points(random, 5);
  Eigen::Matrix3Xd bent_m = points_m;
  bent_m(0, 2) += 0.02;
  EXPECT_TRUE(match_points(points_m, bent_m, 0.004, 5).best.empty());
  EXPECT_EQ(match_points(points_m, bent_m, 0.004, 4).best.size(), 4u);
}

TEST(PointMatching, TakesNoMirrorImage) {
  std::mt19937 random(4);
  const Eigen::Matrix3Xd points_m = random_points(random, 5);
  EXPECT_TRUE(match_points(points_m, Eigen::Vector3d(-1, 1, 1).asDiagonal() * points_m, 0.004, 5).best.empty());
  const PointMatching matching = match_points(mirrored_solid(), some_motion() * mirrored_solid(), 0.004, 5);
  ASSERT_EQ(matching.best.size(), 6u);
  EXPECT_TRUE(matching.rival.empty());  // though all distances would fit the mirror image
  for (const PointMatch& match : matching.best) EXPECT_EQ(match.second, match.first);
}

TEST(PointMatching, FindsTheRivalOfASymmetricPlacement) {
  Eigen::Matrix3Xd pyramid(3, 5), flat_kite(3, 5), nearly(3, 5);
  pyramid << 0.1, 0, -0.1, 0, 0, 0, 0.1, 0, -0.1, 0, 0, 0, 0, 0, 0.12;
  flat_kite << 0, 0, 0.08, -0.08, 0, 0.12, -0.15, 0.03, 0.03, 0.02, 0, 0, 0, 0, 0;  // turned over, it is the same
  nearly = pyramid;
  nearly(0, 0) += 0.003;
  for (const Eigen::Matrix3Xd& points_m : {pyramid, flat_kite, nearly}) {
    const PointMatching matching = match_points(points_m, some_motion() * points_m, 0.004, 5);
    EXPECT_EQ(matching.best.size(), 5u);
    EXPECT_EQ(matching.rival.size(), 5u);
    EXPECT_NE(matching.best, matching.rival);
  }
  Eigen::Matrix3Xd broken = pyramid;
  broken(0, 0) += 0.03;
  broken(1, 1) += 0.06;
  EXPECT_TRUE(match_points(broken, some_motion() * broken, 0.004, 5).rival.empty());
}

TEST(PointMatching, StaysFastOnAGrid) {
  Eigen::Matrix3Xd grid(3, 16);
  for (int i = 0; i < 16; ++i) grid.col(i) << 0.05 * (i % 4), 0.05 * (i / 4), 0;
  EXPECT_EQ(match_points(grid, grid, 0.004, 5).rival.size(), 16u);
}

TEST(PointMatching, RefusesWhatItCannotDo) {
  const Eigen::Matrix3Xd points_m = Eigen::Matrix3Xd::Zero(3, 5);
  EXPECT_THROW(match_points(points_m, Eigen::Matrix3Xd::Zero(3, 17), 0.004, 5), std::invalid_argument);
  EXPECT_THROW(match_points(points_m, points_m, 0.004, 2), std::invalid_argument);
  EXPECT_THROW(match_points(points_m, points_m, 0, 5), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
