// SPDX-License-Identifier: BSD-3-Clause
// Requests of the tracker's calibration to the core, and poses back.
#pragma once

#include <string>
#include <vector>

#include <soft_robot_lab/Calibrate.h>

#include "perception/calibration/calibration_session.h"

namespace soft_robot_lab {

// One step of a calibration. The poses found, also saved to the file; none where only pictures without balls were
// taken, or the answer says what is wrong.
std::vector<CameraPose> calibrate(const Calibrate::Request& request, CalibrationSession& session,
                                  const std::string& file, Calibrate::Response& answer);

}  // namespace soft_robot_lab
