// SPDX-License-Identifier: BSD-3-Clause
#include "settings/interrupted.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

// As `timeout --signal=INT` does: to the program, then to its group.
TEST(Interrupted, TakesASignalThatComesTwiceAtOnceForOne) {
  EXPECT_EXIT(
      {
        heed_interrupts();
        std::raise(SIGINT);
        std::raise(SIGINT);
        std::exit(interrupted() ? 7 : 8);
      },
      testing::ExitedWithCode(7), "");
}

TEST(Interrupted, EndsAtOnceAtASecondSignalThatComesLater) {
  EXPECT_EXIT(
      {
        heed_interrupts();
        std::raise(SIGTERM);
        std::this_thread::sleep_for(std::chrono::milliseconds(400));
        std::raise(SIGINT);
        std::exit(0);
      },
      testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace soft_robot_lab
