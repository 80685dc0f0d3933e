// SPDX-License-Identifier: BSD-3-Clause
#include "session/execution.h"

#include <atomic>
#include <future>
#include <thread>

#include <gtest/gtest.h>

#include "../control/motion/straight_plan.h"

namespace soft_robot_lab {
namespace {

using Values = std::vector<double>;

// A policy in a thread of its own, markers that the test sends, and a clock that the test sets.
class Executed : public testing::Test {
 protected:
  static CommandPolicy to(double value) { return {{"left"}, {{0.0, {1.0}}, {1.0, {value}}}}; }

  void start(const ExecutionOrder& order) {
    report_ = std::async(std::launch::async, [this, order] { return execution_.execute(order); });
    while (!execution_.running() && report_.wait_for(std::chrono::milliseconds(1)) != std::future_status::ready) {
    }
  }

  // Markers at 100 Hz, `moving` until then and at rest afterwards.
  void send_markers(double from_s, double to_s, double moving_until_s = 0.0) {
    for (double stamp_s = from_s; stamp_s < to_s; stamp_s += 0.01)
      execution_.add_simulated(stamp_s, {{std::min(stamp_s, moving_until_s), 0.0, 0.0}});
  }

  static MotorWatchReport motors(const std::string& fault = "") { return {true, false, false, {"left"}, {fault}}; }

  std::atomic<double> machine_s_ = 100.0;
  std::vector<double> sent_;
  Execution execution_{ClosedLoopOptions(),
                       {[this](const auto&, const Values& values) { sent_.push_back(values[0]); },
                        [this] { return machine_s_.load(); }}};
  std::future<ExecutionReport> report_;
};

TEST_F(Executed, PlaysByTheStampsOfMarkersAndAnswersAtRest) {
  start({to(0.8), {1.0}});
  send_markers(50.0, 52.55, 52.0);
  const ExecutionReport report = report_.get();
  EXPECT_TRUE(report.success) << report.message;
  ASSERT_GT(sent_.size(), 90u);
  EXPECT_EQ(sent_.front(), 1.0);
  EXPECT_EQ(sent_.back(), 0.8);
  EXPECT_NEAR(sent_[50], 0.9, 1e-9);          // half way after half a second
  EXPECT_NEAR(report.duration_s, 2.5, 0.06);  // they move for 2 s, and count as resting 0.5 s later
  EXPECT_EQ(report.values, Values{0.8});
}

TEST_F(Executed, AwaitsRestFromWhereTheDrivesHeardTheLastCommand) {
  execution_.add_drives({"right", "left"}, {1.0, 1.0});
  start({to(0.8), {1.0}});
  send_markers(50.0, 54.0);  // at rest, far ahead of what the drives have heard
  EXPECT_NE(report_.wait_for(std::chrono::milliseconds(300)), std::future_status::ready);
  execution_.add_drives({"right", "left"}, {1.0, 0.8});
  send_markers(54.0, 55.05, 54.5);
  const ExecutionReport report = report_.get();
  EXPECT_TRUE(report.success) << report.message;
  EXPECT_NEAR(report.duration_s, 5.0, 0.06);
}

TEST_F(Executed, ReportsWhereTheDrivesNeverHearTheLastCommand) {
  execution_.add_drives({"left"}, {1.0});
  start({to(0.8), {1.0}, true, 3.0});
  send_markers(50.0, 53.2);
  const ExecutionReport report = report_.get();
  EXPECT_FALSE(report.success);
  EXPECT_NE(report.message.find("has not heard the last command within 3"), std::string::npos) << report.message;
}

// Motors get the last command again and again, which changes nothing of what the drives have heard.
TEST_F(Executed, RestsWhereMotorsGetTheLastCommandAgain) {
  execution_.add_motors(motors());
  start({to(0.8), {1.0}});
  for (int i = 0; i < 110; ++i) {  // no faster than motors are commanded
    machine_s_ = 100.0 + 0.01 * i;
    execution_.add_motors(motors());
    execution_.add_simulated(50.0 + 0.01 * i, {{0.0, 0.0, 0.0}});
  }
  execution_.add_drives({"left"}, {0.8});
  send_markers(51.1, 51.8);
  EXPECT_EQ(report_.wait_for(std::chrono::seconds(5)), std::future_status::ready);
  execution_.cancel();
  EXPECT_TRUE(report_.get().success);
}

// A tip may stand while the play of a drive is turned through.
TEST_F(Executed, DoesNotRestWhileMotorsMove) {
  MotorWatchReport moving = motors();
  moving.moving = true;
  execution_.add_motors(moving);
  start({to(0.8), {1.0}});
  for (int i = 0; i < 300; ++i) {
    machine_s_ = 100.0 + 0.01 * i;
    execution_.add_motors(moving);
    execution_.add_simulated(50.0 + 0.01 * i, {{0.0, 0.0, 0.0}});
  }
  EXPECT_NE(report_.wait_for(std::chrono::milliseconds(300)), std::future_status::ready);
  execution_.add_motors(motors());
  send_markers(53.0, 53.8);
  EXPECT_EQ(report_.wait_for(std::chrono::seconds(5)), std::future_status::ready);
  execution_.cancel();
  EXPECT_TRUE(report_.get().success);
}

TEST_F(Executed, AnswersAtTheLastCommandWhereRestIsNotAwaited) {
  start({to(0.8), {1.0}, false});
  send_markers(50.0, 51.1, 60.0);
  EXPECT_NEAR(report_.get().duration_s, 1.05, 0.06);
}

TEST_F(Executed, EndsAtItsLimitOfTime) {
  start({to(0.8), {1.0}, true, 3.0});
  send_markers(50.0, 53.2, 60.0);
  const ExecutionReport report = report_.get();
  EXPECT_FALSE(report.success);
  EXPECT_NE(report.message.find("not at rest within 3"), std::string::npos) << report.message;
}

TEST_F(Executed, EndsWhereTheClockJumps) {
  start({to(0.8), {1.0}});
  send_markers(50.0, 50.5);
  send_markers(40.0, 40.1);
  EXPECT_NE(report_.get().message.find("the clock was set"), std::string::npos);
  for (const double value : sent_) EXPECT_GT(value, 0.89);
}

TEST_F(Executed, EndsWhereNoMarkersCome) {
  start({to(0.8), {1.0}});
  send_markers(50.0, 50.5);
  machine_s_ = 111.0;
  EXPECT_NE(report_.get().message.find("no markers came"), std::string::npos);
}

TEST_F(Executed, HoldsTheCommandsOfAMotorThatMayNotMove) {
  execution_.add_motors(motors());
  start({to(0.8), {1.0}});
  send_markers(50.0, 50.5);
  execution_.add_motors(motors("stalled"));
  const size_t sent = sent_.size();
  send_markers(50.5, 51.5);
  const ExecutionReport report = report_.get();
  EXPECT_NE(report.message.find("motor left: stalled"), std::string::npos) << report.message;
  EXPECT_EQ(sent_.size(), sent);
}

TEST_F(Executed, SendsNothingWhereAMotorMayNotMoveAtTheStart) {
  execution_.add_motors(motors("stalled"));
  start({to(0.8), {1.0}});
  EXPECT_THROW(report_.get(), std::runtime_error);
  EXPECT_TRUE(sent_.empty());
}

TEST_F(Executed, GivesMotorsTenMillisecondsBetweenCommands) {
  execution_.add_motors(motors());
  start({to(0.8), {1.0}});
  for (int i = 0; i < 100; ++i) {  // markers ten times as fast as the machine's clock allows
    machine_s_ = 100.0 + 0.001 * i;
    execution_.add_simulated(50.0 + 0.01 * i, {{0.0, 0.0, 0.0}});
  }
  EXPECT_LE(sent_.size(), 11u);
  EXPECT_TRUE(execution_.cancel());
  EXPECT_EQ(report_.get().message, "cancelled");
}

TEST_F(Executed, RefusesASecondPolicyWhileOneRuns) {
  start({to(0.8), {1.0}});
  const ExecutionOrder second{to(0.7), {1.0}};
  EXPECT_THROW(execution_.execute(second), std::runtime_error);
  execution_.cancel();
  EXPECT_FALSE(report_.get().success);
  EXPECT_FALSE(execution_.running());
}

// A path of 10 s, which begins where both commands are 1; the marker is where the first one takes it.
class Followed : public Executed {
 protected:
  void follow(bool feedback) {
    FollowOptions options;
    options.feedback = feedback;
    follower_.emplace(straight(), options);
    ExecutionOrder order{{{"left", "right"}, {{0.1, {1.0, 1.0}}}}, {1.0, 1.0}};
    order.follower = &*follower_;
    order.on_path = [this](double path_s, std::optional<double>) { path_s_ = path_s; };
    start(order);
  }

  // Until the execution ended, or the path is there; the marker is `off_m` beside where commands take it.
  void run(double until_path_s, double off_m, bool tracked) {
    while (path_s_ < until_path_s && report_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
      const double x_m = sent_.empty() ? 0.0 : 0.1 * (sent_.back() - 1.0) + off_m;
      if (tracked) execution_.add_measured({now_s_, {{"toe", {9, 9, 9}}, {"tip", {x_m, 0, 0}}}});
      execution_.add_simulated(now_s_ += 0.01, {{x_m, 0, 0}});
      std::this_thread::yield();
    }
  }

  std::optional<PathFollower> follower_;
  double now_s_ = 50.0, path_s_ = -1.0;
};

TEST_F(Followed, APathBeginsWhereThePolicyRests) {
  follow(false);
  run(100.0, 0.001, true);
  const ExecutionReport report = report_.get();
  EXPECT_TRUE(report.success) << report.message;
  EXPECT_NEAR(path_s_, 10.0, 1e-9);
  EXPECT_NEAR(sent_.back(), 1.2, 1e-9);
  EXPECT_NEAR(*report.measured_path_rms_m, 0.001, 1e-4);
  EXPECT_NEAR(*report.simulated_path_rms_m, 0.001, 1e-4);
  EXPECT_NEAR(report.measured_path.time_s.back(), 10.0, 0.05);
  EXPECT_EQ(report.measured_path.time_s.size(), report.measured_path.position_m.size());
}

TEST_F(Followed, TrackedMarkersCorrectIt) {
  follow(true);
  run(100.0, 0.001, true);
  const ExecutionReport report = report_.get();
  EXPECT_TRUE(report.success) << report.message;
  EXPECT_LT(*report.measured_path_rms_m, 5e-4);
  EXPECT_NEAR(sent_.back(), 1.19, 1e-3);
}

TEST_F(Followed, AMarkerThatIsLostEndsIt) {
  follow(true);
  run(3.0, 0.0, true);
  run(100.0, 0.0, false);
  const ExecutionReport report = report_.get();
  EXPECT_FALSE(report.success);
  EXPECT_NE(report.message.find("marker 'tip' was not seen for 2"), std::string::npos) << report.message;
  EXPECT_NE(report.message.find("the commands are held"), std::string::npos) << report.message;
  EXPECT_NEAR(sent_.back(), 1.0 + 0.02 * 3.3, 0.004);  // it waits after 0.3 s
}

TEST_F(Followed, AMotorThatMayNotMoveEndsIt) {
  follow(false);
  run(3.0, 0.0, false);
  execution_.add_motors({true, false, false, {"left", "right"}, {"", "stalled"}});
  const size_t sent = sent_.size();
  run(100.0, 0.0, false);
  const ExecutionReport report = report_.get();
  EXPECT_NE(report.message.find("motor right: stalled; the commands are held"), std::string::npos) << report.message;
  EXPECT_EQ(sent_.size(), sent);
}

TEST_F(Followed, IsCancelled) {
  follow(false);
  run(3.0, 0.0, false);
  EXPECT_TRUE(execution_.cancel());
  run(100.0, 0.0, false);
  EXPECT_EQ(report_.get().message, "cancelled");
  EXPECT_LT(path_s_, 3.1);
}

TEST(MotorWatch, NamesWhatKeepsMotorsStill) {
  MotorWatch watch;
  EXPECT_EQ(watch.fault({"left"}, 0.0), "");  // none ever reported
  watch.add({true, false, true, {"left", "right"}, {"", "stalled"}}, 10.0);
  EXPECT_TRUE(watch.moving());
  EXPECT_EQ(watch.fault({"left"}, 10.5), "");
  EXPECT_EQ(watch.fault({"left", "right"}, 10.5), "motor right: stalled");
  EXPECT_EQ(watch.fault({"left"}, 11.5), "the motors' node is silent");
  watch.add({false, false, false, {"left"}, {""}}, 12.0);
  EXPECT_EQ(watch.fault({"left"}, 12.0), "no link to the motors' board");
  watch.add({true, true, false, {"left"}, {""}}, 13.0);
  EXPECT_EQ(watch.fault({"left"}, 13.0), "emergency stop; clear it with motor/clear");
}

}  // namespace
}  // namespace soft_robot_lab
