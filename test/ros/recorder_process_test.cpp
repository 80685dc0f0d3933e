// SPDX-License-Identifier: BSD-3-Clause
#include "ros/recording/recorder_process.h"

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

namespace soft_robot_lab {
namespace {

// Waits without a limit: ctest has one.
template <typename Condition>
void wait_until(const Condition& condition) {
  while (!condition()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

TEST(RecorderProcess, RunsUntilItIsStopped) {
  RecorderProcess recorder;
  EXPECT_FALSE(recorder.process());
  recorder.start({"sleep", "1000"});
  EXPECT_TRUE(recorder.process());
  EXPECT_THROW(recorder.start({"sleep", "1000"}), std::runtime_error);
  EXPECT_TRUE(recorder.stop(60.0));
  EXPECT_FALSE(recorder.process());
  EXPECT_FALSE(recorder.ended_by_itself());
}

// As a shell does that waits for a program of its own before it becomes the recorder.
TEST(RecorderProcess, IsStoppedThoughItsFirstSignalIsLost) {
  const std::filesystem::path ready = testing::TempDir() + "recorder_process_" + std::to_string(getpid());
  RecorderProcess recorder;
  recorder.start({"bash", "-c", "trap '' INT; touch " + ready.string() + "; sleep 0.5; trap - INT; exec sleep 1000"});
  wait_until([&] { return std::filesystem::exists(ready); });
  std::filesystem::remove(ready);
  EXPECT_TRUE(recorder.stop(60.0));
  EXPECT_FALSE(recorder.process());
}

TEST(RecorderProcess, SaysWhereItEndedByItself) {
  RecorderProcess recorder;
  recorder.start({"false"});
  wait_until([&] { return recorder.ended_by_itself(); });
  EXPECT_TRUE(recorder.stop(0.0)) << "there is nothing to stop";
  EXPECT_FALSE(recorder.ended_by_itself());
}

}  // namespace
}  // namespace soft_robot_lab
