// SPDX-License-Identifier: BSD-3-Clause
#include "unit_limits.h"

#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "limits.h"
#include "words.h"

namespace soft_robot_lab {
namespace {

using Words = std::string_view;

constexpr std::array<std::pair<Words, double>, 11> kLargest{{{"m", limits::kPlace_m},
                                                             {"s", limits::kTime_s},
                                                             {"m_s", limits::kSpeed_m_s},
                                                             {"m_s2", limits::kAcceleration_m_s2},
                                                             {"rad", limits::kAngle_rad},
                                                             {"deg", limits::kAngle_deg},
                                                             {"rad_s", limits::kAngularSpeed_rad_s},
                                                             {"kg", limits::kMass_kg},
                                                             {"kg_m3", limits::kDensity_kg_m3},
                                                             {"n", limits::kForce_n},
                                                             {"pa", limits::kPressure_pa}}};

bool is_unit(Words word) {
  constexpr std::array<Words, 24> units{"m",  "s",  "kg",  "pa", "n",  "rad", "deg", "hz",  "px", "ml",  "v",  "a",
                                        "m2", "m3", "mm2", "s2", "mm", "us",  "ms",  "per", "nm", "kpa", "mb", "gb"};
  for (const Words unit : units)
    if (word == unit) return true;
  return false;
}

// "a.points_m[3][0]" has the key "points_m".
Words last_key(Words path) {
  while (!path.empty() && path.back() == ']') path = path.substr(0, path.rfind('['));
  return path.substr(path.rfind('.') + 1);
}

// The words at the end that are units; the first word is a name.
Words unit_of(Words key) {
  std::size_t start = key.size();
  for (std::size_t end = key.size(); end > 0;) {
    const std::size_t line = key.rfind('_', end - 1);
    if (line == Words::npos || !is_unit(key.substr(line + 1, end - line - 1))) break;
    start = line + 1;
    end = line;
  }
  return key.substr(start);
}

}  // namespace

AllowedRange range_of_unit(const std::string& path) {
  const Words unit = unit_of(last_key(path));
  for (const auto& [name, largest] : kLargest)
    if (name == unit) return {-largest, largest};
  return AllowedRange::any();
}

void require_in_unit(const std::string& name, double value) {
  AllowedRange range = range_of_unit(name);
  if (std::isinf(range.max)) range = {-limits::kNumber, limits::kNumber};
  if (!range.contains(value))
    throw std::invalid_argument(name + ": " + format_number(value) + " is not in " + range.to_string());
}

void require_in_unit(const std::string& name, const Eigen::Ref<const Eigen::VectorXd>& values) {
  for (const double value : values) require_in_unit(name, value);
}

}  // namespace soft_robot_lab
