// SPDX-License-Identifier: BSD-3-Clause
// An action's goal as the request of the service that does the same, and a response as its result.
#pragma once

#include <cstdint>
#include <vector>

#include <ros/message_traits.h>
#include <ros/serialization.h>

namespace soft_robot_lab {

// Their fields are the same by type, name and order, which the sums of their definitions prove.
template <typename To, typename From>
To same_fields(const From& from) {
  using ToSum = ros::message_traits::MD5Sum<To>;
  using FromSum = ros::message_traits::MD5Sum<From>;
  static_assert(ToSum::static_value1 == FromSum::static_value1 && ToSum::static_value2 == FromSum::static_value2,
                "the .action file is not like the .srv file");
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(from));
  ros::serialization::OStream out(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(out, from);
  ros::serialization::IStream in(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  To to;
  ros::serialization::deserialize(in, to);
  return to;
}

}  // namespace soft_robot_lab
