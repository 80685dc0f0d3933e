// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_topics.h"

#include <algorithm>

#include "ros/base/topics.h"
#include "ros/tracking/tracker_parameters.h"

namespace soft_robot_lab {

namespace {

// By how they end; before that stands, of some sessions, a namespace.
const std::vector<std::string>& known_topics() {
  static const std::vector<std::string> all = {
      topics::actuator_command,    topics::simulator_markers, topics::tracker_markers, topics::tracker_steps,
      topics::simulator_actuators, topics::simulator_surface, topics::simulator_scene, topics::controller_progress,
      topics::controller_target,   topics::overlay,           topics::overlay_labels,  topics::reality_gap,
      topics::motor_state,         topics::rig_shafts,        topics::plant_markers,   tracker_updates};
  return all;
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

std::string relative(const std::string& topic) {
  for (const std::string& known : known_topics())
    if (ends_with(topic, "/" + known)) return known;
  for (const char* part : {"/color/", "/aligned_depth_to_color/"}) {  // of a camera, whose name stands before
    const std::size_t end = topic.rfind(part);
    if (end == std::string::npos || end == 0) continue;
    const std::size_t start = topic.rfind('/', end - 1);
    return topic.substr(start == std::string::npos ? 0 : start + 1);
  }
  return topic.substr(!topic.empty() && topic[0] == '/' ? 1 : 0);
}

rosbag::Bag open_bag(const std::string& path) {
  require_sound(path);
  rosbag::Bag bag;
  bag.open(path, rosbag::bagmode::Read);
  return bag;
}

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
