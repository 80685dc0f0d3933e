// SPDX-License-Identifier: BSD-3-Clause
// A verdict to look at.
#pragma once

#include <string>
#include <vector>

#include "check_casting.h"
#include "mould_picture.h"

namespace soft_robot_lab {

// Of each triangle that was judged. Red: skin in the way; orange: too thin.
std::vector<Paint> verdict_paints(const CastingVerdict& verdict, double min_thickness_m);

// The bytes of a PNG: the robot as it lies in its mould, or turned over, in these paints.
std::string verdict_picture_png(const CastingVerdict& verdict, double min_thickness_m, bool turned_over);

// A page that shows from_above.png and from_below.png beside it.
std::string verdict_html(const CastingVerdict& verdict, const std::string& robot_name);

// verdict.html, verdict.json and both pictures, into a folder that is made where there is none. Throws WriteError.
void write_verdict(const CastingVerdict& verdict, const std::string& robot_name, double min_thickness_m,
                   const std::string& folder);

}  // namespace soft_robot_lab
