// SPDX-License-Identifier: BSD-3-Clause
#include "perception/tracking/marker_identity.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "drawn_scene.h"

namespace soft_robot_lab {
namespace {

using test::camera_at;

// Five markers in a line, 13 mm apart.
class MarkerIdentity : public testing::Test {
 protected:
  MarkerIdentity() {
    for (int i = 0; i < 5; ++i) rest_m_.push_back({0, -0.012, -0.016 - 0.013 * i});
    neighbours_ = nearest_neighbours(rest_m_, 2);
  }
  MarkerDetection sight(const Eigen::Vector3d& point_m) const {
    const Eigen::Vector3d in_camera = camera_.world_from_camera.inverse() * point_m;
    MarkerDetection sight;
    sight.camera = &camera_;
    sight.pixel = camera_.model.project(in_camera);
    sight.pixel_sigma = 0.05;
    sight.depth_m = in_camera.z();
    sight.depth_sigma_m = 5e-4;
    return sight;
  }
  std::vector<MarkerPrediction> predictions(double sigma_m) const {
    std::vector<MarkerPrediction> all;
    for (const Eigen::Vector3d& at_m : rest_m_)
      all.push_back({at_m, Eigen::Vector3d::Zero(), sigma_m * sigma_m * Eigen::Matrix3d::Identity(), -1});
    return all;
  }
  TrackerCamera camera_ = camera_at("left", {-0.3, -0.52, 0.05}, {0, 0, -0.05});
  std::vector<Eigen::Vector3d> rest_m_;
  std::vector<std::vector<int>> neighbours_;
};

TEST_F(MarkerIdentity, DoesNotDependOnTheOrderOfSights) {
  std::vector<int> order = {0, 1, 2, 3, 4};
  std::mt19937 random(3);
  for (int round = 0; round < 10; ++round) {
    std::shuffle(order.begin(), order.end(), random);
    std::vector<MarkerDetection> sights;
    for (const int i : order) sights.push_back(sight(rest_m_[i] + Eigen::Vector3d(0.003, 0, -0.003)));
    const std::vector<int> found = identify(sights, predictions(0.008), neighbours_, 25);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(order[found[i]], i);
  }
}

TEST_F(MarkerIdentity, LeavesAHiddenMarkerWithoutASight) {
  for (int hidden = 0; hidden < 5; ++hidden) {
    std::vector<MarkerDetection> sights;
    for (int i = 0; i < 5; ++i)
      if (i != hidden) sights.push_back(sight(rest_m_[i] + Eigen::Vector3d(0.002, 0.001, -0.002)));
    const std::vector<int> found = identify(sights, predictions(0.008), neighbours_, 25);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(found[i], i == hidden ? -1 : i - (i > hidden)) << hidden;
  }
}

TEST_F(MarkerIdentity, DoesNotTakeWhatIsBeyondTheGate) {
  const auto found = identify({sight({0.06, 0, 0.03})}, predictions(0.002), neighbours_, 25);
  EXPECT_EQ(found, std::vector<int>(5, -1));
}

TEST_F(MarkerIdentity, AnUncertainMarkerDoesNotTakeACertainOnesSight) {
  auto expected = predictions(0.001);
  expected[2].covariance_m2 *= 400;
  // Marker 2 is hidden; 1's sight is 1.5 deviations off, which the uncertain one would explain as well.
  const auto found = identify({sight(rest_m_[1] + Eigen::Vector3d(0, 0, -0.0015))}, expected, neighbours_, 25);
  EXPECT_EQ(found, (std::vector<int>{-1, 0, -1, -1, -1}));
}

TEST_F(MarkerIdentity, SightsSwappedByAWrongGuessChangePlacesForTheirNeighboursDistances) {
  // 3 and 4 are believed to be nearly in one place, in the wrong order; the others show how far each is.
  auto expected = predictions(0.0005);
  expected[4].position_m = rest_m_[3] + Eigen::Vector3d(0.002, 0, -0.001);
  expected[3].position_m = rest_m_[3] + Eigen::Vector3d(0.002, 0, -0.002);
  expected[3].covariance_m2 = expected[4].covariance_m2 = 1e-4 * Eigen::Matrix3d::Identity();
  std::vector<std::vector<int>> chain = {{1}, {0, 2}, {1, 3}, {2}, {}};
  expected[3].position_m = rest_m_[2] + 0.013 * (expected[3].position_m - rest_m_[2]).normalized();
  const auto found = identify({sight(rest_m_[4]), sight(rest_m_[3]), sight(rest_m_[2])}, expected, chain, 25);
  EXPECT_EQ(found[3], 1);
  EXPECT_EQ(found[4], 0);
}

TEST_F(MarkerIdentity, ColoursForbidWhatTheyAreGivenFor) {
  auto expected = predictions(0.01);
  expected.resize(2);
  expected[0].colour = 1;
  MarkerDetection red = sight(rest_m_[1]), blue = sight(rest_m_[0]);
  red.colour = 1;
  blue.colour = 0;
  const auto found = identify({blue, red}, expected, {{1}, {0}}, 25);
  EXPECT_EQ(found, (std::vector<int>{1, 0}));
}

}  // namespace
}  // namespace soft_robot_lab
