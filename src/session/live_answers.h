// SPDX-License-Identifier: BSD-3-Clause
// Answers a hand at once, on a thread of its own: a target that is dragged, a slider that moves. Of each always the
// newest; those between are left out.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

namespace soft_robot_lab {

class LiveAnswers {
 public:
  enum class Kind { target, commands };  // a target comes first, and commands wait

  // Shows what it has before it asks `interrupted`, and ends soon where that answers true: as something newer of its
  // kind has come, or a target. So a fast hand is answered too. What it throws is lost.
  using Work = std::function<void(const std::function<bool()>& interrupted)>;

  LiveAnswers() = default;
  ~LiveAnswers();

  void ask(Kind kind, Work work);

  // While something is answered: whether that has to end at once, with nothing to show, as answers pause or end.
  bool must_end();

  // Drops what is asked for, and waits until nothing is answered. Nothing is as long as what it returns is kept; what
  // is asked for meanwhile waits. That may outlive nothing of this.
  std::shared_ptr<void> pause();

 private:
  void run();
  bool interrupted(Kind kind);

  std::mutex mutex_;  // guards what follows; held briefly
  std::condition_variable changed_;
  std::map<Kind, Work> next_;
  int pauses_ = 0;
  bool answering_ = false, ended_ = false;
  std::thread thread_{[this] { run(); }};
};

}  // namespace soft_robot_lab
