// SPDX-License-Identifier: BSD-3-Clause
// Services asked for on threads of their own, so that the window never waits. Two kinds run beside each other: what
// takes long (a search, a policy) one at a time, and what has to come through at once (stop). Knows no window.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <ros/ros.h>

namespace soft_robot_lab {

struct CallOutcome {
  std::string title;  // as given to `start`
  bool success = false;
  std::string message;
};

class Calls {
 public:
  ~Calls();

  // `work` runs on a thread and says what came out; what it throws is a failure. False where `lane` is occupied, and
  // nothing starts then.
  bool start(const std::string& lane, const std::string& title, std::function<std::string()> work);

  bool busy(const std::string& lane) const;
  bool any_busy() const;
  std::vector<CallOutcome> take_outcomes();

  // For `work`: asks and waits. Throws std::runtime_error where there is no such service, where it answers that it did
  // not succeed, and where the panel ends; and as `refuse_window`.
  template <typename Service>
  typename Service::Response ask(ros::NodeHandle node, const std::string& name, typename Service::Request request);

  // Throws std::logic_error in the thread that made this, which is the window's: that must not wait.
  void refuse_window(const std::string& service) const;

 private:
  void keep(const ros::ServiceClient& client, bool kept);

  const std::thread::id window_ = std::this_thread::get_id();
  std::atomic<bool> ended_{false};
  mutable std::mutex mutex_;  // guards what follows; held briefly
  std::map<std::string, bool> running_;
  std::vector<CallOutcome> outcomes_;
  std::vector<ros::ServiceClient> clients_;  // that are waiting for an answer
  std::map<std::string, std::thread> threads_;
};

template <typename Service>
typename Service::Response Calls::ask(ros::NodeHandle node, const std::string& name,
                                      typename Service::Request request) {
  refuse_window(name);
  constexpr bool persistent = true;  // only such a client is set free by shutdown()
  ros::ServiceClient client = node.serviceClient<Service>(name, persistent);
  keep(client, true);
  typename Service::Response response;
  const bool answered = !ended_ && client.isValid() && client.call(request, response);
  keep(client, false);
  if (ended_) throw std::runtime_error("the panel ends");
  if (!answered) throw std::runtime_error(node.resolveName(name) + " does not answer");
  if (!response.success) throw std::runtime_error(response.message.empty() ? "refused" : response.message);
  return response;
}

}  // namespace soft_robot_lab
