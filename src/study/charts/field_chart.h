// SPDX-License-Identifier: BSD-3-Clause
// Against the field: what runs here, ours and Bullet, beside what others published of their own models and machines.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "motion_chart.h"
#include "published_figure.h"
#include "speed_measurement.h"

namespace soft_robot_lab {

// One line of the comparison.
struct FieldPoint {
  std::string group;  // whose, and whether it ran here
  std::string name;
  std::optional<double> unknowns;
  double times_real_time = 0.0;
  std::string error, setting, source;  // error: as stated, or that none is
};

// Of the cantilever at `poissons_ratio` and of the robot in motion, then what is published.
std::vector<FieldPoint> field_points(const std::vector<SpeedRun>& runs, const std::string& poissons_ratio,
                                     const std::vector<MotionRun>& motion,
                                     const std::vector<PublishedFigure>& published);

Plot plot_field(const std::vector<FieldPoint>& points);  // without series where there is no point
nlohmann::ordered_json field_json(const std::vector<FieldPoint>& points);

}  // namespace soft_robot_lab
