// SPDX-License-Identifier: BSD-3-Clause
// Stepper motors as a session drives them.
#include "chain.h"
#include "drives.h"
#include "motors.h"

namespace soft_robot_lab {
namespace drives {

wire::Firmware firmware() { return wire::firmware_motors; }

void start() {
  chain::start();
  motors::start();
}

void tick(uint16_t now_ms) {
  if (now_ms % motors::poll_period_ms == 0) motors::poll();
}

uint8_t capacity() { return chain::count(); }

uint8_t count() { return chain::count(); }

wire::Result configure_board(uint8_t count) {
  if (count != chain::count()) return wire::result_no_motor;
  for (uint8_t i = 0; i < count; ++i) {
    if ((motors::flags(i) & wire::flag_moving) != 0) return wire::result_moving;
  }
  return wire::result_done;
}

uint16_t configuration_crc(uint8_t drive, uint16_t crc) {
  return wire::crc16(motors::configuration(drive), wire::motor::length, crc);
}

wire::Result execute(const wire::Frame& request) {
  const uint8_t mask = request.payload[0];
  switch (request.kind) {
    case wire::kind_configure_motor:
      return motors::configure(request.payload);
    case wire::kind_go_to:
      return motors::go_to(mask, request.payload + wire::go_to::positions);
    case wire::kind_zero:
      return motors::zero(mask);
    case wire::kind_soft_stop:
      return motors::soft_stop(mask);
    case wire::kind_clear:
      return motors::clear(mask);
    default:
      return wire::result_bad_value;
  }
}

void emergency_stop() { motors::emergency_stop(); }

void stop_for_silence() { motors::stop_for_silence(); }

void measure() { motors::read_positions(); }

bool take_arrived(uint8_t drive) { return motors::take_stopped(drive); }

uint16_t flags(uint8_t drive) { return motors::flags(drive); }

int32_t position(uint8_t drive) { return motors::position(drive); }

int32_t target(uint8_t drive) { return motors::target(drive); }

}  // namespace drives
}  // namespace soft_robot_lab
