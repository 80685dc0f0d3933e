// SPDX-License-Identifier: BSD-3-Clause
#include "noisy_line.h"

#include <algorithm>

#include "settings/require_in_range.h"

namespace soft_robot_lab {
namespace {

constexpr double byte_s = 10.0 / 115200.0;

}  // namespace

void LineNoise::validate() const {
  const AllowedRange chance{0.0, 1.0};
  require_in_range("corrupted", corrupted, chance);
  require_in_range("lost", lost, chance);
  require_in_range("doubled", doubled, chance);
  require_in_range("delayed", delayed, chance);
  require_in_range("delay_s", delay_s, {0.0, 10.0});
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
