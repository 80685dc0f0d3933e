// SPDX-License-Identifier: BSD-3-Clause
// Normally distributed numbers in a square without seams, drawn once and read from another place each time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace soft_robot_lab {

// A different number for every (seed, frame, purpose): SplitMix64.
std::uint64_t scramble(std::uint64_t seed, std::uint64_t frame, std::uint64_t purpose);

class NoiseTile {
 public:
  // Mean 0, deviation 1; white where `correlation_px` is 0, else blurred by a Gaussian of that deviation.
  NoiseTile(std::uint64_t seed, double correlation_px);

  class Window {
   public:
    // `count` numbers of row v from column u on; at most as many as the tile is wide.
    void read(int u, int v, int count, float* to) const {
      const float* row = values_ + ((static_cast<std::size_t>(v) + down_) & mask) * size;
      const std::size_t start = (static_cast<std::size_t>(u) + right_) & mask;
      const std::size_t before_seam = std::min(static_cast<std::size_t>(count), size - start);
      std::copy_n(row + start, before_seam, to);
      std::copy_n(row, static_cast<std::size_t>(count) - before_seam, to + before_seam);
    }

   private:
    friend class NoiseTile;
    const float* values_;
    std::size_t right_, down_;
  };
  Window window(std::uint64_t place) const;

  static constexpr std::size_t size = 1024;

 private:
  static constexpr std::size_t mask = size - 1;
  std::vector<float> values_;  // row by row
};

}  // namespace soft_robot_lab
