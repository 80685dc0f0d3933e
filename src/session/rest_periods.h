// SPDX-License-Identifier: BSD-3-Clause
// Where the robot of a recording rested, and how it came there.
#pragma once

#include <vector>

#include "soft_robot_lab/control/identification/fit_model.h"
#include "recording.h"
#include "rest_criterion.h"

namespace soft_robot_lab {

// The robot at rest under commands that do not change.
struct RestPeriod {
  double start_s = 0.0, end_s = 0.0;  // averaged between
  MeasuredPose pose;                  // markers seen, with the covariance of their mean
};

// In order of time. As in a session, but `observations` are of each marker, and windows longer where fewer frames came.
// A marker that cameras saw in fewer observations of a period is not in it.
std::vector<RestPeriod> rest_periods(const Recording& recording, const RestCriterion& criterion = {});

// For a fit: the rest periods, and between them, without markers, commands that were held without rest, so that
// friction knows the way; these say in `left_out` why.
std::vector<MeasuredPose> measured_poses(const Recording& recording, const RestCriterion& criterion = {});

// For a fit of damping: wherever the robot rested, was moved, and then left to itself for two windows at least, what
// cameras saw of the next seconds.
std::vector<MeasuredSwing> measured_swings(const Recording& recording, const RestCriterion& criterion = {});

}  // namespace soft_robot_lab
