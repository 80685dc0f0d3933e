// SPDX-License-Identifier: BSD-3-Clause
// Keeps steps and requests of a session apart: a request ends the step that is solved, and the next step waits for it.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

namespace soft_robot_lab {

class StepGate {
 public:
  using Lock = std::unique_lock<std::timed_mutex>;

  // Between two steps, as long as it lives; the step that is solved is asked to end.
  class Turn {
   public:
    explicit Turn(StepGate& gate) : gate_(gate) {
      ++gate_.waiting_;
      gate_.mutex_.lock();
    }
    ~Turn() {
      gate_.mutex_.unlock();
      --gate_.waiting_;
    }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    StepGate& gate_;
  };

  Lock wait() { return Lock(mutex_); }  // until the step is solved, however long it takes
  Lock try_for(std::chrono::milliseconds time) { return Lock(mutex_, time); }

  // For a step: requests come first.
  Lock begin_step() {
    while (waiting_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    Lock lock(mutex_);
    since_ = Clock::now();
    return lock;
  }
  bool step_must_end() const { return waiting_ > 0; }
  // Of the step that is solved, or of the first scene's loading [s].
  double lasts_s() const { return std::chrono::duration<double>(Clock::now() - since_.load()).count(); }

 private:
  using Clock = std::chrono::steady_clock;

  std::atomic<int> waiting_{0};
  std::atomic<Clock::time_point> since_{Clock::now()};
  std::timed_mutex mutex_;
};

}  // namespace soft_robot_lab
