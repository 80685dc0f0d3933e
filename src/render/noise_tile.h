// Normally distributed numbers in a square without seams, drawn once and read from another place each time.
#pragma once

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
    float at(int u, int v) const {
      return values_[((static_cast<std::size_t>(v) + down_) & mask) * size +
                     ((static_cast<std::size_t>(u) + right_) & mask)];
    }

   private:
    friend class NoiseTile;
    const float* values_;
    std::size_t right_, down_;
  };
  Window window(std::uint64_t place) const;

 private:
  static constexpr std::size_t size = 1024, mask = size - 1;
  std::vector<float> values_;  // row by row
};

}  // namespace soft_robot_lab
