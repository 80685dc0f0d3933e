// SPDX-License-Identifier: BSD-3-Clause
// The L6470 (dSPIN) stepper driver's commands, registers and status bits; numbers from ST's data sheet. Freestanding.
#pragma once

#include <stdint.h>

namespace soft_robot_lab {
namespace l6470 {

enum Command : uint8_t {
  nop = 0x00,
  set_param = 0x00,  // | register
  get_param = 0x20,  // | register
  go_to = 0x60,      // then 22 bits of position
  reset_position = 0xd8,
  reset_device = 0xc0,
  soft_stop = 0xb0,
  hard_stop = 0xb8,
  soft_hi_z = 0xa0,
  hard_hi_z = 0xa8,
  get_status = 0xd0,  // answers two bytes and clears the latched flags
};

enum Register : uint8_t {
  abs_pos = 0x01,
  el_pos = 0x02,
  mark = 0x03,
  speed = 0x04,
  acc = 0x05,
  dec = 0x06,
  max_speed = 0x07,
  min_speed = 0x08,
  kval_hold = 0x09,
  kval_run = 0x0a,
  kval_acc = 0x0b,
  kval_dec = 0x0c,
  int_speed = 0x0d,
  st_slp = 0x0e,
  fn_slp_acc = 0x0f,
  fn_slp_dec = 0x10,
  k_therm = 0x11,
  adc_out = 0x12,
  ocd_th = 0x13,
  stall_th = 0x14,
  fs_spd = 0x15,
  step_mode = 0x16,
  alarm_en = 0x17,
  config = 0x18,
  status = 0x19,
  register_count = 0x1a,
};

// Status bits; those marked low are 0 when the thing is so.
enum Status : uint16_t {
  status_hi_z = 1 << 0,
  status_not_busy = 1 << 1,  // low: busy
  status_switch_closed = 1 << 2,
  status_switch_event = 1 << 3,
  status_forward = 1 << 4,
  status_motion = 3 << 5,
  status_not_performed = 1 << 7,
  status_wrong_command = 1 << 8,
  status_no_undervoltage = 1 << 9,       // low, latched
  status_no_thermal_warning = 1 << 10,   // low, latched
  status_no_thermal_shutdown = 1 << 11,  // low, latched
  status_no_overcurrent = 1 << 12,       // low, latched
  status_no_step_loss_a = 1 << 13,       // low, latched
  status_no_step_loss_b = 1 << 14,       // low, latched
  status_step_clock = 1U << 15,
};

constexpr uint8_t register_bits[register_count] = {0,  22, 9, 22, 20, 12, 12, 10, 13, 8, 8, 8,  8,
                                                   14, 8,  8, 8,  4,  5,  4,  7,  10, 8, 8, 16, 16};

constexpr uint8_t register_bytes(uint8_t address) { return static_cast<uint8_t>((register_bits[address] + 7) / 8); }

// Units: one tick is 250 ns; MAX_SPEED counts 2^-18 steps/tick, ACC and DEC 2^-40 steps/tick^2, all in full steps.
constexpr double max_speed_unit_steps_s = 1.0 / (262144.0 * 250e-9);
constexpr double acceleration_unit_steps_s2 = 1.0 / (1099511627776.0 * 250e-9 * 250e-9);

}  // namespace l6470
}  // namespace soft_robot_lab
