// SPDX-License-Identifier: BSD-3-Clause
#include "control/motion/path_follower.h"

#include <cmath>
#include <deque>

#include <gtest/gtest.h>

#include "straight_plan.h"

namespace soft_robot_lab {
namespace {

constexpr double kPeriod_s = 1.0 / 28.0;

// The robot does what its model says `lag_s` later, less `off_m`; its markers come `delay_s` after their frame.
class Robot {
 public:
  Robot(const PathPlan& plan, Eigen::Vector3d off_m, double lag_s, double delay_s)
      : plan_(plan), off_m_(std::move(off_m)), lag_s_(lag_s), delay_s_(delay_s) {}

  void command(double time_s, const Eigen::VectorXd& commands) { sent_.push_back({time_s, commands}); }

  Eigen::Vector3d marker(double time_s) const {
    Eigen::VectorXd commands = plan_.samples.front().commands;
    for (const auto& [at_s, values] : sent_)
      if (at_s <= time_s - lag_s_ + 1e-9) commands = values;
    return plan_.samples.front().jacobian * (commands - plan_.samples.front().commands) + off_m_;
  }

  std::optional<StampedMarker> sight(double time_s) {
    frames_.push_back({time_s, marker(time_s)});
    std::optional<StampedMarker> newest;
    while (!frames_.empty() && frames_.front().stamp_s + delay_s_ <= time_s + 1e-9) {
      newest = frames_.front();
      frames_.pop_front();
    }
    return newest;
  }

 private:
  const PathPlan& plan_;
  Eigen::Vector3d off_m_;
  double lag_s_, delay_s_;
  std::vector<std::pair<double, Eigen::VectorXd>> sent_;
  std::deque<StampedMarker> frames_;
};

double error_after_m(double from_s, double delay_s, double gain, bool feedback = true) {
  const PathPlan plan = straight();
  FollowOptions options;
  options.gain = gain;
  options.feedback = feedback;
  options.damping = 0.01;
  options.drive_lag_s = options.lead_s = kPeriod_s;
  options.hold_after_s = 1.0;
  PathFollower follower(plan, options);
  Robot robot(plan, {0.001, 0, -0.002}, kPeriod_s, delay_s);
  double worst_m = 0.0;
  for (int i = 0; i * kPeriod_s < 9.9; ++i) {
    const double time_s = i * kPeriod_s;
    const FollowStep step = follower.next(time_s, robot.sight(time_s), "");
    robot.command(time_s, step.commands);
    if (time_s > from_s) worst_m = std::max(worst_m, (robot.marker(time_s) - plan.target_at(time_s)).norm());
  }
  return worst_m;
}

TEST(PathFollower, TakesAConstantDisturbanceOffHoweverLateFramesAre) {
  EXPECT_GT(error_after_m(2.0, 0.08, 0.3, false), 0.002);
  for (const double delay_s : {0.0, 0.05, 0.12, 0.3}) EXPECT_LT(error_after_m(3.0, delay_s, 0.3), 2e-5) << delay_s;
  EXPECT_LT(error_after_m(2.0, 0.12, 1.0), 2e-5);  // as late frames do not correct twice
}

TEST(PathFollower, HoldsThenStopsWhereTheMarkerIsLost) {
  const PathPlan plan = straight();
  FollowOptions options;
  options.hold_after_s = 0.3;
  options.lost_after_s = 1.0;
  PathFollower follower(plan, options);
  FollowStep step;
  double held_from_s = -1.0, ended_s = -1.0;
  Eigen::VectorXd held;
  for (int i = 0; ended_s < 0.0 && i < 1000; ++i) {
    const double time_s = i * kPeriod_s;
    std::optional<StampedMarker> sight;
    if (time_s < 2.0) sight = StampedMarker{time_s, plan.target_at(time_s)};
    step = follower.next(time_s, sight, "");
    if (step.holding && held_from_s < 0.0) {
      held_from_s = time_s;
      held = step.commands;
    }
    if (step.end != PathEnd::none) ended_s = time_s;
  }
  EXPECT_NEAR(held_from_s, 2.3, 0.1);
  EXPECT_NEAR(ended_s, 3.0, 0.1);
  EXPECT_EQ(step.end, PathEnd::marker_lost);
  EXPECT_NE(step.reason.find("tip"), std::string::npos);
  EXPECT_EQ(step.commands, held);
  EXPECT_EQ(follower.next(20.0, StampedMarker{20.0, plan.target_at(2.0)}, "").end, PathEnd::marker_lost);
}

TEST(PathFollower, GoesOnWhereItHeldWhenTheMarkerIsBack) {
  const PathPlan plan = straight();
  PathFollower follower(plan, {});
  FollowStep step;
  int periods = 0;
  for (; step.end == PathEnd::none && periods < 1000; ++periods) {
    const double time_s = periods * kPeriod_s;
    std::optional<StampedMarker> sight;
    if (time_s < 2.0 || time_s > 3.5) sight = StampedMarker{time_s, plan.target_at(step.path_s + kPeriod_s)};
    const Eigen::VectorXd before = step.commands;
    step = follower.next(time_s, sight, "");
    if (before.size() > 0) {
      EXPECT_LT((step.commands - before).cwiseAbs().maxCoeff(), 0.002);  // no jump
    }
  }
  EXPECT_EQ(step.end, PathEnd::done);
  EXPECT_NEAR(periods * kPeriod_s, 10.0 + 1.2, 0.15);  // it held for 1.2 s
}

TEST(PathFollower, AFaultStopsItWithItsReason) {
  const PathPlan plan = straight();
  PathFollower follower(plan, {});
  const FollowStep before = follower.next(0.0, std::nullopt, "");
  const FollowStep step = follower.next(0.1, StampedMarker{0.05, plan.target_at(0.05)}, "left: stalled");
  EXPECT_EQ(step.end, PathEnd::fault);
  EXPECT_NE(step.reason.find("left: stalled"), std::string::npos);
  EXPECT_EQ(step.commands, before.commands);
}

TEST(PathFollower, NeverCommandsBeyondLimitsNorRates) {
  const PathPlan plan = straight(0.95, 1.15);
  FollowOptions options;
  options.largest_error_m = 1.0;
  PathFollower follower(plan, options);
  Eigen::VectorXd before = plan.samples.front().commands;
  for (int i = 0; i < 200; ++i) {
    const double time_s = i * kPeriod_s;
    const FollowStep step = follower.next(time_s, StampedMarker{time_s, {i % 60 < 30 ? 0.5 : -0.5, 0, 0.3}}, "");
    EXPECT_GE(step.commands.minCoeff(), 0.95);
    EXPECT_LE(step.commands.maxCoeff(), 1.15);
    EXPECT_LE((step.commands - before).cwiseAbs().maxCoeff(), 1.0 * kPeriod_s + 1e-12);
    before = step.commands;
  }
}

TEST(PathFollower, StopsWhereTheMarkerIsFarFromItsPath) {
  const PathPlan plan = straight();
  FollowOptions options;
  options.largest_error_m = 0.01;
  PathFollower follower(plan, options);
  follower.next(0.0, std::nullopt, "");
  const FollowStep step = follower.next(0.1, StampedMarker{0.05, {0.05, 0, 0}}, "");
  EXPECT_EQ(step.end, PathEnd::error_too_large);
  EXPECT_NE(step.reason.find("mm"), std::string::npos);
}

TEST(PathFollower, SightsThatAreNoNumbersCountAsNone) {
  const PathPlan plan = straight();
  PathFollower follower(plan, {});
  follower.next(0.0, std::nullopt, "");
  const FollowStep step = follower.next(0.1, StampedMarker{0.05, {std::nan(""), 0, 0}}, "");
  EXPECT_TRUE(step.commands.allFinite());
  EXPECT_TRUE(follower.disturbance_m().isZero(0.0));
}

TEST(PathFollower, RefusesWhatIsNoPlanAndNoOption) {
  PathPlan plan = straight();
  plan.complete = false;
  EXPECT_THROW(PathFollower(plan, {}), std::invalid_argument);
  FollowOptions options;
  options.gain = 0.0;
  EXPECT_THROW(PathFollower(straight(), options), std::invalid_argument);
  options = {};
  options.lost_after_s = options.hold_after_s;
  EXPECT_THROW(PathFollower(straight(), options), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
