// SPDX-License-Identifier: BSD-3-Clause
#include "session/live_target.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

LiveGoal goal_at(double x_m, bool released = false) { return {"tip", {x_m, 0.0, 0.0}, released}; }

void wait_for(const std::function<bool()>& reached) {
  while (!reached()) std::this_thread::yield();
}

TEST(LiveTarget, IsAnsweredWithTheNewestPlaceOnly) {
  std::mutex mutex;
  std::vector<double> answered;
  std::atomic<bool> go{false};
  LiveTarget live([&](const LiveGoal& goal, const auto&) {
    {
      const std::lock_guard lock(mutex);
      answered.push_back(goal.target_m.x());
    }
    wait_for([&] { return go.load(); });
  });
  live.ask(goal_at(0.0));
  wait_for([&] {
    const std::lock_guard lock(mutex);
    return answered.size() == 1;
  });
  for (int i = 1; i <= 5; ++i) live.ask(goal_at(i));
  go = true;
  wait_for([&] {
    const std::lock_guard lock(mutex);
    return answered.size() == 2;
  });
  live.interrupt();
  EXPECT_EQ(answered, (std::vector<double>{0.0, 5.0}));
}

TEST(LiveTarget, GivesUpALongSearchForANewerPlace) {
  std::atomic<int> begun{0}, interruptions{0};
  LiveTarget live([&](const LiveGoal& goal, const std::function<bool()>& interrupted) {
    ++begun;
    if (!goal.released) return;
    wait_for(interrupted);
    ++interruptions;
  });
  live.ask(goal_at(0.0, true));
  wait_for([&] { return begun == 1; });
  live.ask(goal_at(1.0));
  wait_for([&] { return begun == 2; });
  EXPECT_EQ(interruptions, 1);
}

TEST(LiveTarget, GivesUpAShortSearchToo) {
  std::atomic<bool> begun{false}, newer_asked{false}, looked{false}, gives_up{false};
  LiveTarget live([&](const LiveGoal& goal, const std::function<bool()>& interrupted) {
    begun = true;
    if (goal.target_m.x() > 0.0) return;
    wait_for([&] { return newer_asked.load(); });
    gives_up = interrupted();
    looked = true;
  });
  live.ask(goal_at(0.0));
  wait_for([&] { return begun.load(); });
  live.ask(goal_at(1.0));
  newer_asked = true;
  wait_for([&] { return looked.load(); });
  EXPECT_TRUE(gives_up);
}

TEST(LiveTarget, MakesWayForARequest) {
  std::atomic<bool> begun{false}, ended{false};
  LiveTarget live([&](const LiveGoal&, const std::function<bool()>& interrupted) {
    begun = true;
    wait_for(interrupted);
    ended = true;
  });
  live.ask(goal_at(0.0));
  wait_for([&] { return begun.load(); });
  live.interrupt();
  EXPECT_TRUE(ended);
}

TEST(LiveTarget, SurvivesASearchThatFails) {
  std::atomic<int> asked{0};
  LiveTarget live([&](const LiveGoal&, const auto&) {
    ++asked;
    throw std::runtime_error("no rest state");
  });
  live.ask(goal_at(0.0));
  wait_for([&] { return asked == 1; });
  live.ask(goal_at(1.0));
  wait_for([&] { return asked == 2; });
}

}  // namespace
}  // namespace soft_robot_lab
