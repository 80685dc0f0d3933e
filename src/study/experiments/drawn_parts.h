// SPDX-License-Identifier: BSD-3-Clause
// What drawn scenes are put together from.
#pragma once

#include <cstdint>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab::drawn {

// Of std::mt19937_64, whose numbers the standard fixes; its distributions are left to each library.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  bool chance(double share) { return between(0.0, 1.0) < share; }
  template <class T>
  T one_of(const std::vector<T>& all) {
    return all[static_cast<std::size_t>(between(0.0, static_cast<double>(all.size())))];
  }

 private:
  std::mt19937_64 random_;
};

// All over the unit sphere alike.
Eigen::Vector3d direction(Dice& dice);

// In YAML.
std::ostream& operator<<(std::ostream& out, const Eigen::Vector3d& v);

// A key of an obstacle or hold, that goes evenly from where it stands.
std::string motion(double motion_s, const Eigen::Vector3d& way_m, const Eigen::Vector3d& turn_rad);

// A key of an obstacle: "ball", "box", "post" or "rod"; these two lie along `across_m`, and as far to the other side.
std::string shape(const std::string& kind, const Eigen::Vector3d& at_m, double radius_m,
                  const Eigen::Vector3d& across_m = {0.0, 0.1, 0.0});

}  // namespace soft_robot_lab::drawn
