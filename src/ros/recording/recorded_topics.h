// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <boost/make_shared.hpp>
#include <ros/message_traits.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "message_layout.h"

namespace soft_robot_lab {

std::string relative(const std::string& topic);  // as in topics.h
// To be read. Throws rosbag::BagException; then nothing stays of it in memory, unlike by the constructor with a path.
rosbag::Bag open_bag(const std::string& path);
// Messages of these topics, in the order in which they were recorded.
rosbag::View only(const rosbag::Bag& bag, const std::vector<std::string>& topics);

// Throws std::runtime_error: topic, the type that it has, the one that it should have, and what to do.
[[noreturn]] void refuse_type(const rosbag::MessageInstance& message, const std::string& type, const std::string& md5);
[[noreturn]] void refuse_content(const rosbag::MessageInstance& message, const std::string& reason);

std::vector<std::uint8_t> bytes_of(const rosbag::MessageInstance& message);

// A message of a recording, which may have been made by anybody: of another type, or damaged, it is refused as above.
template <typename Message>
boost::shared_ptr<Message> read_message(const rosbag::MessageInstance& message) {
  namespace traits = ros::message_traits;
  if (!message.isType<Message>()) refuse_type(message, traits::datatype<Message>(), traits::md5sum<Message>());
  static const MessageLayout layout(traits::datatype<Message>(), traits::definition<Message>());
  const auto read = boost::make_shared<Message>();
  try {
    std::vector<std::uint8_t> bytes = bytes_of(message);
    layout.require_fits(bytes);
    ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::deserialize(stream, *read);
  } catch (const std::exception& error) {
    refuse_content(message, error.what());
  }
  return read;
}

}  // namespace soft_robot_lab
