// SPDX-License-Identifier: BSD-3-Clause
// The rig without the rig: the compiled firmware on an emulated ATmega328P (simavr), L6470s with motors on its SPI bus
// or valves, regulators and sensors of air on its pins, and a serial line. Time passes only in run().
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "air_channel.h"
#include "noisy_line.h"
#include "stepper_chip.h"

namespace soft_robot_lab {

class EmulatedRig {
 public:
  EmulatedRig(int motor_count, std::uint64_t seed);  // 1 to 6 motors; throws std::invalid_argument
  EmulatedRig(const std::vector<ChannelSettings>& channels, std::uint64_t seed);  // of air
  ~EmulatedRig();

  double time_s() const;
  void send(const std::vector<std::uint8_t>& bytes);  // from the host
  // Until a whole frame has reached the host, or this time.
  std::vector<std::uint8_t> run(double until_s);

  void set_noise(const LineNoise& noise);
  void unplug();  // bytes under way are lost; the board runs on
  void replug() { plugged_ = true; }
  bool plugged() const { return plugged_; }
  void reset_board(double boot_s);  // as its button does; the boot loader runs for so long
  void cut_power(double boot_s);    // of board and chips
  int motor_count() const { return static_cast<int>(chips_.size()); }
  StepperChip& chip(int motor) { return chips_[static_cast<std::size_t>(motor)]; }
  int channel_count() const { return static_cast<int>(air_.size()); }
  AirChannel& channel(int index);  // as it is now
  LineCounts line_counts() const;  // of both directions

 private:
  struct Board;
  struct Image;
  EmulatedRig(const Image& firmware, std::uint64_t seed);
  void connect_line();
  void connect_chips();
  void connect_sensors();
  AirPins air_pins(int channel) const;
  void advance_air();
  std::uint8_t exchange(std::uint8_t byte);
  void select(bool low);
  void hear(std::uint8_t byte);  // from the board
  void deliver();                // what is due, to the board
  void schedule_delivery();
  void schedule_hearing();

  std::vector<StepperChip> chips_;
  std::vector<AirChannel> air_;
  double air_time_s_ = 0.0;
  NoisyLine to_board_, to_host_;
  bool plugged_ = true;
  bool selected_ = false;
  std::uint64_t boots_until_ = 0;             // [cycles]
  std::uint64_t host_hears_at_ = UINT64_MAX;  // [cycles], looked at after each instruction
  std::unique_ptr<Board> board_;
};

}  // namespace soft_robot_lab
