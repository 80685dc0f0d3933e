// SPDX-License-Identifier: BSD-3-Clause
// A verdict to look at.
#pragma once

#include <string>

#include "check_casting.h"

namespace soft_robot_lab {

// The bytes of a PNG: the robot as it lies in its mould, or turned over. Red: skin in the way; orange: too thin.
std::string verdict_picture_png(const CastingVerdict& verdict, double min_thickness_m, bool turned_over);

// A page that shows from_above.png and from_below.png beside it.
std::string verdict_html(const CastingVerdict& verdict, const std::string& robot_name);

// verdict.html, verdict.json and both pictures, into a folder that is made where there is none. Throws WriteError.
void write_verdict(const CastingVerdict& verdict, const std::string& robot_name, double min_thickness_m,
                   const std::string& folder);

}  // namespace soft_robot_lab
