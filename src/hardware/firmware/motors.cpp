// SPDX-License-Identifier: BSD-3-Clause
#include "motors.h"

#include "chain.h"
#include "hardware/motor/l6470.h"

namespace soft_robot_lab {
namespace motors {
namespace {

// Kept in a chip's MARK register, which survives a reset of this board but no power cut of the chip, while its position
// is known.
constexpr uint32_t known_mark = 0x15a5a5;

struct Motor {
  int32_t position = 0;
  int32_t target = 0;
  int32_t min_position = 0;
  int32_t max_position = 0;
  uint16_t flags = 0;
  bool configured = false;
  bool busy = false;
  bool pending = false;   // the chip has not been sent to the target yet
  bool stopping = false;  // when at rest, the target becomes where it is, unless one is pending
  bool stopped = false;   // reported once
  uint8_t configuration[wire::motor::length] = {};
};

Motor all[wire::max_motors];
uint32_t statuses[wire::max_motors];

bool has(uint8_t mask, uint8_t motor) { return (mask & 1 << motor) != 0; }
bool exists(uint8_t mask) { return mask != 0 && (mask >> chain::count()) == 0; }

void declare_unknown(uint8_t motor) {
  all[motor].flags &= ~wire::flag_known;
  chain::set(1 << motor, l6470::mark, 0);
}

void halt(uint8_t mask, uint8_t command) {
  chain::command(mask, command);
  for (uint8_t i = 0; i < chain::count(); ++i) {
    if (!has(mask, i)) continue;
    all[i].pending = false;
    all[i].stopping = true;
  }
}

// Latches what a chip's status reports. Each of these may have lost steps.
uint16_t faults_in(uint16_t status) {
  if (status == 0 || status == 0xffff) return wire::flag_no_answer;  // undriven line, or a chip without power
  uint16_t faults = 0;
  if ((status & l6470::status_no_overcurrent) == 0) faults |= wire::flag_overcurrent;
  if ((status & l6470::status_no_thermal_shutdown) == 0) faults |= wire::flag_overheated;
  if ((status & l6470::status_no_undervoltage) == 0) faults |= wire::flag_undervoltage;
  if ((status & l6470::status_no_step_loss_a) == 0 || (status & l6470::status_no_step_loss_b) == 0) {
    faults |= wire::flag_stall;
  }
  return faults;
}

void watch(uint8_t i, uint16_t status) {
  Motor& motor = all[i];
  const uint16_t faults = faults_in(status);
  if ((faults & ~motor.flags) != 0) {
    motor.flags |= faults;
    declare_unknown(i);
    halt(1 << i, l6470::hard_stop);
  }
  if ((status & l6470::status_no_thermal_warning) == 0) {
    motor.flags |= wire::flag_thermal_warning;
  } else {
    motor.flags &= ~wire::flag_thermal_warning;
  }
  const bool was_busy = motor.busy;
  motor.busy = (faults & wire::flag_no_answer) == 0 && (status & l6470::status_not_busy) == 0;
  if (was_busy && !motor.busy && !motor.pending) motor.stopped = true;
}

// Positions count microsteps: another step mode makes another number of the same place. It can only be set with the
// bridges off, so that is done for a new one only: a loaded shaft might turn.
void set_step_mode(uint8_t i, uint8_t wanted) {
  uint32_t modes[wire::max_motors];
  chain::get(l6470::step_mode, modes);
  if ((modes[i] & 7) == wanted) return;
  declare_unknown(i);
  chain::command(1 << i, l6470::hard_hi_z);
  chain::set(1 << i, l6470::step_mode, wanted);
}

void write_registers(uint8_t i) {
  const uint8_t* bytes = all[i].configuration;
  const uint8_t mask = 1 << i;
  set_step_mode(i, bytes[wire::motor::step_mode]);
  chain::set(mask, l6470::acc, wire::get_u16(bytes + wire::motor::acceleration));
  chain::set(mask, l6470::dec, wire::get_u16(bytes + wire::motor::deceleration));
  chain::set(mask, l6470::max_speed, wire::get_u16(bytes + wire::motor::max_speed));
  chain::set(mask, l6470::kval_hold, bytes[wire::motor::kval_hold]);
  chain::set(mask, l6470::kval_run, bytes[wire::motor::kval_run]);
  chain::set(mask, l6470::kval_acc, bytes[wire::motor::kval_acceleration]);
  chain::set(mask, l6470::kval_dec, bytes[wire::motor::kval_deceleration]);
  chain::set(mask, l6470::ocd_th, bytes[wire::motor::overcurrent_threshold]);
  chain::set(mask, l6470::stall_th, bytes[wire::motor::stall_threshold]);
  chain::command(mask, l6470::hard_stop);  // holds again
}

bool moves(const Motor& motor) { return motor.busy || motor.pending || motor.stopping; }

}  // namespace

void start() {
  const uint8_t mask = static_cast<uint8_t>((1 << chain::count()) - 1);
  halt(mask, l6470::soft_stop);
  uint32_t marks[wire::max_motors];
  chain::get(l6470::mark, marks);
  for (uint8_t i = 0; i < chain::count(); ++i) {
    if (marks[i] == known_mark) {
      all[i].flags = wire::flag_known;
    } else {
      all[i].flags = wire::flag_power_up;
      chain::clear_status(1 << i);  // getting power is no fault
    }
  }
}

void poll() {
  chain::get(l6470::status, statuses);
  uint8_t starting = 0;
  bool resting = false;
  for (uint8_t i = 0; i < chain::count(); ++i) {
    watch(i, static_cast<uint16_t>(statuses[i]));
    if (all[i].busy) continue;
    if (all[i].stopping && !all[i].pending) resting = true;
    if (all[i].pending) starting |= 1 << i;
  }
  if (resting) read_positions();
  int32_t targets[wire::max_motors] = {};
  for (uint8_t i = 0; i < chain::count(); ++i) {
    Motor& motor = all[i];
    if (motor.busy) continue;
    if (motor.stopping && !motor.pending) {
      motor.target = motor.position;
      motor.stopped = true;
    }
    motor.stopping = motor.pending = false;
    targets[i] = motor.target;
  }
  if (starting == 0) return;
  chain::go_to(starting, targets);
  for (uint8_t i = 0; i < chain::count(); ++i) {
    if (has(starting, i)) all[i].busy = true;
  }
}

wire::Result configure(const uint8_t* payload) {
  const uint8_t index = payload[wire::motor::index];
  if (index >= chain::count()) return wire::result_no_motor;
  if (payload[wire::motor::step_mode] > 7) return wire::result_bad_value;
  Motor& motor = all[index];
  if (moves(motor)) return wire::result_moving;
  for (uint8_t i = 0; i < wire::motor::length; ++i) motor.configuration[i] = payload[i];
  motor.min_position = wire::get_i24(payload + wire::motor::min_position);
  motor.max_position = wire::get_i24(payload + wire::motor::max_position);
  write_registers(index);
  motor.configured = true;
  return wire::result_done;
}

wire::Result go_to(uint8_t mask, const uint8_t* positions) {
  if (!exists(mask)) return wire::result_no_motor;
  int32_t targets[wire::max_motors];
  for (uint8_t i = 0; i < chain::count(); ++i) {
    if (!has(mask, i)) continue;
    const Motor& motor = all[i];
    targets[i] = wire::get_i24(positions);
    positions += wire::go_to::position_size;
    if ((motor.flags & wire::flag_emergency_stop) != 0) return wire::result_emergency_stop;
    if ((motor.flags & wire::fault_flags) != 0) return wire::result_fault;
    if (!motor.configured) return wire::result_not_configured;
    if ((motor.flags & wire::flag_known) == 0) return wire::result_position_unknown;
    if (targets[i] < motor.min_position || targets[i] > motor.max_position) return wire::result_beyond_limit;
  }
  uint8_t turning = 0;
  for (uint8_t i = 0; i < chain::count(); ++i) {
    if (!has(mask, i)) continue;
    Motor& motor = all[i];
    motor.flags &= ~wire::flag_host_silent;
    if (motor.target == targets[i] && !motor.stopping) continue;
    // An L6470 takes no new position while it moves: it brakes first, which never overshoots the old one.
    if (motor.busy && !motor.stopping) turning |= 1 << i;
    motor.target = targets[i];
    motor.pending = true;
    motor.stopped = false;
  }
  if (turning != 0) chain::command(turning, l6470::soft_stop);
  return wire::result_done;
}

wire::Result zero(uint8_t mask) {
  if (!exists(mask)) return wire::result_no_motor;
  for (uint8_t i = 0; i < chain::count(); ++i) {
    if (!has(mask, i)) continue;
    if ((all[i].flags & wire::fault_flags) != 0) return wire::result_fault;
    if (!all[i].configured) return wire::result_not_configured;
    if (moves(all[i])) return wire::result_moving;
  }
  chain::command(mask, l6470::reset_position);
  chain::set(mask, l6470::mark, known_mark);
  for (uint8_t i = 0; i < chain::count(); ++i) {
    if (!has(mask, i)) continue;
    all[i].position = all[i].target = 0;
    all[i].flags = (all[i].flags | wire::flag_known) & ~wire::flag_power_up;
  }
  return wire::result_done;
}

wire::Result soft_stop(uint8_t mask) {
  if (!exists(mask)) return wire::result_no_motor;
  halt(mask, l6470::soft_stop);
  return wire::result_done;
}

wire::Result clear(uint8_t mask) {
  if (!exists(mask)) return wire::result_no_motor;
  chain::clear_status(mask);
  for (uint8_t i = 0; i < chain::count(); ++i) {
    if (!has(mask, i)) continue;
    const bool had_fault = (all[i].flags & wire::fault_flags) != 0;
    all[i].flags &= ~(wire::fault_flags | wire::flag_emergency_stop);
    if (had_fault && all[i].configured) write_registers(i);  // the chip may have lost them with its power
  }
  return wire::result_done;
}

void emergency_stop() {
  halt(0xff, l6470::hard_stop);
  for (Motor& motor : all) motor.flags |= wire::flag_emergency_stop;
}

void stop_for_silence() {
  halt(0xff, l6470::soft_stop);
  for (Motor& motor : all) motor.flags |= wire::flag_host_silent;
}

void read_positions() {
  int32_t positions[wire::max_motors];
  chain::get_positions(positions);
  for (uint8_t i = 0; i < chain::count(); ++i) all[i].position = positions[i];
}

bool take_stopped(uint8_t motor) {
  const bool stopped = all[motor].stopped;
  all[motor].stopped = false;
  return stopped;
}

uint16_t flags(uint8_t motor) { return moves(all[motor]) ? all[motor].flags | wire::flag_moving : all[motor].flags; }

int32_t position(uint8_t motor) { return all[motor].position; }

int32_t target(uint8_t motor) { return all[motor].target; }

const uint8_t* configuration(uint8_t motor) { return all[motor].configuration; }

}  // namespace motors
}  // namespace soft_robot_lab
