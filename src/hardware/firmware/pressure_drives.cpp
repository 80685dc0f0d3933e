// SPDX-License-Identifier: BSD-3-Clause
// Pressure channels as a session drives them.
#include "drives.h"
#include "pressures.h"

namespace soft_robot_lab {
namespace drives {

wire::Firmware firmware() { return wire::firmware_pressures; }

void start() { pressures::start(); }

void tick(uint16_t now_ms) { pressures::tick(now_ms); }

uint8_t capacity() { return wire::max_channels; }

uint8_t count() { return pressures::count(); }

wire::Result configure_board(uint8_t count) {
  if (count == 0 || count > wire::max_channels) return wire::result_no_motor;
  pressures::set_count(count);
  return wire::result_done;
}

uint16_t configuration_crc(uint8_t drive, uint16_t crc) {
  return wire::crc16(pressures::configuration(drive), wire::channel::length, crc);
}

wire::Result execute(const wire::Frame& request) {
  const uint8_t mask = request.payload[0];
  switch (request.kind) {
    case wire::kind_configure_channel:
      return pressures::configure(request.payload);
    case wire::kind_go_to:
      return pressures::go_to(mask, request.payload + wire::go_to::positions);
    case wire::kind_soft_stop:
      return pressures::vent(mask);
    case wire::kind_clear:
      return pressures::clear(mask);
    default:
      return wire::result_bad_value;
  }
}

void emergency_stop() { pressures::emergency_stop(); }

void stop_for_silence() { pressures::stop_for_silence(); }

void measure() {}  // all the time

bool take_arrived(uint8_t drive) { return pressures::take_arrived(drive); }

uint16_t flags(uint8_t drive) { return pressures::flags(drive); }

int32_t position(uint8_t drive) { return pressures::pressure_pa(drive); }

int32_t target(uint8_t drive) { return pressures::set_point_pa(drive); }

}  // namespace drives
}  // namespace soft_robot_lab
