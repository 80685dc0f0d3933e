// SPDX-License-Identifier: BSD-3-Clause
// Topics that no newcomer misses anything of: a latched topic of roscpp (1.15) loses its message for who connects just
// while it is published, as all do while a session starts.
#pragma once

#include <mutex>
#include <optional>
#include <string>

#include <ros/ros.h>

namespace soft_robot_lab {

// A topic whose every newcomer is attended to, by the global callback queue. Declared as latched, so that its messages
// come again where a recording is played.
template <typename Message>
ros::Publisher advertise_latched(const std::string& topic, const ros::SubscriberStatusCallback& attend) {
  return ros::NodeHandle().advertise<Message>(topic, 1, attend, ros::SubscriberStatusCallback(), ros::VoidConstPtr(),
                                              true);
}

// A message that every subscriber hears once, whenever it comes. For what changes seldom: each message cuts the
// connections, which take some tenths of a second to come again.
template <typename Message>
class LatchedPublisher {
 public:
  explicit LatchedPublisher(const std::string& topic) : topic_(topic) {}

  // From now on instead of the one before.
  void publish(const Message& message) {
    publisher_.shutdown();
    publisher_ = advertise_latched<Message>(
        topic_, [message](const ros::SingleSubscriberPublisher& newcomer) { newcomer.publish(message); });
  }

 private:
  std::string topic_;
  ros::Publisher publisher_;
};

// For what changes often: connections stay, and a new subscriber may hear the present message twice. From any thread.
template <typename Message>
class PresentPublisher {
 public:
  explicit PresentPublisher(const std::string& topic)
      : publisher_(advertise_latched<Message>(
            topic, [this](const ros::SingleSubscriberPublisher& subscriber) { attend(subscriber); })) {}
  PresentPublisher(const PresentPublisher&) = delete;
  PresentPublisher& operator=(const PresentPublisher&) = delete;

  void publish(const Message& message) {
    const std::lock_guard in_order(mutex_);
    present_ = message;
    publisher_.publish(message);
  }
  bool has_subscribers() const { return publisher_.getNumSubscribers() > 0; }

 private:
  void attend(const ros::SingleSubscriberPublisher& subscriber) {
    const std::lock_guard in_order(mutex_);
    if (present_) subscriber.publish(*present_);
  }

  std::mutex mutex_;
  std::optional<Message> present_;
  ros::Publisher publisher_;
};

}  // namespace soft_robot_lab
