// SPDX-License-Identifier: BSD-3-Clause
#include "stepper_chip.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace soft_robot_lab {
namespace {

constexpr std::uint16_t bridge_alarms =
    l6470::status_no_overcurrent | l6470::status_no_thermal_shutdown | l6470::status_no_undervoltage;
constexpr std::uint16_t step_loss = l6470::status_no_step_loss_a | l6470::status_no_step_loss_b;
constexpr std::uint16_t low_alarms = bridge_alarms | step_loss | l6470::status_no_thermal_warning;
constexpr double steps_until_stall_is_seen = 4.0;

// A number of so many bits, the highest being its sign.
std::int32_t with_sign(std::uint32_t value, int bits) {
  const std::uint32_t sign = 1U << (bits - 1);
  return static_cast<std::int32_t>((value & (2 * sign - 1)) ^ sign) - static_cast<std::int32_t>(sign);
}

}  // namespace

std::uint8_t StepperChip::shift(std::uint8_t in) {
  const std::uint8_t out = spi_.shifted;
  spi_.shifted = in;
  return out;
}

void StepperChip::act(double now_s) {
  update(now_s);
  const std::uint8_t byte = spi_.shifted;
  spi_.shifted = 0;
  if (spi_.arguments_due > 0) {
    spi_.argument = spi_.argument << 8 | byte;
    if (--spi_.arguments_due == 0) finish(now_s);
  } else {
    begin(byte, now_s);
  }
  if (spi_.answer_bytes > 0) spi_.shifted = static_cast<std::uint8_t>(spi_.answer >> 8 * --spi_.answer_bytes);
}

void StepperChip::begin(std::uint8_t byte, double now_s) {
  spi_.command = byte;
  spi_.argument = 0;
  const std::uint8_t address = byte & 0x1f;
  const bool has_register = address != 0 && address < l6470::register_count;
  if (byte == l6470::nop) return;
  if ((byte & 0xe0) == l6470::set_param && has_register) {
    spi_.arguments_due = l6470::register_bytes(address);
  } else if ((byte & 0xe0) == l6470::get_param && has_register) {
    answer(read(address, now_s), l6470::register_bytes(address));
  } else if (byte == l6470::go_to) {
    spi_.arguments_due = 3;
  } else if (byte == l6470::reset_position) {
    write(l6470::abs_pos, 0, now_s);
  } else if (byte == l6470::reset_device) {
    power_up(now_s);
  } else if (byte == l6470::soft_stop || byte == l6470::soft_hi_z) {
    bridges_off_ = (alarms_ & bridge_alarms) != 0;
    motion_ = motion_.braked(now_s, registers_[l6470::dec] * l6470::acceleration_unit_steps_s2 * microsteps());
  } else if (byte == l6470::hard_stop || byte == l6470::hard_hi_z) {
    halt(now_s);
    bridges_off_ = byte == l6470::hard_hi_z || (alarms_ & bridge_alarms) != 0;
  } else if (byte == l6470::get_status) {
    answer(status(now_s), 2);
    alarms_ = 0;
    stalled_microsteps_ = 0.0;
    apply_conditions(now_s);
  } else {
    alarms_ |= l6470::status_wrong_command;  // one this model does not know
  }
}

void StepperChip::finish(double now_s) {
  if (spi_.command == l6470::go_to) {
    go_to(now_s);
  } else {
    write(spi_.command & 0x1f, spi_.argument, now_s);
  }
}

void StepperChip::go_to(double now_s) {
  if (moving(now_s) || (alarms_ & bridge_alarms) != 0) {
    alarms_ |= l6470::status_not_performed;
    return;
  }
  const double unit = microsteps();
  const std::int64_t target = with_sign(spi_.argument, 22);
  forward_ = target >= counted_microsteps_;
  bridges_off_ = false;
  motion_ = Motion::between(now_s, static_cast<double>(counted_microsteps_), static_cast<double>(target),
                            std::max(1U, registers_[l6470::max_speed]) * l6470::max_speed_unit_steps_s * unit,
                            std::max(1U, registers_[l6470::acc]) * l6470::acceleration_unit_steps_s2 * unit,
                            std::max(1U, registers_[l6470::dec]) * l6470::acceleration_unit_steps_s2 * unit);
}

void StepperChip::answer(std::uint32_t value, std::uint8_t bytes) {
  spi_.answer = value;
  spi_.answer_bytes = bytes;
}

// Which registers may be written when, as the data sheet's table says.
bool StepperChip::may_write(std::uint8_t address, double now_s) const {
  switch (address) {
    case l6470::abs_pos:
    case l6470::el_pos:
    case l6470::acc:
    case l6470::dec:
    case l6470::min_speed:
    case l6470::alarm_en:
      return !moving(now_s);
    case l6470::int_speed:
    case l6470::st_slp:
    case l6470::fn_slp_acc:
    case l6470::fn_slp_dec:
    case l6470::step_mode:
    case l6470::config:
      return bridges_off_;
    case l6470::speed:
    case l6470::adc_out:
    case l6470::status:
      return false;
    default:
      return true;
  }
}

void StepperChip::write(std::uint8_t address, std::uint32_t value, double now_s) {
  if (!may_write(address, now_s)) {
    alarms_ |= l6470::status_not_performed;
    return;
  }
  const std::uint32_t bits = value & ((1U << l6470::register_bits[address]) - 1);
  if (address == l6470::abs_pos) {
    counted_microsteps_ = with_sign(bits, 22);
    motion_ = Motion(static_cast<double>(counted_microsteps_));
    if (counted_microsteps_ == 0) {
      spool_microsteps_ -= shaft_microsteps_;
      shaft_microsteps_ = 0.0;
    }
  } else if (address == l6470::step_mode) {
    const double before = microsteps();
    registers_[address] = bits;
    shaft_microsteps_ *= microsteps() / before;
    spool_microsteps_ *= microsteps() / before;
  } else {
    registers_[address] = bits;
  }
}

std::uint32_t StepperChip::read(std::uint8_t address, double now_s) {
  if (address == l6470::abs_pos) return static_cast<std::uint32_t>(counted_microsteps_) & 0x3fffff;
  if (address == l6470::status) return status(now_s);
  if (address == l6470::speed) {
    return static_cast<std::uint32_t>(std::abs(motion_.speed(now_s)) / microsteps() * 67.108864);  // 2^-28 steps/tick
  }
  return registers_[address];
}

std::uint16_t StepperChip::status(double now_s) const {
  std::uint16_t bits = low_alarms & ~alarms_;
  bits |= alarms_ & (l6470::status_wrong_command | l6470::status_not_performed);
  if (bridges_off_) bits |= l6470::status_hi_z;
  if (forward_) bits |= l6470::status_forward;
  if (!moving(now_s)) return bits | l6470::status_not_busy;
  return bits | l6470::status_motion;
}

// Lets the shaft follow what the chip has counted since the last time.
void StepperChip::update(double now_s) {
  const std::int64_t counted = std::llround(motion_.position(now_s));
  const double moved = static_cast<double>(counted - counted_microsteps_);
  counted_microsteps_ = counted;
  if (conditions_.stalled) {
    stalled_microsteps_ += std::abs(moved);
    if (stalled_microsteps_ > steps_until_stall_is_seen * microsteps()) alarms_ |= step_loss;
  } else {
    shaft_microsteps_ += moved;
  }
  // Play: the spool is pulled along at either end of the backlash.
  const double play = backlash_steps_ * microsteps();
  spool_microsteps_ = std::clamp(spool_microsteps_, shaft_microsteps_, shaft_microsteps_ + play);
}

void StepperChip::halt(double now_s) {
  update(now_s);
  motion_ = Motion(static_cast<double>(counted_microsteps_));
}

void StepperChip::apply_conditions(double now_s) {
  if (conditions_.overcurrent) alarms_ |= l6470::status_no_overcurrent;
  if (conditions_.overheated) alarms_ |= l6470::status_no_thermal_shutdown | l6470::status_no_thermal_warning;
  if (conditions_.undervoltage) alarms_ |= l6470::status_no_undervoltage;
  if ((alarms_ & bridge_alarms) == 0) return;
  halt(now_s);
  bridges_off_ = true;
}

void StepperChip::power_up(double now_s) {
  update(now_s);
  const double before = microsteps();
  registers_ = {};
  registers_[l6470::acc] = registers_[l6470::dec] = 0x8a;
  registers_[l6470::max_speed] = 0x41;
  for (const auto kval : {l6470::kval_hold, l6470::kval_run, l6470::kval_acc, l6470::kval_dec}) registers_[kval] = 0x29;
  registers_[l6470::int_speed] = 0x408;
  registers_[l6470::st_slp] = 0x19;
  registers_[l6470::fn_slp_acc] = registers_[l6470::fn_slp_dec] = 0x29;
  registers_[l6470::ocd_th] = 0x8;
  registers_[l6470::stall_th] = 0x40;
  registers_[l6470::fs_spd] = 0x27;
  registers_[l6470::step_mode] = 0x7;
  registers_[l6470::alarm_en] = 0xff;
  registers_[l6470::config] = 0x2e88;
  shaft_microsteps_ *= microsteps() / before;
  spool_microsteps_ *= microsteps() / before;
  counted_microsteps_ = 0;
  motion_ = Motion();
  alarms_ = l6470::status_no_undervoltage;
  bridges_off_ = true;
  spi_.arguments_due = spi_.answer_bytes = spi_.shifted = 0;
}

void StepperChip::set_stalled(bool stalled, double now_s) {
  update(now_s);
  conditions_.stalled = stalled;
  stalled_microsteps_ = 0.0;
}

void StepperChip::set_overcurrent(bool on, double now_s) {
  conditions_.overcurrent = on;
  apply_conditions(now_s);
}

void StepperChip::set_overheated(bool on, double now_s) {
  conditions_.overheated = on;
  apply_conditions(now_s);
}

void StepperChip::set_undervoltage(bool on, double now_s) {
  conditions_.undervoltage = on;
  apply_conditions(now_s);
}

double StepperChip::shaft_steps(double now_s) {
  update(now_s);
  return shaft_microsteps_ / microsteps();
}

double StepperChip::spool_steps(double now_s) {
  update(now_s);
  return spool_microsteps_ / microsteps();
}

}  // namespace soft_robot_lab
