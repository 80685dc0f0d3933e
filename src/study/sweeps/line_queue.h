// SPDX-License-Identifier: BSD-3-Clause
// Lines from one thread to another.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

namespace soft_robot_lab {

class LineQueue {
 public:
  void push(std::string line) {
    const std::lock_guard<std::mutex> lock(mutex_);
    lines_.push_back(std::move(line));
    come_.notify_one();
  }

  std::string wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    come_.wait(lock, [&] { return !lines_.empty(); });
    return take();
  }

  std::optional<std::string> poll() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return lines_.empty() ? std::nullopt : std::optional<std::string>(take());
  }

 private:
  std::string take() {
    std::string line = std::move(lines_.front());
    lines_.pop_front();
    return line;
  }

  std::mutex mutex_;
  std::condition_variable come_;
  std::deque<std::string> lines_;
};

}  // namespace soft_robot_lab
