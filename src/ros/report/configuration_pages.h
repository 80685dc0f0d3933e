// SPDX-License-Identifier: BSD-3-Clause
// A page for each configuration at rest of a recorded session: where its markers were tracked and simulated, and what
// the cameras saw.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ros/recording/recorded_session.h"
#include "session/rest_periods.h"

namespace soft_robot_lab {

// As 0.85 of `left` in "left 0.85, right 1"; "none yet" of none.
std::string words_of(const std::map<std::string, double>& commands);

// FOLDER/configuration_1.html, ..., numbered as in the report's table; names without the folder. Throws
// std::runtime_error where files cannot be written.
std::vector<std::string> write_configuration_pages(const std::string& bag, const RecordedSession& recording,
                                                   const std::vector<RestPeriod>& periods, const std::string& folder);

}  // namespace soft_robot_lab
