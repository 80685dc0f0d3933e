#include "soft_robot_lab/ros/measured_rest.h"

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

MarkerObservations tip_at(double stamp_s, double x_m, std::uint8_t source = MarkerObservations::SEEN) {
  MarkerObservations markers;
  markers.header.stamp = ros::Time(stamp_s);
  markers.names = {"tip"};
  markers.positions.resize(1);
  markers.positions[0].x = x_m;
  markers.sources = {source};
  return markers;
}

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

TEST(MeasuredRest, DoesNotCountWhatWasNotSeenOrCameBefore) {
  MeasuredRest rest;
  rest.start(10.0);
  for (int i = 0; i < 30; ++i) EXPECT_TRUE(rest.add(tip_at(9.9, 0.001)));
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(rest.add(tip_at(10.1 + 0.1 * i, 0.001, MarkerObservations::INTERPOLATED)));
  EXPECT_FALSE(rest.at_rest());
}

}  // namespace
}  // namespace soft_robot_lab
