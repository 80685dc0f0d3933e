// SPDX-License-Identifier: BSD-3-Clause
#include "session/live_answers.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

using Interrupted = std::function<bool()>;
constexpr auto target = LiveAnswers::Kind::target, commands = LiveAnswers::Kind::commands;

void wait_for(const std::function<bool()>& reached) {
  while (!reached()) std::this_thread::yield();
}

// What was answered, in order.
class Answered {
 public:
  void add(int number) {
    const std::lock_guard lock(mutex_);
    numbers_.push_back(number);
  }
  std::vector<int> all() const {
    const std::lock_guard lock(mutex_);
    return numbers_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<int> numbers_;
};

TEST(LiveAnswers, AreGivenToTheNewestOnly) {
  Answered answered;
  std::atomic<bool> go{false};
  LiveAnswers live;
  const auto ask = [&](int number) {
    live.ask(target, [&, number](const Interrupted&) {
      answered.add(number);
      wait_for([&] { return go.load(); });
    });
  };
  ask(0);
  wait_for([&] { return answered.all().size() == 1; });
  for (int i = 1; i <= 5; ++i) ask(i);
  go = true;
  wait_for([&] { return answered.all().size() == 2; });
  live.pause();
  EXPECT_EQ(answered.all(), (std::vector<int>{0, 5}));
}

TEST(LiveAnswers, GiveUpALongSearchForANewerPlace) {
  std::atomic<bool> begun{false}, gave_up{false}, newer{false};
  LiveAnswers live;
  live.ask(target, [&](const Interrupted& interrupted) {
    EXPECT_FALSE(interrupted());
    begun = true;
    wait_for(interrupted);
    gave_up = true;
  });
  wait_for([&] { return begun.load(); });
  live.ask(target, [&](const Interrupted&) { newer = true; });
  wait_for([&] { return newer.load(); });
  EXPECT_TRUE(gave_up);
}

// A stream of commands does not keep a hand from its target, nor drop it.
TEST(LiveAnswers, LetATargetComeFirst) {
  Answered answered;
  std::atomic<bool> begun{false}, all_asked{false}, interrupted_by_commands{true};
  LiveAnswers live;
  live.ask(target, [&](const Interrupted& interrupted) {
    begun = true;
    wait_for([&] { return all_asked.load(); });
    interrupted_by_commands = interrupted();
  });
  wait_for([&] { return begun.load(); });
  live.ask(commands, [&](const Interrupted&) { answered.add(1); });
  all_asked = true;
  wait_for([&] { return answered.all().size() == 1; });
  EXPECT_FALSE(interrupted_by_commands);

  std::atomic<bool> solving{false};
  live.ask(commands, [&](const Interrupted& interrupted) {
    solving = true;
    wait_for(interrupted);
    answered.add(2);
  });
  wait_for([&] { return solving.load(); });
  live.ask(target, [&](const Interrupted&) { answered.add(3); });
  wait_for([&] { return answered.all().size() == 3; });
  EXPECT_EQ(answered.all(), (std::vector<int>{1, 2, 3}));
}

TEST(LiveAnswers, MakeWayForARequestAndWaitForItsEnd) {
  Answered answered;
  std::atomic<bool> begun{false};
  LiveAnswers live;
  live.ask(target, [&](const Interrupted& interrupted) {
    begun = true;
    wait_for(interrupted);
    answered.add(1);
  });
  wait_for([&] { return begun.load(); });
  auto pause = live.pause();
  EXPECT_EQ(answered.all(), (std::vector<int>{1}));
  live.ask(target, [&](const Interrupted&) { answered.add(3); });
  {
    const auto second = live.pause();  // of a request that is refused
    live.ask(target, [&](const Interrupted&) { answered.add(4); });
  }
  std::this_thread::yield();
  answered.add(2);
  pause.reset();
  wait_for([&] { return answered.all().size() == 3; });
  EXPECT_EQ(answered.all(), (std::vector<int>{1, 2, 4}));
}

TEST(LiveAnswers, SurviveASearchThatFails) {
  std::atomic<int> asked{0};
  LiveAnswers live;
  const auto fail = [&](const Interrupted&) {
    ++asked;
    throw std::runtime_error("no rest state");
  };
  live.ask(target, fail);
  wait_for([&] { return asked == 1; });
  live.ask(target, fail);
  wait_for([&] { return asked == 2; });
}

}  // namespace
}  // namespace soft_robot_lab
