// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz_obj.h"

#include <stdexcept>
#include <string>

#include "fuzz_rules.h"
#include "robot/design/plain_obj.h"
#include "robot/design/plain_stl.h"

namespace soft_robot_lab {

// What is made of it is plain STL.
void fuzz_obj(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    const std::string plain = plain_obj(bytes);
    require_rule(plain_stl(plain) == plain);
  } catch (const std::invalid_argument& error) {
    require_rule(*error.what() != '\0');
  }
}

}  // namespace soft_robot_lab
