// SPDX-License-Identifier: BSD-3-Clause
#include "calls.h"
#include "settings/words.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace soft_robot_lab {

// A client that just starts to wait is set free in the next round.
Calls::~Calls() {
  ended_ = true;
  while (any_busy()) {
    {
      const std::lock_guard lock(mutex_);
      for (ros::ServiceClient& client : clients_) client.shutdown();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  for (auto& [lane, thread] : threads_) thread.join();
}

bool Calls::start(const std::string& lane, const std::string& title, std::function<std::string()> work) {
  const std::lock_guard lock(mutex_);
  if (ended_ || running_[lane]) return false;
  if (std::thread& before = threads_[lane]; before.joinable()) before.join();
  running_[lane] = true;
  threads_[lane] = std::thread([this, lane, title, work = std::move(work)] {
    CallOutcome outcome{title, true, ""};
    try {
      outcome.message = work();
    } catch (const std::exception& error) {
      outcome.success = false;
      outcome.message = reason_of(error);
    }
    const std::lock_guard ended(mutex_);
    outcomes_.push_back(outcome);
    running_[lane] = false;
  });
  return true;
}

bool Calls::busy(const std::string& lane) const {
  const std::lock_guard lock(mutex_);
  const auto found = running_.find(lane);
  return found != running_.end() && found->second;
}

bool Calls::any_busy() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(running_.begin(), running_.end(), [](const auto& lane) { return lane.second; });
}

std::vector<CallOutcome> Calls::take_outcomes() {
  const std::lock_guard lock(mutex_);
  return std::exchange(outcomes_, {});
}

void Calls::refuse_window(const std::string& service) const {
  if (std::this_thread::get_id() == window_) throw std::logic_error("the window would wait for " + service);
}

void Calls::keep(const ros::ServiceClient& client, bool kept) {
  const std::lock_guard lock(mutex_);
  if (kept) {
    clients_.push_back(client);
  } else {
    clients_.erase(std::remove(clients_.begin(), clients_.end(), client), clients_.end());
  }
}

}  // namespace soft_robot_lab
