// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_topics.h"

#include <algorithm>

namespace soft_robot_lab {

std::string relative(const std::string& topic) { return topic.substr(!topic.empty() && topic[0] == '/' ? 1 : 0); }

rosbag::View only(const rosbag::Bag& bag, const std::vector<std::string>& topics) {
  return rosbag::View(bag, [topics](const rosbag::ConnectionInfo* connection) {
    return std::find(topics.begin(), topics.end(), relative(connection->topic)) != topics.end();
  });
}

std::vector<std::uint8_t> bytes_of(const rosbag::MessageInstance& message) {
  std::vector<std::uint8_t> bytes(message.size());
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  message.write(stream);
  return bytes;
}

void refuse_type(const rosbag::MessageInstance& message, const std::string& type, const std::string& md5) {
  const std::string text = "topic " + message.getTopic() + " holds " + message.getDataType();
  if (message.getDataType() != type) throw std::runtime_error(text + ", must hold " + type + "; record it again");
  throw std::runtime_error(text + " as another version defines it (" + message.getMD5Sum() + ", here " + md5 +
                           "); 'rosbag check -g rules.bmr' and 'rosbag fix' bring old recordings up to date, or record "
                           "it again");
}

void refuse_content(const rosbag::MessageInstance& message, const std::string& reason) {
  throw std::runtime_error("topic " + message.getTopic() + " holds a damaged " + message.getDataType() + " (" + reason +
                           "); record it again");
}

}  // namespace soft_robot_lab
