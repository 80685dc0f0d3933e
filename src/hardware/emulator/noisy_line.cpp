// SPDX-License-Identifier: BSD-3-Clause
#include "noisy_line.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace soft_robot_lab {
namespace {

constexpr double byte_s = 10.0 / 115200.0;

void require_chance(const char* name, double value) {
  if (!(value >= 0.0 && value <= 1.0)) {
    throw std::invalid_argument(std::string(name) + ": " + std::to_string(value) + " is not in [0, 1]");
  }
}

}  // namespace

void LineNoise::validate() const {
  require_chance("corrupted", corrupted);
  require_chance("lost", lost);
  require_chance("doubled", doubled);
  require_chance("delayed", delayed);
  if (!(delay_s >= 0.0 && delay_s <= 10.0)) {
    throw std::invalid_argument("delay_s: " + std::to_string(delay_s) + " is not in [0, 10]");
  }
}

// The same numbers on every platform, unlike those of std::bernoulli_distribution.
bool NoisyLine::chance(double probability) { return static_cast<double>(random_() >> 11) * 0x1p-53 < probability; }

void NoisyLine::push(std::uint8_t byte, double now_s) {
  ++counts_.passed;
  double delay_s = 0.0;
  if (chance(noise_.delayed)) {
    ++counts_.delayed;
    delay_s = noise_.delay_s;
  }
  if (chance(noise_.lost)) {
    ++counts_.lost;
    return;
  }
  if (chance(noise_.corrupted)) {
    ++counts_.corrupted;
    byte = static_cast<std::uint8_t>(byte ^ (1 + random_() % 255));
  }
  add(byte, now_s, delay_s);
  if (chance(noise_.doubled)) {
    ++counts_.doubled;
    add(byte, now_s, 0.0);
  }
}

void NoisyLine::add(std::uint8_t byte, double now_s, double delay_s) {
  last_arrival_s_ = std::max(now_s, last_arrival_s_) + byte_s + delay_s;
  bytes_.push_back({last_arrival_s_, byte});
}

std::optional<double> NoisyLine::next_arrival_s() const {
  if (bytes_.empty()) return std::nullopt;
  return bytes_.front().arrival_s;
}

std::uint8_t NoisyLine::pop() {
  const std::uint8_t byte = bytes_.front().value;
  bytes_.pop_front();
  return byte;
}

}  // namespace soft_robot_lab
