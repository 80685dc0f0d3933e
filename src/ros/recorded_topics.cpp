#include "ros/recorded_topics.h"

#include <algorithm>

namespace soft_robot_lab {

std::string relative(const std::string& topic) { return topic.substr(topic.front() == '/' ? 1 : 0); }

rosbag::View only(const rosbag::Bag& bag, const std::vector<std::string>& topics) {
  return rosbag::View(bag, [topics](const rosbag::ConnectionInfo* connection) {
    return std::find(topics.begin(), topics.end(), relative(connection->topic)) != topics.end();
  });
}

}  // namespace soft_robot_lab
