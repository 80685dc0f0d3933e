// SPDX-License-Identifier: BSD-3-Clause
// Bags of sessions.
#pragma once

#include <string>
#include <vector>

#include <soft_robot_lab/MotorState.h>
#include <soft_robot_lab/RealityGap.h>

#include "ros/messages/messages.h"
#include "session/recording.h"

namespace soft_robot_lab {

struct RecordedSession : Recording {
  std::vector<ObservedMarkers> simulated;
  std::vector<RealityGap> gaps;         // of the measured markers to these
  std::vector<RecordedEvent> settings;  // of the tracker, where they were changed on the way
};

// Throws std::runtime_error for a file that is no bag, holds no tracked markers, or is cut off.
RecordedSession read_recorded_session(const std::string& bag);

// Throws std::runtime_error for lists of different lengths.
std::vector<MotorReading> motor_readings(const MotorState& motors);

// Throws std::invalid_argument as require_whole does, and for covariances that are not as many.
ObservedMarkers observed_markers(const MarkerObservations& markers);

}  // namespace soft_robot_lab
