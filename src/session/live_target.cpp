// SPDX-License-Identifier: BSD-3-Clause
#include "live_target.h"

#include <exception>
#include <utility>

namespace soft_robot_lab {

LiveTarget::~LiveTarget() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    interrupted_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

void LiveTarget::ask(const LiveGoal& goal) {
  const std::lock_guard lock(mutex_);
  next_ = goal;
  changed_.notify_all();
}

void LiveTarget::interrupt() {
  std::unique_lock lock(mutex_);
  next_.reset();
  interrupted_ = true;
  changed_.wait(lock, [&] { return !solving_; });
  interrupted_ = false;
}

void LiveTarget::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return ended_ || next_; });
    if (ended_) return;
    const LiveGoal goal = *std::exchange(next_, std::nullopt);
    solving_ = true;
    lock.unlock();
    try {
      solve_(goal, [this] {
        if (interrupted_) return true;
        const std::lock_guard newer(mutex_);
        return next_.has_value();
      });
    } catch (const std::exception&) {  // the next target counts
    }
    lock.lock();
    solving_ = false;
    changed_.notify_all();
  }
}

}  // namespace soft_robot_lab
