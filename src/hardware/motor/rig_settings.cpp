// SPDX-License-Identifier: BSD-3-Clause
#include "rig_settings.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "framing.h"
#include "l6470.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

constexpr double kval_unit = 1.0 / 256.0;
constexpr double overcurrent_unit_a = 0.375;  // register value 0 is one unit
constexpr double stall_unit_a = 0.03125;

DriveSettings read_drive(const YamlNode& node, DriveSettings drive) {
  const AllowedRange speed{l6470::max_speed_unit_steps_s, 1023.0 * l6470::max_speed_unit_steps_s};
  const AllowedRange acceleration{l6470::acceleration_unit_steps_s2, 4095.0 * l6470::acceleration_unit_steps_s2};
  const AllowedRange voltage{0.0, 1.0, false, true};
  drive.max_speed_steps_s = node.number_or("max_speed_steps_s", drive.max_speed_steps_s, speed);
  drive.acceleration_steps_s2 = node.number_or("acceleration_steps_s2", drive.acceleration_steps_s2, acceleration);
  drive.deceleration_steps_s2 = node.number_or("deceleration_steps_s2", drive.deceleration_steps_s2, acceleration);
  drive.microsteps = node.integer_or("microsteps", drive.microsteps, 1, 128);
  if ((drive.microsteps & (drive.microsteps - 1)) != 0) node.fail("microsteps: not a power of two");
  drive.hold_voltage_ratio = node.number_or("hold_voltage_ratio", drive.hold_voltage_ratio, voltage);
  drive.run_voltage = node.number_or("run_voltage", drive.run_voltage, voltage);
  drive.acceleration_voltage = node.number_or("acceleration_voltage", drive.acceleration_voltage, voltage);
  drive.overcurrent_a = node.number_or("overcurrent_a", drive.overcurrent_a, {overcurrent_unit_a, 6.0});
  drive.stall_a = node.number_or("stall_a", drive.stall_a, {stall_unit_a, 4.0});
  return drive;
}

void read_cable(const YamlNode& node, MotorSettings& motor) {
  const double rest_length_m = node.number("rest_length_m", AllowedRange::positive());
  motor.step_m = node.number_or("step_m", 6.25e-5, AllowedRange::positive());
  motor.rest_value = 1.0;
  motor.steps_per_value = -rest_length_m / motor.step_m;
  motor.min_key = "min_contraction";
  motor.max_key = "max_contraction";
  motor.min_value = node.number("min_contraction", {0.0, 1.0});
  motor.max_value = node.number("max_contraction", {1.0, 2.0});
}

void read_syringe(const YamlNode& node, MotorSettings& motor) {
  motor.rest_value = node.number_or("rest_ml", 0.0);
  motor.steps_per_value = 1.0 / node.number("step_ml", AllowedRange::positive());
  motor.min_key = "min_ml";
  motor.max_key = "max_ml";
  motor.min_value = node.number("min_ml");
  motor.max_value = node.number("max_ml", {motor.min_value, INFINITY});
}

double microsteps_of(const MotorSettings& motor, double value) {
  return steps_of(motor, value) * motor.drive.microsteps;
}

// The board's limits, in the order of its positions. Backlash is made up for beyond the released end.
std::pair<double, double> limits(const MotorSettings& motor) {
  const double a = microsteps_of(motor, motor.min_value);
  const double b = microsteps_of(motor, motor.max_value);
  double low = std::min(a, b);
  double high = std::max(a, b);
  const double play = std::ceil(motor.backlash_steps) * motor.drive.microsteps;
  (motor.direction > 0 ? low : high) -= motor.direction * play;
  return {low, high};
}

MotorSettings read_motor(const YamlNode& node, const DriveSettings& drive) {
  MotorSettings motor;
  motor.name = node.text("name");
  if (node.has("cable") == node.has("syringe")) node.fail("give either cable or syringe");
  if (const auto cable = node.optional_child("cable")) read_cable(*cable, motor);
  if (const auto syringe = node.optional_child("syringe")) read_syringe(*syringe, motor);
  motor.direction = node.integer_or("direction", 1, -1, 1);
  if (motor.direction == 0) node.fail("direction: 0 is neither 1 nor -1");
  motor.backlash_steps = node.number_or("backlash_steps", 0.0, {0.0, 1000.0});
  const auto own_drive = node.optional_child("drive");
  motor.drive = own_drive ? read_drive(*own_drive, drive) : drive;
  const auto [low, high] = limits(motor);
  if (low < -wire::max_position || high > wire::max_position) node.fail("its limits are beyond 22 bits of microsteps");
  return motor;
}

std::vector<MotorSettings> read_motors(const YamlNode& node) {
  const auto common = node.optional_child("drive");
  const DriveSettings drive = common ? read_drive(*common, {}) : DriveSettings{};
  std::vector<MotorSettings> motors;
  for (const YamlNode& item : node.sequence("motors")) motors.push_back(read_motor(item, drive));
  if (motors.empty() || motors.size() > wire::max_motors) {
    node.fail("motors: " + std::to_string(motors.size()) + " is not in [1, 6]");
  }
  return motors;
}

void require_different_names(const YamlNode& node, const RigSettings& rig) {
  const auto items = node.sequence(rig.channels.empty() ? "motors" : "channels");
  const auto limits = drive_limits(rig);
  std::set<std::string> names;
  for (std::size_t i = 0; i < limits.size(); ++i)
    if (!names.insert(limits[i].name).second) items[i].fail("name: '" + limits[i].name + "' again");
}

RigSettings read_rig(const YamlNode& node) {
  RigSettings rig;
  rig.device = node.text("device");
  rig.watchdog_s = node.number_or("watchdog_s", rig.watchdog_s, {0.1, 60.0});
  rig.min_command_period_s = node.number_or("min_command_period_s", rig.min_command_period_s, {0.0, 10.0});
  if (node.has("motors") && node.has("channels"))
    node.fail("motors, channels: a board has motors or pressure channels, not both; give each its own file");
  if (node.has("channels")) {
    rig.channels = read_channels(node);
  } else {
    rig.motors = read_motors(node);
  }
  require_different_names(node, rig);
  node.require_all_read();
  return rig;
}

std::uint16_t to_units(double value, double unit) { return static_cast<std::uint16_t>(std::lround(value / unit)); }

std::uint8_t to_kval(double voltage) {
  return static_cast<std::uint8_t>(std::min<std::uint16_t>(255, to_units(voltage, kval_unit)));
}

std::uint8_t to_threshold(double current_a, double unit_a) {
  return static_cast<std::uint8_t>(to_units(current_a, unit_a) - 1);
}

}  // namespace

RigSettings load_rig(const std::string& path) { return read_rig(YamlNode::load_file(path)); }

RigSettings parse_rig(const std::string& text, const std::string& source_name) {
  return read_rig(YamlNode::parse(text, source_name));
}

double steps_of(const MotorSettings& motor, double value) {
  return motor.direction * std::round((value - motor.rest_value) * motor.steps_per_value);
}

double value_of(const MotorSettings& motor, double steps) {
  return motor.rest_value + motor.direction * steps / motor.steps_per_value;
}

std::vector<std::uint8_t> board_payload(const RigSettings& rig) {
  std::vector<std::uint8_t> bytes(wire::board::length);
  bytes[wire::board::drive_count] = static_cast<std::uint8_t>(drive_limits(rig).size());
  wire::put_u16(&bytes[wire::board::watchdog_ms], to_units(rig.watchdog_s, 1e-3));
  return bytes;
}

std::vector<std::uint8_t> motor_payload(const RigSettings& rig, int index) {
  const MotorSettings& motor = rig.motors.at(static_cast<std::size_t>(index));
  const DriveSettings& drive = motor.drive;
  std::vector<std::uint8_t> bytes(wire::motor::length);
  bytes[wire::motor::index] = static_cast<std::uint8_t>(index);
  bytes[wire::motor::step_mode] = static_cast<std::uint8_t>(std::lround(std::log2(drive.microsteps)));
  wire::put_u16(&bytes[wire::motor::max_speed], to_units(drive.max_speed_steps_s, l6470::max_speed_unit_steps_s));
  const double unit = l6470::acceleration_unit_steps_s2;
  wire::put_u16(&bytes[wire::motor::acceleration], to_units(drive.acceleration_steps_s2, unit));
  wire::put_u16(&bytes[wire::motor::deceleration], to_units(drive.deceleration_steps_s2, unit));
  bytes[wire::motor::kval_hold] = to_kval(drive.hold_voltage_ratio);
  bytes[wire::motor::kval_run] = to_kval(drive.run_voltage);
  bytes[wire::motor::kval_acceleration] = to_kval(drive.acceleration_voltage);
  bytes[wire::motor::kval_deceleration] = to_kval(drive.acceleration_voltage);
  bytes[wire::motor::overcurrent_threshold] = to_threshold(drive.overcurrent_a, overcurrent_unit_a);
  bytes[wire::motor::stall_threshold] = to_threshold(drive.stall_a, stall_unit_a);
  const auto [low, high] = limits(motor);
  wire::put_i24(&bytes[wire::motor::min_position], static_cast<std::int32_t>(low));
  wire::put_i24(&bytes[wire::motor::max_position], static_cast<std::int32_t>(high));
  return bytes;
}

std::vector<BoardRequest> configuration(const RigSettings& rig) {
  std::vector<BoardRequest> requests{{wire::kind_configure_board, board_payload(rig)}};
  for (std::size_t i = 0; i < rig.motors.size(); ++i)
    requests.push_back({wire::kind_configure_motor, motor_payload(rig, static_cast<int>(i))});
  for (std::size_t i = 0; i < rig.channels.size(); ++i)
    requests.push_back({wire::kind_configure_channel, channel_payload(rig.channels[i], static_cast<int>(i))});
  return requests;
}

std::uint16_t configuration_crc(const RigSettings& rig) {
  std::uint16_t crc = wire::crc_start;
  for (const BoardRequest& request : configuration(rig))
    crc = wire::crc16(request.payload.data(), static_cast<std::uint8_t>(request.payload.size()), crc);
  return crc;
}

std::vector<DriveLimits> drive_limits(const RigSettings& rig) {
  std::vector<DriveLimits> limits(rig.motors.begin(), rig.motors.end());
  limits.insert(limits.end(), rig.channels.begin(), rig.channels.end());
  return limits;
}

std::string why_not_driven(const RigSettings& rig, int drives_of_board) {
  const std::string there = std::to_string(drives_of_board);
  const auto listed = static_cast<int>(drive_limits(rig).size());
  if (rig.channels.empty() && drives_of_board != listed)
    return "the board found " + there + " motor drivers, the rig's file lists " + std::to_string(listed);
  if (!rig.channels.empty() && drives_of_board < listed)
    return "the board has " + there + " pressure channels, the rig's file lists " + std::to_string(listed);
  return "";
}

void require_motors(const RigSettings& rig, const std::string& who) {
  if (rig.motors.empty())
    throw std::invalid_argument("channels: " + who + " takes a rig of motors, not of pressure channels");
}

double driven_speed(const DriveSettings& drive) {
  return to_units(drive.max_speed_steps_s, l6470::max_speed_unit_steps_s) * l6470::max_speed_unit_steps_s;
}

double driven_acceleration(const DriveSettings& drive) {
  return to_units(drive.acceleration_steps_s2, l6470::acceleration_unit_steps_s2) * l6470::acceleration_unit_steps_s2;
}

}  // namespace soft_robot_lab
