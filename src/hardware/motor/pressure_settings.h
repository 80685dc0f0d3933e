// SPDX-License-Identifier: BSD-3-Clause
// What a rig's YAML file says of its pressure channels.
#pragma once

#include <cstdint>
#include <vector>

#include "drive_limits.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "wire.h"

namespace soft_robot_lab {

// Its voltage is a straight line of the gauge pressure.
struct SensorSettings {
  double zero_v = 0.5;   // [0.2, 2] at 0 Pa; a cut wire reads 0 V, which must not pass for a pressure
  double full_v = 4.5;   // [2.2, 4.8] at full_pa
  double full_pa = 0.0;  // (0, 8e6]
};

// Away from its set point a sound channel comes nearer all the time; how far and how fast says what a fault is.
struct WatchSettings {
  double tolerance_pa = 2000.0;    // (0, 65535]; nearer than this it has arrived
  double least_change_pa = 300.0;  // (0, tolerance_pa]; farther away it comes nearer by so much ...
  double fault_s = 0.3;            // [0.05, 0.4]; ... in each such time
};

struct ChannelSettings : DriveLimits {
  double output_pa = 0.0;    // of a regulator at full duty; 0: a pair of valves
  double deadband_pa = 0.0;  // of valves
  SensorSettings sensor;
  WatchSettings watch;
};

// Of `node.channels`; empty where there are none. Throws SettingsError.
std::vector<ChannelSettings> read_channels(const YamlNode& node);

// As the board gets it.
std::vector<std::uint8_t> channel_payload(const ChannelSettings& channel, int index);

}  // namespace soft_robot_lab
