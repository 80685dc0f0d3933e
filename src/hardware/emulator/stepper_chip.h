// SPDX-License-Identifier: BSD-3-Clause
// One L6470 with its motor: commands and registers as on SPI, and where the shaft really is.
#pragma once

#include <array>
#include <cstdint>

#include "motion.h"
#include "hardware/motor/l6470.h"

namespace soft_robot_lab {

class StepperChip {
 public:
  StepperChip() { power_up(0.0); }

  // What SPI does to it: bytes go through the shift register; the chip acts on what is there when select rises.
  std::uint8_t shift(std::uint8_t in);
  void act(double now_s);

  // What the world does to it.
  void power_up(double now_s);  // its registers and position are lost, the shaft stays
  void set_stalled(bool stalled, double now_s);
  void set_overcurrent(bool on, double now_s);
  void set_overheated(bool on, double now_s);
  void set_undervoltage(bool on, double now_s);
  void slip(double steps) { shaft_microsteps_ += steps * microsteps(); }  // unseen by the chip
  void set_backlash(double steps) { backlash_steps_ = steps; }

  // The truth, in full steps since the position was last set to zero.
  double shaft_steps(double now_s);
  double spool_steps(double now_s);  // behind the backlash
  bool moving(double now_s) const { return !motion_.done(now_s); }

 private:
  struct Conditions {  // that hold now, beside those latched in status_
    bool stalled = false;
    bool overcurrent = false;
    bool overheated = false;
    bool undervoltage = false;
  };

  struct Spi {
    std::uint8_t shifted = 0;  // what is in the shift register
    std::uint8_t command = l6470::nop;
    std::uint8_t arguments_due = 0;
    std::uint32_t argument = 0;
    std::uint32_t answer = 0;
    std::uint8_t answer_bytes = 0;  // not sent yet
  };

  double microsteps() const { return 1 << (registers_[l6470::step_mode] & 7); }
  void update(double now_s);
  void apply_conditions(double now_s);
  void halt(double now_s);
  void begin(std::uint8_t byte, double now_s);
  void finish(double now_s);
  void go_to(double now_s);
  void write(std::uint8_t address, std::uint32_t value, double now_s);
  bool may_write(std::uint8_t address, double now_s) const;
  std::uint32_t read(std::uint8_t address, double now_s);
  std::uint16_t status(double now_s) const;
  void answer(std::uint32_t value, std::uint8_t bytes);

  std::array<std::uint32_t, l6470::register_count> registers_{};
  std::uint16_t alarms_ = 0;  // status bits that read low until GetStatus, and high ones of refused commands
  bool bridges_off_ = true;
  bool forward_ = true;
  Motion motion_;
  Conditions conditions_;

  std::int64_t counted_microsteps_ = 0;  // as the chip counts since power-up
  double shaft_microsteps_ = 0.0;        // since the position was set to zero
  double stalled_microsteps_ = 0.0;
  double backlash_steps_ = 0.0;
  double spool_microsteps_ = 0.0;

  Spi spi_;
};

}  // namespace soft_robot_lab
