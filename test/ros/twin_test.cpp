// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <soft_robot_lab/TwinLoads.h>
#include <std_srvs/Trigger.h>
#include <visualization_msgs/MarkerArray.h>

#include "ros/messages/conversions.h"
#include "ros/base/topics.h"
#include "session_ears.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

constexpr double kNoise_m = 2.0e-5;

class TwinSession : public testing::Test {
 protected:
  TwinSession() {
    SceneOptions options;
    options.actuator_factory = make_actuator;
    robot_ = load_scene(std::string(SOFT_ROBOT_LAB_SOURCE) + "/test/data/scenes/pushed_bar.yaml", options).simulation;
    if (!robot_->solve_equilibrium().converged) throw std::runtime_error("the bar finds no rest");
    markers_ = node_.advertise<MarkerObservations>(topics::tracker_markers, 10);
    loads_ = node_.subscribe<TwinLoads>(topics::twin_loads, 10, [this](const TwinLoads::ConstPtr& m) { heard_ = *m; });
    timer_ = node_.createWallTimer(ros::WallDuration(1.0 / 30.0), [this](const auto&) { film(); });
  }

  // As a tracker would see the robot now.
  void film() {
    MarkerObservations seen = marker_observations(*robot_, ros::Time::now());
    std::fill(seen.sources.begin(), seen.sources.end(), MarkerObservations::SEEN);
    for (std::size_t i = 0; i < seen.names.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        seen.covariances[9 * i + 4 * static_cast<std::size_t>(axis)] = kNoise_m * kNoise_m;
    markers_.publish(seen);
  }

  void push(const Eigen::Vector3d& rest_m, const Eigen::Vector3d& force_n) {
    robot_->pull({{MeshLocator(robot_->body().mesh()).embed(rest_m), force_n}});
    ASSERT_TRUE(robot_->solve_equilibrium().converged);
  }

  bool hears(std::uint8_t kind) {
    heard_.reset();
    return spin_until([&] { return heard_ && heard_->kind == kind; }, 60.0);
  }

  ros::NodeHandle node_;
  std::unique_ptr<Simulation> robot_;
  ros::Publisher markers_;
  ros::Subscriber loads_;
  ros::WallTimer timer_;
  std::optional<TwinLoads> heard_;
};

TEST_F(TwinSession, SaysWhatPushesTheRobotAndThatNothingDoes) {
  ASSERT_TRUE(hears(TwinLoads::NONE));
  const Eigen::Vector3d at_m(0.0, -0.008, -0.075), force_n(0.0, 0.05, 0.0);
  push(at_m, force_n);
  ASSERT_TRUE(hears(TwinLoads::PUSH));
  ASSERT_EQ(heard_->positions.size(), 1u);
  ASSERT_EQ(heard_->position_covariances.size(), 9u);
  const Eigen::Vector3d true_m = MeshLocator(robot_->body().mesh()).embed(at_m).at(robot_->state().positions_m);
  EXPECT_LT((from_message(heard_->positions[0], "positions") - true_m).norm(), 0.006);
  EXPECT_LT((from_message(heard_->forces[0], "forces") - force_n).norm(), 0.01);
  EXPECT_EQ(heard_->header.frame_id, "robot_base");
  const auto arrows = hear<visualization_msgs::MarkerArray>(node_, topics::twin_arrows);
  EXPECT_EQ(arrows->markers.size(), 4u) << "what clears, an arrow, its size, and where it may be";
  robot_->pull({});
  ASSERT_TRUE(robot_->solve_equilibrium().converged);
  EXPECT_TRUE(hears(TwinLoads::NONE));
}

TEST_F(TwinSession, GoesOnAfterWhatCannotBe) {
  ASSERT_TRUE(hears(TwinLoads::NONE));
  MarkerObservations bad = marker_observations(*robot_, ros::Time::now());
  bad.sources.assign(bad.sources.size(), MarkerObservations::SEEN);
  bad.covariances.pop_back();
  markers_.publish(bad);
  bad = marker_observations(*robot_, ros::Time::now());
  bad.positions[0].x = std::numeric_limits<double>::quiet_NaN();
  markers_.publish(bad);
  EXPECT_TRUE(hears(TwinLoads::NONE));
}

TEST_F(TwinSession, TakesTheNextRestForUntouchedWhereAsked) {
  ASSERT_TRUE(hears(TwinLoads::NONE));
  push({0.0, -0.008, -0.075}, {0.0, 0.05, 0.0});
  ASSERT_TRUE(hears(TwinLoads::PUSH));
  EXPECT_TRUE(ask<std_srvs::Trigger>(node_, topics::twin_untouched).success);
  EXPECT_TRUE(hears(TwinLoads::NONE));
  robot_->pull({});
  ASSERT_TRUE(robot_->solve_equilibrium().converged);
  EXPECT_TRUE(ask<std_srvs::Trigger>(node_, topics::twin_untouched).success);
  EXPECT_TRUE(hears(TwinLoads::NONE));
}

}  // namespace
}  // namespace soft_robot_lab
