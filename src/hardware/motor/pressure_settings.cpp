// SPDX-License-Identifier: BSD-3-Clause
#include "pressure_settings.h"

#include <cmath>

namespace soft_robot_lab {
namespace {

constexpr double kHighest_pa = 8.0e6;     // 24 bits with sign
constexpr double kHighestU16_pa = 65535;  // of tolerances
constexpr double kBoard_v = 5.0;          // what its converter calls full

SensorSettings read_sensor(const YamlNode& node, SensorSettings sensor) {
  sensor.zero_v = node.number_or("zero_v", sensor.zero_v, {0.2, 2.0});
  sensor.full_v = node.number_or("full_v", sensor.full_v, {2.2, 4.8});
  sensor.full_pa = sensor.full_pa > 0.0 ? node.number_or("full_pa", sensor.full_pa, {0.0, kHighest_pa, true})
                                        : node.number("full_pa", {0.0, kHighest_pa, true});
  return sensor;
}

WatchSettings read_watch(const YamlNode& node, WatchSettings watch) {
  watch.tolerance_pa = node.number_or("tolerance_pa", watch.tolerance_pa, {1.0, kHighestU16_pa});
  watch.least_change_pa = node.number_or("least_change_pa", watch.least_change_pa, {1.0, watch.tolerance_pa});
  watch.fault_s = node.number_or("fault_s", watch.fault_s, {0.05, 0.4});
  return watch;
}

void read_output(const YamlNode& node, ChannelSettings& channel) {
  if (node.has("regulator") == node.has("valves")) node.fail("give either regulator or valves");
  if (const auto regulator = node.optional_child("regulator"))
    channel.output_pa = regulator->number("full_pa", {0.0, kHighest_pa, true});
  if (const auto valves = node.optional_child("valves"))
    channel.deadband_pa = valves->number("deadband_pa", {1.0, channel.watch.tolerance_pa, false, true});
}

ChannelSettings read_channel(const YamlNode& node, const SensorSettings& sensor, const WatchSettings& watch) {
  ChannelSettings channel;
  channel.name = node.text("name");
  const auto own_sensor = node.optional_child("sensor");
  channel.sensor = own_sensor ? read_sensor(*own_sensor, sensor) : sensor;
  if (!(channel.sensor.full_pa > 0.0)) node.fail("sensor: missing, here or for all channels: {full_pa: ...}");
  const auto own_watch = node.optional_child("watch");
  channel.watch = own_watch ? read_watch(*own_watch, watch) : watch;
  read_output(node, channel);
  // A pressure beyond its limit has to be seen.
  const double seen_pa = channel.sensor.full_pa - channel.watch.tolerance_pa;
  if (seen_pa <= 0.0) node.fail("watch.tolerance_pa: as large as the whole range of the sensor, sensor.full_pa");
  channel.max_key = "max_pa";
  channel.max_value = node.number("max_pa", {0.0, seen_pa, true});
  if (channel.output_pa > 0.0 && channel.max_value > channel.output_pa)
    node.fail("max_pa: " + std::to_string(channel.max_value) +
              " is more than regulator.full_pa = " + std::to_string(channel.output_pa));
  return channel;
}

// The sum of the board's conversions at a voltage.
std::uint16_t counts(double voltage_v) {
  return static_cast<std::uint16_t>(std::lround(voltage_v / kBoard_v * 1024.0 * wire::channel::samples));
}

std::int32_t whole_pa(double pressure_pa) { return static_cast<std::int32_t>(std::lround(pressure_pa)); }

std::uint16_t to_u16(double value) { return static_cast<std::uint16_t>(std::lround(value)); }

}  // namespace

std::vector<ChannelSettings> read_channels(const YamlNode& node) {
  const auto sensor_node = node.optional_child("sensor");
  const SensorSettings sensor = sensor_node ? read_sensor(*sensor_node, {}) : SensorSettings{};
  const auto watch_node = node.optional_child("watch");
  const WatchSettings watch = watch_node ? read_watch(*watch_node, {}) : WatchSettings{};
  std::vector<ChannelSettings> channels;
  for (const YamlNode& item : node.sequence("channels")) channels.push_back(read_channel(item, sensor, watch));
  if (channels.empty() || channels.size() > wire::max_channels)
    node.fail("channels: " + std::to_string(channels.size()) + " is not in [1, 4]");
  return channels;
}

std::vector<std::uint8_t> channel_payload(const ChannelSettings& channel, int index) {
  std::vector<std::uint8_t> bytes(wire::channel::length);
  bytes[wire::channel::index] = static_cast<std::uint8_t>(index);
  wire::put_u16(&bytes[wire::channel::sensor_zero], counts(channel.sensor.zero_v));
  wire::put_u16(&bytes[wire::channel::sensor_full], counts(channel.sensor.full_v));
  wire::put_i24(&bytes[wire::channel::sensor_pa], whole_pa(channel.sensor.full_pa));
  wire::put_i24(&bytes[wire::channel::output_pa], whole_pa(channel.output_pa));
  wire::put_i24(&bytes[wire::channel::max_pa], whole_pa(channel.max_value));
  wire::put_u16(&bytes[wire::channel::deadband_pa], to_u16(channel.deadband_pa));
  wire::put_u16(&bytes[wire::channel::tolerance_pa], to_u16(channel.watch.tolerance_pa));
  wire::put_u16(&bytes[wire::channel::least_change_pa], to_u16(channel.watch.least_change_pa));
  wire::put_u16(&bytes[wire::channel::fault_ms], to_u16(1000.0 * channel.watch.fault_s));
  return bytes;
}

}  // namespace soft_robot_lab
