// SPDX-License-Identifier: BSD-3-Clause
#include "pressures.h"

#include "air_pins.h"

namespace soft_robot_lab {
namespace pressures {
namespace {

constexpr uint16_t highest_sum = 1023 * wire::channel::samples;
constexpr uint8_t bad_in_a_row = 3;  // measurements until they are believed

struct Channel {
  int32_t pressure_pa = 0;
  int32_t smooth_eighths_pa = 0;  // the mean of the last measurements, for what watches
  int32_t set_point_pa = 0;
  int32_t max_pa = 0;
  int32_t output_pa = 0;  // of a regulator at full duty; 0: valves
  float pa_per_count = 0;
  uint16_t sensor_zero = 0, lowest = 0, highest = 0;  // sums of samples
  uint16_t deadband_pa = 0, tolerance_pa = 0, least_change_pa = 0, fault_ms = 0;
  uint16_t flags = 0;
  bool configured = false;
  bool filling = false, venting = false;  // by valves
  uint32_t duty = 0;                      // of a regulator, in 65536ths
  uint8_t carry = 0;                      // of the duty's lower byte
  bool away = false, was_away = false;    // from the set point by more than the tolerance
  bool low = false;                       // since it is away: below the set point
  bool arrived = false;                   // reported once
  int32_t from_pa = 0;                    // from where it has to come nearer
  uint16_t from_ms = 0;
  uint8_t bad_sums = 0, high_pressures = 0;
  uint8_t configuration[wire::channel::length] = {};
};

Channel all[wire::max_channels];
uint8_t channels = 0;

bool has(uint8_t mask, uint8_t channel) { return (mask & 1 << channel) != 0; }
bool exists(uint8_t mask) { return mask != 0 && (mask >> channels) == 0; }

void set_target(Channel& channel, int32_t pa) {
  channel.set_point_pa = pa;
  channel.filling = channel.venting = false;
  channel.duty = pa <= 0 || channel.output_pa == 0
                     ? 0
                     : static_cast<uint32_t>(65536.0f * static_cast<float>(pa) / static_cast<float>(channel.output_pa));
  if (pa > 0) channel.flags &= ~wire::flag_host_silent;
}

void depressurise_all() {
  for (Channel& channel : all) set_target(channel, 0);
}

void fail(Channel& channel, uint16_t flag) {
  channel.flags |= flag;
  channel.away = false;
  depressurise_all();
}

// Away from its set point a sound channel comes nearer all the time; a sensor's noise must not pass for that.
void watch(Channel& channel, uint16_t now) {
  const int32_t pressure_pa = channel.smooth_eighths_pa / 8;
  const int32_t error = channel.set_point_pa - pressure_pa;
  const bool low = error > 0;
  const bool away = (low ? error : -error) > channel.tolerance_pa;
  const bool begins = away && (!channel.away || low != channel.low);
  channel.away = away;
  channel.low = low;
  if (!away) return;
  const int32_t nearer = low ? pressure_pa - channel.from_pa : channel.from_pa - pressure_pa;
  if (begins || nearer >= channel.least_change_pa) {
    channel.from_pa = pressure_pa;
    channel.from_ms = now;
  } else if (static_cast<uint16_t>(now - channel.from_ms) >= channel.fault_ms) {
    const bool lost = low && (nearer <= -static_cast<int32_t>(channel.least_change_pa) ||
                              pressure_pa < static_cast<int32_t>(channel.tolerance_pa));
    fail(channel, lost ? wire::flag_burst : wire::flag_stuck);
  }
}

// Valves open beyond the deadband, and close halfway back, as air goes on to flow until the next measurement.
void switch_valves(Channel& channel) {
  const int32_t error = channel.set_point_pa - channel.pressure_pa;
  const int32_t open_at = channel.deadband_pa, close_at = channel.deadband_pa / 2;
  channel.filling = error > (channel.filling ? close_at : open_at);
  channel.venting = -error > (channel.venting ? close_at : open_at);
}

void measure(Channel& channel, uint16_t sum, uint16_t now) {
  const bool sound = sum >= channel.lowest && sum <= channel.highest;
  channel.bad_sums = sound ? 0 : static_cast<uint8_t>(channel.bad_sums + 1);
  const bool faulty = (channel.flags & wire::fault_flags) != 0;
  if (!sound) {
    if (channel.bad_sums < bad_in_a_row) return;
    channel.bad_sums = bad_in_a_row;
    channel.flags &= ~wire::flag_known;
    if ((channel.flags & wire::flag_sensor) == 0) fail(channel, wire::flag_sensor);
    return;
  }
  const bool first = (channel.flags & wire::flag_known) == 0;
  channel.flags |= wire::flag_known;
  const int32_t counts = static_cast<int32_t>(sum) - static_cast<int32_t>(channel.sensor_zero);
  channel.pressure_pa = static_cast<int32_t>(static_cast<float>(counts) * channel.pa_per_count);
  channel.smooth_eighths_pa =
      first ? 8 * channel.pressure_pa : channel.smooth_eighths_pa + channel.pressure_pa - channel.smooth_eighths_pa / 8;
  if (faulty) return;
  const bool high = channel.pressure_pa > channel.max_pa + static_cast<int32_t>(channel.tolerance_pa);
  channel.high_pressures = high ? static_cast<uint8_t>(channel.high_pressures + 1) : 0;
  if (channel.high_pressures >= bad_in_a_row) {
    channel.high_pressures = 0;
    return fail(channel, wire::flag_over_pressure);
  }
  watch(channel, now);
  if (channel.output_pa == 0) switch_valves(channel);
}

bool may_hold(const Channel& channel) { return channel.configured && channel.set_point_pa > 0; }

// Where the vent is stuck, the way back to the supply's valve is open to the air, once that has shut.
bool leaves_by_supply(const Channel& channel) {
  return (channel.flags & wire::flag_stuck) != 0 && channel.output_pa == 0 &&
         channel.pressure_pa > static_cast<int32_t>(channel.tolerance_pa);
}

void set_pins(uint8_t i) {
  Channel& channel = all[i];
  const bool holds = may_hold(channel);
  air_pins::set_hold(i, holds && !channel.venting);
  if (!holds) {
    air_pins::set_fill(i, leaves_by_supply(channel) ? 256 : 0);
  } else if (channel.output_pa == 0) {
    air_pins::set_fill(i, channel.filling ? 256 : 0);
  } else {  // the lower byte of the duty as one more 256th from time to time
    const uint16_t sum = static_cast<uint16_t>(channel.carry + (channel.duty & 0xff));
    channel.carry = static_cast<uint8_t>(sum);
    air_pins::set_fill(i, static_cast<uint16_t>((channel.duty >> 8) + (sum >> 8)));
  }
}

}  // namespace

void start() { air_pins::start(); }

void set_count(uint8_t count) {
  depressurise_all();
  for (Channel& channel : all) channel.configured = false;
  for (uint8_t i = 0; i < wire::max_channels; ++i) set_pins(i);
  channels = count;
  air_pins::set_channels(count);
}

uint8_t count() { return channels; }

void tick(uint16_t now_ms) {
  uint16_t sums[wire::max_channels];
  if (air_pins::take(sums)) {
    for (uint8_t i = 0; i < channels; ++i) {
      if (all[i].configured) measure(all[i], sums[i], now_ms);
    }
  }
  bool any = false;
  for (uint8_t i = 0; i < channels; ++i) {
    Channel& channel = all[i];
    if (channel.was_away && !channel.away) channel.arrived = true;
    channel.was_away = channel.away;
    any = any || may_hold(channel);
  }
  air_pins::set_supply(any);
  for (uint8_t i = 0; i < channels; ++i) set_pins(i);
}

wire::Result configure(const uint8_t* payload) {
  const uint8_t index = payload[wire::channel::index];
  if (index >= channels) return wire::result_no_motor;
  const uint16_t zero = wire::get_u16(payload + wire::channel::sensor_zero);
  const uint16_t full = wire::get_u16(payload + wire::channel::sensor_full);
  const int32_t sensor_pa = wire::get_i24(payload + wire::channel::sensor_pa);
  const int32_t max_pa = wire::get_i24(payload + wire::channel::max_pa);
  const int32_t output_pa = wire::get_i24(payload + wire::channel::output_pa);
  if (zero >= full || full > highest_sum || sensor_pa <= 0 || max_pa <= 0 || output_pa < 0 ||
      (output_pa > 0 && max_pa > output_pa)) {
    return wire::result_bad_value;
  }
  Channel& channel = all[index];
  set_target(channel, 0);
  channel.max_pa = max_pa;
  channel.output_pa = output_pa;
  channel.pa_per_count = static_cast<float>(sensor_pa) / static_cast<float>(full - zero);
  channel.sensor_zero = zero;
  channel.lowest = zero / 2;
  channel.highest = static_cast<uint16_t>(full + (highest_sum - full) / 2);
  channel.deadband_pa = wire::get_u16(payload + wire::channel::deadband_pa);
  channel.tolerance_pa = wire::get_u16(payload + wire::channel::tolerance_pa);
  channel.least_change_pa = wire::get_u16(payload + wire::channel::least_change_pa);
  channel.fault_ms = wire::get_u16(payload + wire::channel::fault_ms);
  channel.flags &= ~wire::flag_known;
  channel.bad_sums = channel.high_pressures = 0;
  channel.away = false;
  for (uint8_t i = 0; i < wire::channel::length; ++i) channel.configuration[i] = payload[i];
  channel.configured = true;
  return wire::result_done;
}

wire::Result go_to(uint8_t mask, const uint8_t* set_points) {
  if (!exists(mask)) return wire::result_no_motor;
  for (uint8_t i = 0; i < channels; ++i) {
    if ((all[i].flags & wire::flag_emergency_stop) != 0) return wire::result_emergency_stop;
    if ((all[i].flags & wire::fault_flags) != 0) return wire::result_fault;
  }
  int32_t targets[wire::max_channels];
  for (uint8_t i = 0; i < channels; ++i) {
    if (!has(mask, i)) continue;
    targets[i] = wire::get_i24(set_points);
    set_points += wire::go_to::position_size;
    if (!all[i].configured) return wire::result_not_configured;
    if ((all[i].flags & wire::flag_known) == 0) return wire::result_position_unknown;
    if (targets[i] < 0 || targets[i] > all[i].max_pa) return wire::result_beyond_limit;
  }
  for (uint8_t i = 0; i < channels; ++i) {
    if (has(mask, i)) set_target(all[i], targets[i]);
  }
  return wire::result_done;
}

wire::Result vent(uint8_t mask) {
  if (!exists(mask)) return wire::result_no_motor;
  for (uint8_t i = 0; i < channels; ++i) {
    if (has(mask, i)) set_target(all[i], 0);
  }
  return wire::result_done;
}

wire::Result clear(uint8_t mask) {
  if (!exists(mask)) return wire::result_no_motor;
  for (uint8_t i = 0; i < channels; ++i) {
    if (!has(mask, i)) continue;
    all[i].flags &= ~(wire::fault_flags | wire::flag_emergency_stop);
    all[i].bad_sums = all[i].high_pressures = 0;
    all[i].away = false;
  }
  return wire::result_done;
}

void emergency_stop() {
  depressurise_all();
  for (Channel& channel : all) channel.flags |= wire::flag_emergency_stop;
}

void stop_for_silence() {
  depressurise_all();
  for (Channel& channel : all) channel.flags |= wire::flag_host_silent;
}

bool take_arrived(uint8_t channel) {
  const bool arrived = all[channel].arrived;
  all[channel].arrived = false;
  return arrived;
}

uint16_t flags(uint8_t channel) {
  return all[channel].away ? all[channel].flags | wire::flag_moving : all[channel].flags;
}

int32_t pressure_pa(uint8_t channel) { return all[channel].pressure_pa; }

int32_t set_point_pa(uint8_t channel) { return all[channel].set_point_pa; }

const uint8_t* configuration(uint8_t channel) { return all[channel].configuration; }

}  // namespace pressures
}  // namespace soft_robot_lab
