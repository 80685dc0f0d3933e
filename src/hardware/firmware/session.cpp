// SPDX-License-Identifier: BSD-3-Clause
#include "session.h"

#include "drives.h"
#include "serial.h"

namespace soft_robot_lab {
namespace session {
namespace {

constexpr uint16_t state_period_ms = 20;

uint8_t session = wire::no_session;
uint8_t last_number = 0;  // of the last request that was answered
wire::Result last_result = wire::result_done;
uint16_t now = 0;  // [ms]
uint16_t heard_at = 0;
uint16_t states_due = 0;
uint8_t next_state = 0xff;  // of the round of states that is being sent
bool silent = true;

uint8_t board_configuration[wire::board::length] = {};

uint16_t watchdog_ms() { return wire::get_u16(board_configuration + wire::board::watchdog_ms); }

uint16_t configuration_crc() {
  uint16_t crc = wire::crc16(board_configuration, wire::board::length);
  for (uint8_t i = 0; i < board_configuration[wire::board::drive_count]; ++i) crc = drives::configuration_crc(i, crc);
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
  frame.payload[wire::welcome::firmware] = drives::firmware();
  frame.payload[wire::welcome::drive_count] = drives::capacity();
  wire::put_u16(frame.payload + wire::welcome::configuration_crc, configuration_crc());
  send(frame);
}

void acknowledge(const wire::Frame& request, wire::Result result) {
  wire::Frame frame = make_frame(wire::kind_acknowledge, request.number, wire::acknowledge::length);
  frame.payload[wire::acknowledge::result] = result;
  for (uint8_t i = 0; i < drives::count(); ++i) {
    const uint16_t flags = drives::flags(i);
    const uint8_t bit = 1 << i;
    if ((flags & wire::flag_moving) != 0) frame.payload[wire::acknowledge::moving_mask] |= bit;
    if ((flags & wire::fault_flags) != 0) frame.payload[wire::acknowledge::fault_mask] |= bit;
    if ((flags & wire::flag_known) != 0) frame.payload[wire::acknowledge::known_mask] |= bit;
  }
  send(frame);
}

bool send_state(uint8_t drive) {
  wire::Frame frame = make_frame(wire::kind_state, last_number, wire::state::length);
  frame.payload[wire::state::drive] = drive;
  wire::put_i24(frame.payload + wire::state::position, drives::position(drive));
  wire::put_i24(frame.payload + wire::state::target, drives::target(drive));
  wire::put_u16(frame.payload + wire::state::flags, drives::flags(drive));
  return send(frame);
}

wire::Result execute(const wire::Frame& frame) {
  if (frame.kind != wire::kind_configure_board) return drives::execute(frame);
  const wire::Result result = drives::configure_board(frame.payload[wire::board::drive_count]);
  if (result != wire::result_done) return result;
  for (uint8_t i = 0; i < wire::board::length; ++i) board_configuration[i] = frame.payload[i];
  return wire::result_done;
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
  drives::stop_for_silence();
}

void send_states() {
  if (static_cast<int16_t>(now - states_due) >= 0) {
    states_due = now + state_period_ms;
    drives::measure();
    next_state = 0;
  }
  if (next_state < drives::count() && send_state(next_state)) ++next_state;
}

// The end of a motion is reported at once.
void send_stops() {
  bool read = false;
  for (uint8_t i = 0; i < drives::count(); ++i) {
    if (!drives::take_arrived(i)) continue;
    if (!read) drives::measure();
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
    drives::emergency_stop();
    acknowledge(frame, wire::result_done);
  } else if (wire::is_numbered(frame.kind)) {
    handle_request(frame);
  }
  if (frame.session != session) return;
  heard_at = now;
  silent = false;
}

void tick(uint16_t now_ms) {
  now = now_ms;
  watch_host();
  drives::tick(now);
  if (session == wire::no_session) return;
  send_stops();
  send_states();
}

}  // namespace session
}  // namespace soft_robot_lab
