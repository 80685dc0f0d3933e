// SPDX-License-Identifier: BSD-3-Clause
// Answers a target that is dragged, on a thread of its own: always the newest one, those between are left out.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <Eigen/Core>

namespace soft_robot_lab {

struct LiveGoal {
  std::string marker;
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero();
  bool released = false;  // it stays there: search to the end
};

class LiveTarget {
 public:
  // `solve` shows what it has before it asks `interrupted`, and ends soon where that answers true: as a newer target
  // has come. So a fast hand is answered too. What it throws is lost.
  using Solve = std::function<void(const LiveGoal& goal, const std::function<bool()>& interrupted)>;

  explicit LiveTarget(Solve solve) : solve_(std::move(solve)) {}
  ~LiveTarget();

  void ask(const LiveGoal& goal);

  // Drops what is asked for, and waits until nothing is solved.
  void interrupt();

 private:
  void run();

  Solve solve_;
  std::mutex mutex_;  // guards what follows; held briefly
  std::condition_variable changed_;
  std::optional<LiveGoal> next_;
  bool solving_ = false, ended_ = false;
  std::atomic<bool> interrupted_{false};
  std::thread thread_{[this] { run(); }};
};

}  // namespace soft_robot_lab
