// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz_bag.h"

#include <stdexcept>

#include "fuzz_rules.h"
#include "ros/recording.h"

namespace soft_robot_lab {

// What is wrong with a recording is said by std::runtime_error and by nothing else.
void fuzz_bag(const std::uint8_t* data, std::size_t size) {
  const FuzzFile file(data, size);
  try {
    const Recording recording = read_recording(file.path());
    require_rule(!recording.measured.empty());
    for (const MarkerObservations& markers : recording.measured)
      require_rule(markers.positions.size() == markers.names.size());
  } catch (const std::runtime_error& error) {
    require_rule(*error.what() != '\0');
  }
}

}  // namespace soft_robot_lab
