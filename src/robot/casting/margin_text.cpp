// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <sstream>

#include "check_casting.h"

namespace soft_robot_lab {
namespace {

struct Bound {
  const char *test, *what, *value, *limit;
  bool at_least;
  double scale;
  const char* unit;
};

constexpr Bound kBounds[] = {{"extraction", "draft ", "draft_deg", "min_draft_deg", true, 1, " deg"},
                             {"extraction", "held skin ", "blocked_area_m2", nullptr, false, 1e6, " mm^2"},
                             {"cavities", "", "count", nullptr, false, 1, ""},
                             {"thickness", "", "worst_m", "limit_m", true, 1e3, " mm"},
                             {"angles", "", "worst_deg", "limit_deg", true, 1, " deg"},
                             {"cables", "bends of ", "worst_radius_m", "min_radius_m", true, 1e3, " mm"},
                             {"cables", "bends in use of ", "moved_radius_m", nullptr, true, 1e3, " mm"},
                             {"cables", "walls of ", "worst_wall_m", "min_wall_m", true, 1e3, " mm"},
                             {"ligaments", "", "worst_m", "limit_m", true, 1e3, " mm"},
                             {"shelves", "apart by ", "worst_m", "limit_m", true, 1e3, " mm"},
                             {"shelves", "at ", "steepest_deg", "limit_deg", true, 1, " deg"},
                             {"stretch", "", "worst", "limit", false, 1, ""},
                             {"suction", "", "force_n", nullptr, false, 1, " N"},
                             {"suction", "without air holes ", "force_without_air_holes_n", nullptr, false, 1, " N"},
                             {"suction", "a strain of ", "strain", "limit_strain", false, 1, ""},
                             {"aspect", "", "worst", "limit", false, 1, ""},
                             {"aspect", "of a core ", "height_m", nullptr, false, 1e3, " mm high"},
                             {"aspect", "", "width_m", nullptr, false, 1e3, " mm wide"},
                             {"aspect", "holes through the robot ", "through_holes", nullptr, false, 1, ""},
                             {"mould_walls", "", "worst_m", "limit_m", true, 1e3, " mm"},
                             {"mesh_quality", "Q_vl ", "worst", "limit", true, 1, ""}};

double number_of(const CastingTest& test, const std::string& key) {
  const auto found =
      std::find_if(test.numbers.begin(), test.numbers.end(), [&](const auto& number) { return number.first == key; });
  return found == test.numbers.end() ? INFINITY : found->second;
}

}  // namespace

std::string margin_text(const CastingTest& test) {
  std::ostringstream text;
  text.precision(4);
  for (const Bound& bound : kBounds) {
    const double value = number_of(test, bound.value);
    if (test.name != bound.test || !std::isfinite(value)) continue;
    text << (text.tellp() > 0 ? "; " : "") << bound.what << bound.scale * value << bound.unit;
    if (bound.limit)
      text << (bound.at_least ? ", at least " : ", at most ") << bound.scale * number_of(test, bound.limit)
           << bound.unit;
  }
  return text.str();
}

}  // namespace soft_robot_lab
