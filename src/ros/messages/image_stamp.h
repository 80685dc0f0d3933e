// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/Image.h>

namespace soft_robot_lab {

// An image of which only the beginning is read.
struct ImageStamp {
  std_msgs::Header header;
};

}  // namespace soft_robot_lab

namespace ros {
namespace message_traits {
template <>
struct MD5Sum<soft_robot_lab::ImageStamp> : MD5Sum<sensor_msgs::Image> {};
template <>
struct DataType<soft_robot_lab::ImageStamp> : DataType<sensor_msgs::Image> {};
template <>
struct Definition<soft_robot_lab::ImageStamp> : Definition<sensor_msgs::Image> {};
}  // namespace message_traits
namespace serialization {
template <>
struct Serializer<soft_robot_lab::ImageStamp> {
  template <typename Stream>
  static void read(Stream& stream, soft_robot_lab::ImageStamp& image) {
    stream.next(image.header);
  }
};
}  // namespace serialization
}  // namespace ros
