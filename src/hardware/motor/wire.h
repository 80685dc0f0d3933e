// SPDX-License-Identifier: BSD-3-Clause
// The rig's protocol as both ends see it: kinds of frames, their payloads, flags. The firmware includes this file too,
// so it is freestanding C++14. Byte drawings and rules: src/hardware/firmware/PROTOCOL.md.
#pragma once

#include <stdint.h>

namespace soft_robot_lab {
namespace wire {

constexpr uint8_t protocol_version = 1;
constexpr uint32_t baud_rate = 115200;
constexpr uint8_t max_motors = 6;                 // of a board with stepper drivers
constexpr uint8_t max_channels = 4;               // of a board with pressure channels
constexpr uint8_t no_session = 0;                 // sessions are numbered 1 to 255 by the host
constexpr int32_t max_position = (1L << 21) - 1;  // an L6470 counts 22 bits with sign
constexpr uint8_t max_payload = 24;

// What a board drives, so that a driver of the other kind moves nothing.
enum Firmware : uint8_t {
  firmware_motors = 1,
  firmware_pressures = 2,
};

enum Kind : uint8_t {
  // host to board
  kind_hello = 0x01,            // opens a session; not numbered
  kind_alive = 0x02,            // feeds the watchdog; not numbered
  kind_configure_board = 0x03,  // from here on numbered: done once, however often they arrive
  kind_configure_motor = 0x04,
  kind_go_to = 0x05,
  kind_zero = 0x06,
  kind_soft_stop = 0x07,
  kind_clear = 0x08,
  kind_emergency_stop = 0x09,     // in any session, not numbered
  kind_configure_channel = 0x0a,  // numbered, as 03 to 08
  // board to host
  kind_welcome = 0x81,
  kind_acknowledge = 0x82,
  kind_state = 0x83,
};

enum Result : uint8_t {
  result_done = 0,
  result_not_configured = 1,
  result_beyond_limit = 2,
  result_position_unknown = 3,
  result_fault = 4,
  result_emergency_stop = 5,
  result_moving = 6,
  result_no_motor = 7,
  result_wrong_session = 8,
  result_out_of_order = 9,
  result_bad_value = 10,
  result_count = 11,
};

// Flags of one drive. The first four mean the same for motors and for pressure channels; from bit 8 on they are faults.
enum Flag : uint16_t {
  flag_known = 1 << 0,   // the position has counted every step since it was set to zero; the pressure is measured
  flag_moving = 1 << 1,  // or about to
  flag_emergency_stop = 1 << 2,   // latched until cleared
  flag_host_silent = 1 << 3,      // stopped by the watchdog; until the next motion
  flag_power_up = 1 << 4,         // the chip has not been zeroed since it got power
  flag_thermal_warning = 1 << 5,  // not latched
  flag_overcurrent = 1 << 8,      // from here on latched until cleared, and motion is refused
  flag_stall = 1 << 9,
  flag_overheated = 1 << 10,
  flag_undervoltage = 1 << 11,
  flag_no_answer = 1 << 12,  // the chip's status is not one an L6470 can have
};
constexpr uint16_t fault_flags = 0xff00;

// Faults of a pressure channel.
enum PressureFlag : uint16_t {
  flag_sensor = 1 << 8,         // its voltage is none that the sensor gives
  flag_burst = 1 << 9,          // the pressure falls or stays away while air is let in
  flag_stuck = 1 << 10,         // the pressure does not follow its set point
  flag_over_pressure = 1 << 11  // the pressure is beyond the channel's limit
};

// Offsets into payloads; numbers are little endian. Positions have 24 bits with sign: microsteps of motors, gauge
// pressures [Pa] of channels.
namespace hello {
constexpr uint8_t version = 0, length = 1;
}
namespace board {  // kind_configure_board
constexpr uint8_t drive_count = 0, watchdog_ms = 1, length = 3;
}
namespace motor {  // kind_configure_motor; speeds, accelerations and currents in the L6470's register units
constexpr uint8_t index = 0, step_mode = 1, max_speed = 2, acceleration = 4, deceleration = 6, kval_hold = 8,
                  kval_run = 9, kval_acceleration = 10, kval_deceleration = 11, overcurrent_threshold = 12,
                  stall_threshold = 13, min_position = 14, max_position = 17, length = 20;
}
namespace channel {  // kind_configure_channel; sensors as sums of so many conversions of 10 bits, pressures [Pa]
constexpr uint8_t samples = 16;
constexpr uint8_t index = 0, sensor_zero = 1, sensor_full = 3, sensor_pa = 5, output_pa = 8, max_pa = 11,
                  deadband_pa = 14, tolerance_pa = 16, least_change_pa = 18, fault_ms = 20, length = 22;
}  // namespace channel
namespace go_to {  // then one position for each bit of the mask, lowest drive first
constexpr uint8_t mask = 0, positions = 1, position_size = 3;
}
namespace drives_mask {  // kind_zero, kind_soft_stop, kind_clear
constexpr uint8_t mask = 0, length = 1;
}
namespace welcome {
constexpr uint8_t version = 0, firmware = 1, drive_count = 2, configuration_crc = 3, length = 5;
}
namespace acknowledge {
constexpr uint8_t result = 0, moving_mask = 1, fault_mask = 2, known_mask = 3, length = 4;
}
namespace state {
constexpr uint8_t drive = 0, position = 1, target = 4, flags = 7, length = 9;
}

inline void put_u16(uint8_t* bytes, uint16_t value) {
  bytes[0] = static_cast<uint8_t>(value);
  bytes[1] = static_cast<uint8_t>(value >> 8);
}

inline uint16_t get_u16(const uint8_t* bytes) {
  return static_cast<uint16_t>(bytes[0] | static_cast<uint16_t>(bytes[1]) << 8);
}

inline void put_i24(uint8_t* bytes, int32_t value) {
  const uint32_t bits = static_cast<uint32_t>(value);
  bytes[0] = static_cast<uint8_t>(bits);
  bytes[1] = static_cast<uint8_t>(bits >> 8);
  bytes[2] = static_cast<uint8_t>(bits >> 16);
}

inline int32_t get_i24(const uint8_t* bytes) {
  const int32_t value =
      static_cast<int32_t>(bytes[0]) | static_cast<int32_t>(bytes[1]) << 8 | static_cast<int32_t>(bytes[2]) << 16;
  return value >= (1L << 23) ? value - (1L << 24) : value;
}

inline uint8_t count_bits(uint8_t mask) {
  uint8_t count = 0;
  for (; mask != 0; mask = static_cast<uint8_t>(mask & (mask - 1))) ++count;
  return count;
}

constexpr bool is_configuration(uint8_t kind) {
  return kind == kind_configure_board || kind == kind_configure_motor || kind == kind_configure_channel;
}

// Those that are done once, however often they arrive.
constexpr bool is_numbered(uint8_t kind) {
  return (kind >= kind_configure_board && kind <= kind_clear) || kind == kind_configure_channel;
}

// Whether a payload has the length that its kind asks for; false for unknown kinds.
inline bool length_fits(uint8_t kind, const uint8_t* payload, uint8_t length) {
  switch (kind) {
    case kind_hello:
      return length == hello::length;
    case kind_alive:
    case kind_emergency_stop:
      return length == 0;
    case kind_configure_board:
      return length == board::length;
    case kind_configure_motor:
      return length == motor::length;
    case kind_configure_channel:
      return length == channel::length;
    case kind_go_to:
      return length >= 1 && payload[0] != 0 && length == 1 + go_to::position_size * count_bits(payload[0]);
    case kind_zero:
    case kind_soft_stop:
    case kind_clear:
      return length == drives_mask::length;
    case kind_welcome:
      return length == welcome::length;
    case kind_acknowledge:
      return length == acknowledge::length;
    case kind_state:
      return length == state::length;
    default:
      return false;
  }
}

}  // namespace wire
}  // namespace soft_robot_lab
