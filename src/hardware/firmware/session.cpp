// SPDX-License-Identifier: BSD-3-Clause
#include "session.h"

#include "chain.h"
#include "motors.h"
#include "serial.h"

namespace soft_robot_lab {
namespace session {
namespace {

constexpr uint8_t firmware_version = 1;
constexpr uint16_t state_period_ms = 20;

uint8_t session = wire::no_session;
uint8_t last_number = 0;  // of the last request that was answered
wire::Result last_result = wire::result_done;
uint16_t now = 0;  // [ms]
uint16_t heard_at = 0;
uint16_t states_due = 0;
uint8_t next_state = wire::max_motors;  // of the round of states that is being sent
bool silent = true;

uint8_t board_configuration[wire::board::length] = {};

uint16_t watchdog_ms() { return wire::get_u16(board_configuration + wire::board::watchdog_ms); }

uint16_t configuration_crc() {
  uint16_t crc = wire::crc16(board_configuration, wire::board::length);
  for (uint8_t i = 0; i < board_configuration[wire::board::motor_count]; ++i) {
    crc = wire::crc16(motors::configuration(i), wire::motor::length, crc);
  }
  return crc;
}

// False where the line is too busy to take it now.
bool send(const wire::Frame& frame) {
  if (serial::room() < wire::max_encoded) return false;
  uint8_t bytes[wire::max_encoded];
  serial::write(bytes, wire::encode(frame, bytes));
  return true;
}

wire::Frame make_frame(wire::Kind kind, uint8_t number, uint8_t length) {
  wire::Frame frame;
  frame.kind = kind;
  frame.session = session;
  frame.number = number;
  frame.length = length;
  return frame;
}

void welcome() {
  wire::Frame frame = make_frame(wire::kind_welcome, last_number, wire::welcome::length);
  frame.payload[wire::welcome::version] = wire::protocol_version;
  frame.payload[wire::welcome::firmware_version] = firmware_version;
  frame.payload[wire::welcome::motor_count] = chain::count();
  wire::put_u16(frame.payload + wire::welcome::configuration_crc, configuration_crc());
  send(frame);
}

void acknowledge(const wire::Frame& request, wire::Result result) {
  wire::Frame frame = make_frame(wire::kind_acknowledge, request.number, wire::acknowledge::length);
  frame.payload[wire::acknowledge::result] = result;
  for (uint8_t i = 0; i < chain::count(); ++i) {
    const uint16_t flags = motors::flags(i);
    const uint8_t bit = 1 << i;
    if ((flags & wire::flag_moving) != 0) frame.payload[wire::acknowledge::moving_mask] |= bit;
    if ((flags & wire::fault_flags) != 0) frame.payload[wire::acknowledge::fault_mask] |= bit;
    if ((flags & wire::flag_known) != 0) frame.payload[wire::acknowledge::known_mask] |= bit;
  }
  send(frame);
}

bool send_state(uint8_t motor) {
  wire::Frame frame = make_frame(wire::kind_state, last_number, wire::state::length);
  frame.payload[wire::state::motor] = motor;
  wire::put_i24(frame.payload + wire::state::position, motors::position(motor));
  wire::put_i24(frame.payload + wire::state::target, motors::target(motor));
  wire::put_u16(frame.payload + wire::state::flags, motors::flags(motor));
  return send(frame);
}

wire::Result configure_board(const uint8_t* payload) {
  if (payload[wire::board::motor_count] != chain::count()) return wire::result_no_motor;
  for (uint8_t i = 0; i < chain::count(); ++i) {
    if ((motors::flags(i) & wire::flag_moving) != 0) return wire::result_moving;
  }
  for (uint8_t i = 0; i < wire::board::length; ++i) board_configuration[i] = payload[i];
  return wire::result_done;
}

wire::Result execute(const wire::Frame& frame) {
  const uint8_t mask = frame.payload[0];
  switch (frame.kind) {
    case wire::kind_configure_board:
      return configure_board(frame.payload);
    case wire::kind_configure_motor:
      return motors::configure(frame.payload);
    case wire::kind_go_to:
      return motors::go_to(mask, frame.payload + wire::go_to::positions);
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

// Each number is executed once, and only in its turn; the last one is answered again, as its answer may have been lost.
void handle_request(const wire::Frame& frame) {
  if (frame.session != session || session == wire::no_session) {
    acknowledge(frame, wire::result_wrong_session);
  } else if (frame.number == last_number) {
    acknowledge(frame, last_result);
  } else if (frame.number != static_cast<uint8_t>(last_number + 1)) {
    acknowledge(frame, wire::result_out_of_order);
  } else {
    last_result = execute(frame);
    last_number = frame.number;
    acknowledge(frame, last_result);
  }
}

void watch_host() {
  if (session == wire::no_session || silent) return;
  if (watchdog_ms() == 0 || static_cast<uint16_t>(now - heard_at) <= watchdog_ms()) return;
  silent = true;
  motors::stop_for_silence();
}

void send_states() {
  if (static_cast<int16_t>(now - states_due) >= 0) {
    states_due = now + state_period_ms;
    motors::read_positions();
    next_state = 0;
  }
  if (next_state < chain::count() && send_state(next_state)) ++next_state;
}

// The end of a motion is reported at once.
void send_stops() {
  bool read = false;
  for (uint8_t i = 0; i < chain::count(); ++i) {
    if (!motors::take_stopped(i)) continue;
    if (!read) motors::read_positions();
    read = true;
    send_state(i);
  }
}

}  // namespace

void handle(const wire::Frame& frame) {
  if (frame.kind == wire::kind_hello) {
    if (frame.session == wire::no_session) return;
    if (frame.payload[wire::hello::version] == wire::protocol_version) session = frame.session;
    welcome();  // names our version, whichever it is
  }
  if (frame.kind == wire::kind_emergency_stop) {
    motors::emergency_stop();
    acknowledge(frame, wire::result_done);
  } else if (frame.kind >= wire::kind_configure_board && frame.kind <= wire::kind_clear) {
    handle_request(frame);
  }
  if (frame.session != session) return;
  heard_at = now;
  silent = false;
}

void tick(uint16_t now_ms) {
  now = now_ms;
  watch_host();
  if (now % motors::poll_period_ms == 0) motors::poll();
  if (session == wire::no_session) return;
  send_stops();
  send_states();
}

}  // namespace session
}  // namespace soft_robot_lab
