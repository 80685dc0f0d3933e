// SPDX-License-Identifier: BSD-3-Clause
#include "live_answers.h"

#include <exception>
#include <utility>

namespace soft_robot_lab {

LiveAnswers::~LiveAnswers() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

void LiveAnswers::ask(Kind kind, Work work) {
  const std::lock_guard lock(mutex_);
  next_[kind] = std::move(work);
  changed_.notify_all();
}

std::shared_ptr<void> LiveAnswers::pause() {
  std::unique_lock lock(mutex_);
  next_.clear();
  ++pauses_;
  changed_.wait(lock, [&] { return !answering_; });
  return {nullptr, [this](void*) {
            const std::lock_guard again(mutex_);
            --pauses_;
            changed_.notify_all();
          }};
}

bool LiveAnswers::must_end() {
  const std::lock_guard lock(mutex_);
  return ended_ || pauses_ > 0;
}

bool LiveAnswers::interrupted(Kind kind) {
  const std::lock_guard lock(mutex_);
  return ended_ || pauses_ > 0 || (!next_.empty() && next_.begin()->first <= kind);
}

void LiveAnswers::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return ended_ || (pauses_ == 0 && !next_.empty()); });
    if (ended_) return;
    const auto [kind, work] = *next_.begin();
    next_.erase(next_.begin());
    answering_ = true;
    lock.unlock();
    try {
      work([this, asked = kind] { return interrupted(asked); });
    } catch (const std::exception&) {  // what comes next counts
    }
    lock.lock();
    answering_ = false;
    changed_.notify_all();
  }
}

}  // namespace soft_robot_lab
