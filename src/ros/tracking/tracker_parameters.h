// SPDX-License-Identifier: BSD-3-Clause
// The numbers of a tracker's file behind dynamic_reconfigure: motion.gate is motion_gate there. Ranges are the file's.
#pragma once

#include <string>

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>

#include "soft_robot_lab/perception/tracking/tracker_settings.h"

namespace soft_robot_lab {

constexpr char tracker_updates[] = "tracker/parameter_updates";  // latched: all numbers as they hold

dynamic_reconfigure::Config config_message(TrackerSettings settings);
dynamic_reconfigure::ConfigDescription description_message(TrackerSettings settings);

// With what a request names, each cut to its range, as dynamic_reconfigure's servers do; other parameters, and what is
// not a number, change nothing.
TrackerSettings with_request(TrackerSettings settings, const dynamic_reconfigure::Config& request);

// The numbers of `after` that are not as in `before`.
dynamic_reconfigure::Config changed(const dynamic_reconfigure::Config& before,
                                    const dynamic_reconfigure::Config& after);
// As "motion_gate 9 -> 12, ...": how these numbers were changed from `before`.
std::string changes_text(const dynamic_reconfigure::Config& before, const dynamic_reconfigure::Config& changed);

}  // namespace soft_robot_lab
