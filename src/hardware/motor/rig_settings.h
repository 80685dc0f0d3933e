// SPDX-License-Identifier: BSD-3-Clause
// What a rig's YAML file says: the device, and of each motor in the chain what it pulls and how it is driven, or of
// each pressure channel how it is fed and measured.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drive_limits.h"
#include "pressure_settings.h"
#include "wire.h"

namespace soft_robot_lab {

// How an L6470 drives its motor. Speeds and accelerations are in full steps.
struct DriveSettings {
  double max_speed_steps_s = 320.0;        // (0, 15610]; the lab's pull takes 50.4 ms per mm of 16 steps
  double acceleration_steps_s2 = 16000.0;  // (0, 59590]; and 19.9 ms beside
  double deceleration_steps_s2 = 16000.0;  // (0, 59590]
  int microsteps = 16;                     // 1, 2, 4 ... 128
  double hold_voltage_ratio = 0.16;        // of the supply's, [0, 1)
  double run_voltage = 0.16;
  double acceleration_voltage = 0.16;
  double overcurrent_a = 3.375;  // [0.375, 6]; switches the bridges off
  double stall_a = 2.03125;      // [0.03125, 4]; a smaller back-EMF current counts as lost steps
};

struct MotorSettings : DriveLimits {
  double rest_value = 1.0;  // of the actuator's command, at position 0
  double steps_per_value = 0.0;
  double step_m = 0.0;          // cable pulled per full step; 0 for a syringe
  int direction = 1;            // 1 or -1: which way the shaft turns to pull, or to press
  double backlash_steps = 0.0;  // the shaft turns so far before the spool follows
  DriveSettings drive;
};

struct RigSettings {
  std::string device;       // a stable name, as below /dev/serial/by-id
  double watchdog_s = 0.5;  // [0.1, 60]; the board stops all drives when the host has been silent for so long
  double min_command_period_s = 0.005;    // [0, 10]; commands closer to the last one are refused
  std::vector<MotorSettings> motors;      // in the order of the chain, from the board on; or
  std::vector<ChannelSettings> channels;  // in the order of the board's pins

  wire::Firmware firmware() const { return channels.empty() ? wire::firmware_motors : wire::firmware_pressures; }
};

struct BoardRequest {
  wire::Kind kind;
  std::vector<std::uint8_t> payload;
};

// Throws SettingsError: file, line, key, value and allowed range.
RigSettings load_rig(const std::string& path);
RigSettings parse_rig(const std::string& text, const std::string& source_name);

// Shaft positions in full steps for values of the command, and back; without backlash.
double steps_of(const MotorSettings& motor, double value);  // the nearest full step
double value_of(const MotorSettings& motor, double steps);

// As the board gets them.
std::vector<std::uint8_t> board_payload(const RigSettings& rig);
std::vector<std::uint8_t> motor_payload(const RigSettings& rig, int motor);
std::vector<BoardRequest> configuration(const RigSettings& rig);  // all of it
std::uint16_t configuration_crc(const RigSettings& rig);

std::vector<DriveLimits> drive_limits(const RigSettings& rig);
// Why a board with so many drives cannot drive this rig, or empty.
std::string why_not_driven(const RigSettings& rig, int drives_of_board);
// For what knows motors alone; throws std::invalid_argument for a rig of pressure channels.
void require_motors(const RigSettings& rig, const std::string& who);

// What the registers make of the wishes [full steps/s and full steps/s^2].
double driven_speed(const DriveSettings& drive);
double driven_acceleration(const DriveSettings& drive);

}  // namespace soft_robot_lab
