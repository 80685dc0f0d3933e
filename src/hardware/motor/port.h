// SPDX-License-Identifier: BSD-3-Clause
// Where bytes go to and come from. A closed port says so by PortError; opening another is the link's task.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <vector>

namespace soft_robot_lab {

class PortError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Port {
 public:
  virtual ~Port() = default;
  // What has arrived; neither call waits. Both throw PortError when the device is gone.
  virtual std::vector<std::uint8_t> read() = 0;
  virtual void write(const std::vector<std::uint8_t>& bytes) = 0;
};

using OpenPort = std::function<std::unique_ptr<Port>()>;  // throws PortError

}  // namespace soft_robot_lab
