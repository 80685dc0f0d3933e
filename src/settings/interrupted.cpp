// SPDX-License-Identifier: BSD-3-Clause
#include "interrupted.h"

#include <atomic>
#include <csignal>

namespace soft_robot_lab {
namespace {

std::atomic<bool> asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal's handler may write nothing else");

void take(int signal) {
  asked = true;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void heed_interrupts() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, take);
}

bool interrupted() { return asked; }

}  // namespace soft_robot_lab
