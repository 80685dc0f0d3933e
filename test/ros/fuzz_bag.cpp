// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz_bag.h"

#include <stdexcept>

#include "fuzz_rules.h"
#include "ros/recording/recorded_session.h"

namespace soft_robot_lab {

// What is wrong with a recording is said by std::runtime_error and by nothing else.
void fuzz_bag(const std::uint8_t* data, std::size_t size) {
  const FuzzFile file(data, size);
  try {
    const RecordedSession recording = read_recorded_session(file.path());
    require_rule(!recording.measured.empty());
    for (const ObservedMarkers& at : recording.measured)
      for (const ObservedMarker& marker : at.markers) require_rule(marker.position_m.allFinite());
  } catch (const std::runtime_error& error) {
    require_rule(*error.what() != '\0');
  }
}

}  // namespace soft_robot_lab
