// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <ros/time.h>

namespace soft_robot_lab {

// As `to - from`, which throws where a message's stamp is far from the others'.
inline double seconds_between(const ros::Time& from, const ros::Time& to) {
  return 1e-9 * static_cast<double>(static_cast<std::int64_t>(to.toNSec()) - static_cast<std::int64_t>(from.toNSec()));
}

}  // namespace soft_robot_lab
