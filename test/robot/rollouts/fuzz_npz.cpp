// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz_npz.h"

#include <stdexcept>
#include <string>
#include <vector>

#include "fuzz_rules.h"
#include "robot/rollouts/npz.h"

namespace soft_robot_lab {

// Arrays hold no more than the file, and what was read can be written and read.
void fuzz_npz(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    const std::vector<NpzArray> arrays = read_npz(bytes);
    std::size_t held = 0;
    for (const NpzArray& array : arrays) held += array.bytes.size();
    require_rule(held <= size);
    for (const NpzArray& array : read_npz(npz(arrays))) numbers_of(array);
  } catch (const std::invalid_argument& error) {
    require_rule(*error.what() != '\0');
  }
}

}  // namespace soft_robot_lab
