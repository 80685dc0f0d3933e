// SPDX-License-Identifier: BSD-3-Clause
#include "ros/cameras/seen_robot.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "seen_messages.h"

namespace soft_robot_lab {
namespace {

TEST(JoinedSkin, JoinsCornersThatAreOne) {
  const JoinedSkin skin(surface(0).points);
  ASSERT_EQ(skin.triangles().cols(), 2);
  EXPECT_EQ(skin.triangles().maxCoeff(), 3);
  EXPECT_EQ(skin.triangles()(2, 0), skin.triangles()(0, 1));
  const auto moved_m = skin.vertices_m(surface(0, 0.25).points);
  ASSERT_TRUE(moved_m);
  EXPECT_EQ(moved_m->cols(), 4);
  EXPECT_EQ(moved_m->col(skin.triangles()(1, 0)), Eigen::Vector3d(0.35, 0, 0));
}

TEST(JoinedSkin, TellsAnotherSkin) {
  const JoinedSkin skin(surface(0).points);
  auto torn = surface(0).points;
  torn.back().x += 0.01;
  EXPECT_FALSE(skin.vertices_m(torn));
  torn.resize(3);
  EXPECT_FALSE(skin.vertices_m(torn));
}

TEST(SeenRobotStates, PairsSkinAndMarkersOfOneStampInAnyOrder) {
  for (const bool skin_first : {false, true}) {
    SeenRobotStates states;
    if (skin_first) states.add_surface(surface(1));
    states.add_markers(markers(1));
    if (!skin_first) {
      EXPECT_FALSE(states.newest());
      states.add_surface(surface(1));
    }
    ASSERT_TRUE(states.newest());
    EXPECT_EQ(states.newest()->stamp, ros::Time(1.0));
    EXPECT_EQ(states.newest()->motion.interval_s, 0);
  }
}

TEST(SeenRobotStates, NeverShowsMarkersOffTheirSkin) {
  SeenRobotStates states;
  for (int step = 0; step < 8; ++step) {  // skins half as often as markers, both going 5 mm a step
    const double stamp_s = 1 + 0.015625 * step, x = 0.005 * step;
    states.add_markers(markers(stamp_s, x));
    if (step % 2 == 0) states.add_surface(surface(stamp_s, x));
    const auto moment = states.newest();
    ASSERT_TRUE(moment);
    EXPECT_EQ(moment->motion.present.stickers_m(0, 0), moment->motion.present.vertices_m(0, 0));
    EXPECT_EQ(moment->stamp, ros::Time(1 + 0.015625 * (step - step % 2)));
  }
  const auto moment = states.newest();
  EXPECT_NEAR(moment->motion.interval_s, 0.03125, 1e-9);
  EXPECT_NEAR(moment->motion.present.vertices_m(0, 0) - moment->motion.before.vertices_m(0, 0), 0.01, 1e-12);
}

TEST(SeenRobotStates, GoesOnWithTheSkinOfABodyAtRest) {
  SeenRobotStates states;
  states.add_surface(surface(1));  // latched, long ago
  for (int step = 0; step < 5; ++step) states.add_markers(markers(9 + step));
  ASSERT_TRUE(states.newest());
  EXPECT_EQ(states.newest()->stamp, ros::Time(12.0));  // the last one's skin may be on its way
  EXPECT_EQ(states.newest()->motion.interval_s, 0);
}

TEST(SeenRobotStates, TellsThatAStageNoLongerFits) {
  SeenRobotStates states;
  states.add_markers(markers(1));
  states.add_surface(surface(1));
  const int version = states.version();
  states.add_markers(markers(2, 0.1));
  states.add_surface(surface(2, 0.1));
  EXPECT_EQ(states.version(), version);
  MarkerObservations renamed = markers(3, 0.1);
  renamed.names = {"tail"};
  states.add_markers(renamed);
  states.add_surface(surface(3, 0.2));
  EXPECT_NE(states.version(), version);
  EXPECT_EQ(states.marker_names(), std::vector<std::string>{"tail"});
  EXPECT_EQ(states.newest()->motion.interval_s, 0);
}

TEST(SeenRobotStates, StartsAnewWhenTimeGoesBack) {
  for (const bool skin_first : {false, true}) {
    SeenRobotStates states;
    states.add_markers(markers(100));
    states.add_surface(surface(100));
    const int version = states.version();
    if (skin_first) states.add_surface(surface(1, 0.3));
    states.add_markers(markers(1, 0.3));
    if (!skin_first) states.add_surface(surface(1, 0.3));
    ASSERT_TRUE(states.newest());
    EXPECT_EQ(states.newest()->stamp, ros::Time(1.0));
    EXPECT_EQ(states.newest()->motion.present.vertices_m(0, 0), 0.3);
    EXPECT_NE(states.version(), version);
  }
}

TEST(SeenRobotStates, TellsNoVelocityWhereTheClockIsSet) {
  SeenRobotStates states;
  for (const double stamp_s : {1.0, 1.8e9, 4.0e9, 0.5}) {
    states.add_surface(surface(stamp_s));
    states.add_markers(markers(stamp_s));
    ASSERT_TRUE(states.newest());
    EXPECT_EQ(states.newest()->motion.interval_s, 0) << stamp_s;
  }
}

TEST(SeenRobotStates, RefusesWhatCannotBeDrawn) {
  SeenRobotStates states;
  states.add_markers(markers(1));
  states.add_surface(surface(1));
  auto bad_surface = surface(2);
  bad_surface.points[1].y = NAN;
  EXPECT_THROW(states.add_surface(bad_surface), std::invalid_argument);
  bad_surface = surface(2);
  bad_surface.points.pop_back();
  EXPECT_THROW(states.add_surface(bad_surface), std::invalid_argument);
  bad_surface = surface(2);
  bad_surface.header.frame_id = "elsewhere";
  EXPECT_THROW(states.add_surface(bad_surface), std::invalid_argument);
  MarkerObservations bad_markers = markers(2);
  bad_markers.positions.clear();
  EXPECT_THROW(states.add_markers(bad_markers), std::invalid_argument);
  bad_markers = markers(2, INFINITY);
  EXPECT_THROW(states.add_markers(bad_markers), std::invalid_argument);
  EXPECT_EQ(states.newest()->stamp, ros::Time(1.0));
}

}  // namespace
}  // namespace soft_robot_lab
