// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace soft_robot_lab {

// Red, green and blue of Plasma (van der Walt and Smith 2015) without its palest end: even in lightness, also for
// colour-blind readers. What is out of [0, 1] has the colour of the end.
inline std::array<float, 3> plasma(double fraction) {
  constexpr std::array<std::array<float, 3>, 5> stops = {{{0.05f, 0.03f, 0.53f},
                                                          {0.45f, 0.00f, 0.66f},
                                                          {0.74f, 0.22f, 0.53f},
                                                          {0.93f, 0.47f, 0.33f},
                                                          {0.99f, 0.77f, 0.15f}}};
  const float place = static_cast<float>(std::clamp(fraction, 0.0, 1.0)) * 4.0f;
  const auto below = std::min(stops.size() - 2, static_cast<std::size_t>(place));
  const float share = place - static_cast<float>(below);
  const auto mixed = [&](std::size_t k) { return (1.0f - share) * stops[below][k] + share * stops[below + 1][k]; };
  return {mixed(0), mixed(1), mixed(2)};
}

}  // namespace soft_robot_lab
