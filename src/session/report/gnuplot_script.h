// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "plot.h"

namespace soft_robot_lab {

// A whole gnuplot script with its data; `terminal` is "svg" or "png".
std::string gnuplot_script(const Plot& plot, const std::string& terminal, const std::string& output_file);

}  // namespace soft_robot_lab
