// SPDX-License-Identifier: BSD-3-Clause
// One direction of a serial line at 115200 baud that may damage, lose, double and delay bytes.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <random>

namespace soft_robot_lab {

struct LineNoise {
  double corrupted = 0.0;  // chances of each byte
  double lost = 0.0;
  double doubled = 0.0;
  double delayed = 0.0;
  double delay_s = 0.005;  // of a delayed byte and so of all behind it

  void validate() const;  // throws std::invalid_argument
};

struct LineCounts {
  std::int64_t passed = 0, corrupted = 0, lost = 0, doubled = 0, delayed = 0;
};

class NoisyLine {
 public:
  explicit NoisyLine(std::uint64_t seed) : random_(seed) {}

  void set_noise(const LineNoise& noise) { noise_ = noise; }
  void push(std::uint8_t byte, double now_s);
  std::optional<double> next_arrival_s() const;
  std::uint8_t pop();  // the next to arrive
  void drop_all() { bytes_.clear(); }
  const LineCounts& counts() const { return counts_; }

 private:
  struct Byte {
    double arrival_s;
    std::uint8_t value;
  };
  bool chance(double probability);
  void add(std::uint8_t byte, double now_s, double delay_s);

  LineNoise noise_;
  LineCounts counts_;
  std::mt19937_64 random_;
  std::deque<Byte> bytes_;
  double last_arrival_s_ = 0.0;
};

}  // namespace soft_robot_lab
