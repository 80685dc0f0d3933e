// SPDX-License-Identifier: BSD-3-Clause
// Rig files: what they mean on the board, and what they may not say.
#include <filesystem>

#include <gtest/gtest.h>

#include "hardware/motor/framing.h"
#include "hardware/motor/rig_settings.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

std::string rig_with(const std::string& motor, const std::string& top = "") {
  return "device: /dev/null\n" + top + "motors:\n  - {name: a, " + motor + "}\n";
}

const std::string cable = "cable: {rest_length_m: 0.1, min_contraction: 0.6, max_contraction: 1.2}";

std::string refusal(const std::string& yaml) {
  try {
    parse_rig(yaml, "rig.yaml");
  } catch (const SettingsError& error) {
    return error.what();
  }
  return "";
}

TEST(RigSettings, ReadsEveryRigOfThePackage) {
  int rigs = 0;
  for (const auto& file : std::filesystem::recursive_directory_iterator(SOFT_ROBOT_LAB_SOURCE "/config")) {
    if (file.path().filename() != "motors.yaml" && file.path().parent_path().filename() != "motors") continue;
    EXPECT_FALSE(drive_limits(load_rig(file.path())).empty()) << file.path();
    ++rigs;
  }
  EXPECT_GE(rigs, 5);
}

TEST(RigSettings, CountsTheStepsOfTheThesis) {
  const MotorSettings spinebot = load_rig(SOFT_ROBOT_LAB_SOURCE "/config/robots/spinebot/motors.yaml").motors[0];
  EXPECT_EQ(steps_of(spinebot, 0.8), 258);
  EXPECT_EQ(steps_of(spinebot, 1.1), -129);
  EXPECT_EQ(steps_of(spinebot, 0.9), 129);
  const MotorSettings hammerbot = load_rig(SOFT_ROBOT_LAB_SOURCE "/config/robots/hammerbot/motors.yaml").motors[0];
  EXPECT_EQ(steps_of(hammerbot, 1.2), -320);
  EXPECT_EQ(steps_of(hammerbot, 0.82), 288);
  EXPECT_EQ(steps_of(hammerbot, 0.7), 480);
  EXPECT_DOUBLE_EQ(value_of(hammerbot, 480), 0.7);
}

TEST(RigSettings, TurnsTheOtherWayWhereAMotorIsMountedTheOtherWay) {
  const RigSettings rig = parse_rig(rig_with(cable + ", direction: -1"), "rig.yaml");
  EXPECT_EQ(steps_of(rig.motors[0], 0.9), -160);
  EXPECT_DOUBLE_EQ(value_of(rig.motors[0], -160), 0.9);
  const auto payload = motor_payload(rig, 0);
  EXPECT_EQ(wire::get_i24(&payload[wire::motor::min_position]), -640 * 16);
  EXPECT_EQ(wire::get_i24(&payload[wire::motor::max_position]), 320 * 16);
}

TEST(RigSettings, DrivesSyringesByVolume) {
  const RigSettings rig = parse_rig(rig_with("syringe: {step_ml: 0.01, min_ml: 0, max_ml: 60}"), "rig.yaml");
  EXPECT_EQ(steps_of(rig.motors[0], 25.0), 2500);
  EXPECT_EQ(rig.motors[0].step_m, 0.0);
}

TEST(RigSettings, GivesTheBoardRegisterUnits) {
  const auto payload = motor_payload(parse_rig(rig_with(cable), "rig.yaml"), 0);
  EXPECT_EQ(payload[wire::motor::step_mode], 4);
  EXPECT_EQ(wire::get_u16(&payload[wire::motor::max_speed]), 21);
  EXPECT_EQ(wire::get_u16(&payload[wire::motor::acceleration]), 1100);
  EXPECT_EQ(payload[wire::motor::overcurrent_threshold], 8);
  EXPECT_EQ(payload[wire::motor::stall_threshold], 64);
  EXPECT_EQ(payload[wire::motor::kval_hold], 41);
}

TEST(RigSettings, LetsAMotorDifferFromTheOthers) {
  const RigSettings rig = parse_rig(
      rig_with(cable + ", drive: {max_speed_steps_s: 300}", "drive: {acceleration_steps_s2: 150, microsteps: 8}\n"),
      "rig.yaml");
  EXPECT_EQ(rig.motors[0].drive.max_speed_steps_s, 300);
  EXPECT_EQ(rig.motors[0].drive.acceleration_steps_s2, 150);
  EXPECT_EQ(rig.motors[0].drive.microsteps, 8);
  EXPECT_NEAR(driven_speed(rig.motors[0].drive), 300, 8);
  EXPECT_NEAR(driven_acceleration(rig.motors[0].drive), 150, 8);
}

TEST(RigSettings, RefusesWhatARigCannotBe) {
  const std::pair<std::string, std::string> table[] = {
      {rig_with(cable + ", direction: 0"), "direction: 0 is neither 1 nor -1"},
      {rig_with(cable + ", direction: 2"), "direction"},
      {rig_with(cable + ", backlash_steps: -1"), "backlash_steps"},
      {rig_with(cable + ", colour: red"), "colour"},
      {rig_with("direction: 1"), "give either cable or syringe"},
      {rig_with("cable: {rest_length_m: -0.1, min_contraction: 0.6, max_contraction: 1}"), "rest_length_m"},
      {rig_with("cable: {rest_length_m: 0.1, min_contraction: 1.6, max_contraction: 1}"), "min_contraction"},
      {rig_with("cable: {rest_length_m: 0.1, min_contraction: 0.6, max_contraction: 0.9}"), "max_contraction"},
      {rig_with("cable: {rest_length_m: 100, min_contraction: 0, max_contraction: 1}"), "22 bits"},
      {rig_with("syringe: {step_ml: 0, min_ml: 0, max_ml: 1}"), "step_ml"},
      {rig_with(cable + ", drive: {microsteps: 12}"), "microsteps"},
      {rig_with(cable + ", drive: {max_speed_steps_s: 0}"), "max_speed_steps_s"},
      {rig_with(cable + ", drive: {acceleration_steps_s2: 1e9}"), "acceleration_steps_s2"},
      {rig_with(cable + ", drive: {hold_voltage_ratio: 1}"), "hold_voltage_ratio"},
      {rig_with(cable + ", drive: {overcurrent_a: 7}"), "overcurrent_a"},
      {rig_with(cable, "watchdog_s: 0\n"), "watchdog_s"},
      {rig_with(cable, "min_command_period_s: -1\n"), "min_command_period_s"},
      {rig_with(cable) + "  - {name: a, " + cable + "}\n", "'a' again"},
      {"device: /dev/null\nmotors: []\n", "motors: 0 is not in [1, 6]"}};
  for (const auto& [yaml, message] : table) {
    EXPECT_NE(refusal(yaml).find(message), std::string::npos) << yaml << "said: " << refusal(yaml);
  }
}

std::string channels_with(const std::string& channel, const std::string& top = "sensor: {full_pa: 100000}\n") {
  return "device: /dev/null\n" + top + "channels:\n  - {name: a, " + channel + "}\n";
}

const std::string valves = "max_pa: 40000, valves: {deadband_pa: 1000}";

TEST(RigSettings, GivesTheBoardChannels) {
  const RigSettings rig = parse_rig(channels_with(valves), "rig.yaml");
  EXPECT_EQ(rig.firmware(), wire::firmware_pressures);
  const auto payload = channel_payload(rig.channels[0], 1);
  EXPECT_EQ(payload, (std::vector<std::uint8_t>{1,    0x66, 0x06, 0x9a, 0x39, 0xa0, 0x86, 1,    0, 0,    0,
                                                0x40, 0x9c, 0,    0xe8, 3,    0xd0, 7,    0x2c, 1, 0x2c, 1}));
  const RigSettings regulated =
      parse_rig(channels_with("max_pa: 40000, regulator: {full_pa: 50000}, sensor: {full_pa: 60000, zero_v: 1}"), "r");
  EXPECT_EQ(regulated.channels[0].output_pa, 50000);
  EXPECT_EQ(regulated.channels[0].sensor.zero_v, 1.0);
  EXPECT_EQ(regulated.channels[0].sensor.full_v, 4.5);
}

TEST(RigSettings, RefusesWhatAPressureRigCannotBe) {
  const std::string five = "  - {name: b, " + valves + "}\n  - {name: c, " + valves + "}\n  - {name: d, " + valves +
                           "}\n  - {name: e, " + valves + "}\n";
  const std::pair<std::string, std::string> table[] = {
      {channels_with("max_pa: 40000"), "give either regulator or valves"},
      {channels_with(valves + ", regulator: {full_pa: 50000}"), "give either regulator or valves"},
      {channels_with("max_pa: 60000, regulator: {full_pa: 50000}"), "is more than regulator.full_pa = 50000"},
      {channels_with("max_pa: 99000, valves: {deadband_pa: 1000}"), "max_pa: 99000 is out of range (0, 98000]"},
      {channels_with("valves: {deadband_pa: 1000}"), "max_pa"},
      {channels_with("max_pa: 40000, valves: {deadband_pa: 2000}"), "deadband_pa: 2000 is out of range [1, 2000)"},
      {channels_with(valves + ", colour: red"), "colour"},
      {channels_with(valves, ""), "sensor: missing"},
      {channels_with(valves, "sensor: {full_pa: 100000, zero_v: 0}\n"), "zero_v: 0 is out of range [0.2, 2]"},
      {channels_with(valves, "sensor: {full_pa: 100000, full_v: 5}\n"), "full_v"},
      {channels_with(valves + ", watch: {fault_s: 0.5}"), "fault_s: 0.5 is out of range [0.05, 0.4]"},
      {channels_with(valves + ", watch: {least_change_pa: 3000}"), "least_change_pa"},
      {channels_with(valves + ", watch: {tolerance_pa: 0}"), "tolerance_pa"},
      {channels_with(valves) + "  - {name: a, " + valves + "}\n", "'a' again"},
      {channels_with(valves) + five, "channels: 5 is not in [1, 4]"},
      {channels_with(valves) + "motors: []\n", "a board has motors or pressure channels, not both"},
      {channels_with(valves) + "drive: {microsteps: 8}\n", "drive"}};
  for (const auto& [yaml, message] : table) {
    EXPECT_NE(refusal(yaml).find(message), std::string::npos) << yaml << "said: " << refusal(yaml);
  }
}

}  // namespace
}  // namespace soft_robot_lab
