// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/motion/plan_motion.h"

#include <cmath>

#include <gtest/gtest.h>

#include "../cabled_bar.h"

namespace soft_robot_lab {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

Eigen::Vector3d tip_at(double left, double right) {
  Simulation model = bar();
  model.set_command("left", left);
  model.set_command("right", right);
  EXPECT_TRUE(model.solve_equilibrium().converged);
  return model.marker_position(model.marker_index("tip"));
}

// Both cables pull, less than buckles the bar.
PathTask corner() {
  PathTask task;
  task.marker = "tip";
  task.curve = Curve({tip_at(0.97, 0.985), tip_at(0.98, 0.975), tip_at(0.98, 0.985)});
  task.samples = 9;
  return task;
}

std::vector<PathDrive> drives(double rate_per_s = kInf, double play = 0.0) {
  return {{"left", 0.8, 1.1, rate_per_s, play}, {"right", 0.8, 1.1, rate_per_s, play}};
}

TEST(PlanMotion, MeetsAPathWithinReachAtAllSamples) {
  Simulation model = bar();
  const PathPlan plan = plan_motion(model, corner(), drives());
  ASSERT_TRUE(plan.complete) << plan.message;
  ASSERT_EQ(plan.samples.size(), 9u);
  EXPECT_LT(plan.largest_unreachable_m(), 1e-4);  // a fifth of the tolerance, where a step of the search gains less
  for (const PathSample& sample : plan.samples) {
    const Eigen::Vector3d there_m = tip_at(sample.commands[0], sample.commands[1]);
    EXPECT_LT((there_m - sample.target_m).norm(), 1e-4);
    EXPECT_LT((there_m - sample.predicted_m).norm(), 1e-5);
  }
}

TEST(PlanMotion, SaysByHowMuchAPathLeavesWhatIsInReach) {
  Simulation model = bar();
  PathTask beyond = corner();
  beyond.curve = Curve({tip_at(0.98, 0.985), Eigen::Vector3d(0.105, 0, 0)});  // cables do not push: it ends at 0.1
  const PathPlan plan = plan_motion(model, beyond, drives());
  ASSERT_TRUE(plan.complete) << plan.message;
  EXPECT_LT(plan.samples.front().unreachable_m, 2e-5);
  EXPECT_NEAR(plan.samples.back().unreachable_m, 0.005, 1e-4);
  EXPECT_NEAR(plan.largest_unreachable_m(), 0.005, 1e-4);
}

TEST(PlanMotion, KeepsItsLimits) {
  Simulation model = bar();
  PathTask task = corner();
  task.bounds = {{"left", 0.975, 1.1}};
  const PathPlan plan = plan_motion(model, task, drives());
  for (const PathSample& sample : plan.samples) EXPECT_GE(sample.commands[0], 0.975);
  EXPECT_GT(plan.largest_unreachable_m(), 1e-4);
  task.bounds = {{"left", 0.95, 0.9}};
  EXPECT_THROW(plan_motion(model, task, drives()), std::invalid_argument);
  task.bounds = {};
  task.marker = "toe";
  EXPECT_THROW(plan_motion(model, task, drives()), std::invalid_argument);
}

void expect_rates(const PathPlan& plan, double rate_per_s) {
  PlayInverse play(plan.drives);
  Eigen::VectorXd before = play.go(plan.samples.front().commands);
  for (std::size_t k = 1; k < plan.samples.size(); ++k) {
    const Eigen::VectorXd after = play.go(plan.samples[k].commands);
    const double passed_s = plan.samples[k].time_s - plan.samples[k - 1].time_s;
    EXPECT_LE((after - before).cwiseAbs().maxCoeff(), rate_per_s * passed_s * (1 + 1e-9)) << k;
    before = after;
  }
}

TEST(PlanMotion, TimesKeepTheDrivesSpeeds) {
  Simulation model = bar();
  PathTask task = corner();
  task.duration_s = 0.0;
  PathPlan plan = plan_motion(model, task, drives(0.02, 0.004));
  expect_rates(plan, 0.02);
  EXPECT_NEAR(plan.duration_s(), plan.fastest_s, 1e-9);
  EXPECT_GT(plan.fastest_s, 1.0);  // two commands by 0.01 and more, and play
  const double with_play_s = plan.fastest_s;
  retime(plan, 10.0);
  EXPECT_NEAR(plan.duration_s(), 10.0, 0.1 * 10.0);  // slower only where a drive turns through its play
  EXPECT_NEAR(plan.fastest_s, with_play_s, 1e-12);
  expect_rates(plan, 0.02);
  for (PathDrive& drive : plan.drives) drive.play = 0.0;
  retime(plan, 0.0);
  EXPECT_LT(plan.fastest_s, with_play_s);
  EXPECT_THROW(retime(plan, -1.0), std::invalid_argument);
}

double rms_m(const PathPlan& plan, const MarkerTrack& track) {
  double squares_m2 = 0.0;
  for (const PathSample& sample : plan.samples) squares_m2 += (track.at(sample.time_s) - sample.aim_m).squaredNorm();
  return std::sqrt(squares_m2 / static_cast<double>(plan.samples.size()));
}

TEST(PlanMotion, LearningOnAnotherRobotLessensItsErrors) {
  Simulation model = bar();
  PathTask task = corner();
  task.duration_s = 4.0;
  PathPlan plan = plan_motion(model, task, drives());
  Simulation other = bar({}, 264200.0, {0, 2.0, 0});  // gravity pulls it aside, of which the plan knows nothing
  LearnOptions options;
  options.gain = 0.8;
  options.smoothing = 0;
  options.damping = 0.02;
  MarkerTrack track = play_in_time(other, plan);
  const double before_m = rms_m(plan, track);
  for (int round = 0; round < 3; ++round) {
    const double now_m = rms_m(plan, track);
    EXPECT_NEAR(learn(plan, track, options), now_m, 1e-12);
    track = play_in_time(other, plan);
  }
  EXPECT_GT(before_m, 5e-4);
  EXPECT_LT(rms_m(plan, track), 0.2 * before_m);
}

TEST(PlanMotion, FinishedInTimeItNeverGetsWorse) {
  Simulation model = bar();
  PathTask task = corner();
  task.duration_s = 0.6;
  PathPlan plan = plan_motion(model, task, drives());
  const double before_m = rms_m(plan, play_in_time(model, plan));
  finish_in_time(model, plan, 3, {});
  EXPECT_TRUE(plan.in_time);
  EXPECT_LT(plan.predicted_rms_m(), before_m);
  EXPECT_NEAR(rms_m(plan, play_in_time(model, plan)), plan.predicted_rms_m(), 1e-6);
}

TEST(PlanMotion, CommandsAreStoredAndTakenBack) {
  Simulation model = bar();
  const PathPlan plan = plan_motion(model, corner(), drives());
  PathPlan other = plan;
  for (PathSample& sample : other.samples) sample.commands.array() += 0.01;
  take_commands(other, policy_of(plan));
  for (std::size_t k = 0; k < plan.samples.size(); ++k) EXPECT_EQ(other.samples[k].commands, plan.samples[k].commands);
  CommandPolicy bad = policy_of(plan);
  bad.steps.pop_back();
  EXPECT_THROW(take_commands(other, bad), std::invalid_argument);
  bad = policy_of(plan);
  bad.steps.front().values[0] = 2.0;
  EXPECT_THROW(take_commands(other, bad), std::invalid_argument);
}

// A spool behind play: pulling, it follows at once.
TEST(PlayInverse, TheCableGetsWhatIsWanted) {
  const double play = 0.005;
  PlayInverse inverse(drives(kInf, play));
  double spool = 0.0;
  bool first = true;
  for (int i = 0; i < 400; ++i) {
    const double wanted = 0.95 + 0.05 * std::sin(0.05 * i);
    const double shaft = inverse.go(Eigen::Vector2d(wanted, 1.0))[0];
    if (first) spool = shaft;
    first = false;
    spool = std::clamp(spool, shaft - play, shaft);
    EXPECT_NEAR(spool, wanted, 0.25 * play + 1e-12) << i;
  }
}

TEST(PlayInverse, NeverLeavesTheLimits) {
  PlayInverse inverse(drives(kInf, 0.05));
  for (const double wanted : {1.0, 0.9, 1.08, 1.1, 0.8}) {
    const Eigen::VectorXd shaft = inverse.go(Eigen::Vector2d(wanted, wanted));
    EXPECT_LE(shaft.maxCoeff(), 1.1);
    EXPECT_GE(shaft.minCoeff(), 0.8);
  }
}

TEST(DampedInverse, MendsWhatItCanAndLeavesWhatWouldTakeTooMuch) {
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3, 2);
  jacobian(0, 0) = 0.2;
  jacobian(2, 1) = 1e-5;
  const Eigen::VectorXd commands = damped_inverse(jacobian, {0.001, 0.001, 0.001}, 0.01);
  EXPECT_NEAR(commands[0], 0.005, 2e-5);
  EXPECT_LT(std::abs(commands[1]), 1e-3);
}

}  // namespace
}  // namespace soft_robot_lab
