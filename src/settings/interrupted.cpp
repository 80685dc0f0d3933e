// SPDX-License-Identifier: BSD-3-Clause
#include "interrupted.h"

#include <atomic>
#include <csignal>
#include <ctime>

namespace soft_robot_lab {
namespace {

// `timeout` sends its signal to the program and at once again to the whole group, a shell at times too.
constexpr double kOneSignal_s = 0.3;

std::atomic<bool> asked{false};
std::atomic<double> asked_at_s{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<double>::is_always_lock_free,
              "a signal's handler may write nothing else");

double now_s() {
  std::timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void take(int signal) {
  if (!asked) {
    asked_at_s = now_s();
    asked = true;
  } else if (now_s() - asked_at_s > kOneSignal_s) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

}  // namespace

void heed_interrupts() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, take);
}

bool interrupted() { return asked; }

}  // namespace soft_robot_lab
