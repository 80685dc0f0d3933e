// A message that every subscriber of a topic hears once, whenever it comes. A latched topic of roscpp (1.15) loses its
// message for who connects just while it is published, as all do while a session starts.
#pragma once

#include <string>

#include <ros/ros.h>

namespace soft_robot_lab {

template <typename Message>
class Announcement {
 public:
  explicit Announcement(const std::string& topic) : topic_(topic) {}

  // From now on instead of the one before. Sent by the global callback queue. Still declared as latched, so that the
  // message comes again where a recording is played.
  void tell(const Message& message) {
    publisher_.shutdown();
    publisher_ = ros::NodeHandle().advertise<Message>(
        topic_, 1, [message](const ros::SingleSubscriberPublisher& newcomer) { newcomer.publish(message); },
        ros::SubscriberStatusCallback(), ros::VoidConstPtr(), true);
  }

 private:
  std::string topic_;
  ros::Publisher publisher_;
};

}  // namespace soft_robot_lab
