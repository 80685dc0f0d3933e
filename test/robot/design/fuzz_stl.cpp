// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz_stl.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "fuzz_rules.h"
#include "robot/design/plain_stl.h"

namespace soft_robot_lab {

// What is made plain stays so.
void fuzz_stl(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    const std::string plain = plain_stl(bytes);
    require_rule(plain_stl(plain) == plain);
  } catch (const std::invalid_argument& error) {
    require_rule(*error.what() != '\0');
  }
}

}  // namespace soft_robot_lab
