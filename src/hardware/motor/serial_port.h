// SPDX-License-Identifier: BSD-3-Clause
// A serial device, for us alone.
#pragma once

#include <memory>
#include <string>

#include "port.h"

namespace soft_robot_lab {

// At 115200 baud, 8 bits, no parity, one stop bit. Throws PortError: no such device, not a serial one, or in use.
std::unique_ptr<Port> open_serial_port(const std::string& device);

}  // namespace soft_robot_lab
