// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/robot/rollouts/batch.h"

namespace soft_robot_lab {

// What rollouts did, as the bytes of a NumPy archive:
//   actuators, markers               names
//   time_s                           times
//   commands, reached                rollouts x times x actuators: as commanded, and where the drive was
//   markers_m                        rollouts x times x markers x 3, robot_base
//   converged, reduced               rollouts: whether every step did; whether a reduced model served to the end, and
//   passed its audits
// Rollouts that were not started are left out.
std::string rollouts_npz(const Scene& scene, const std::vector<RunReport>& reports);

// The same in a few numbers, as JSON: how many rollouts were run, converged and stayed on a reduced model, and of each
// marker the mean, the least and the largest coordinates over all of them.
std::string rollouts_json(const Scene& scene, const std::vector<RunReport>& reports);

}  // namespace soft_robot_lab
