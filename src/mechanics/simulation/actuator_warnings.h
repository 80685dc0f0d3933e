// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "soft_robot_lab/mechanics/actuator.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

// What this actuator was asked for and the body does not let it do, or what no robot would stand.
std::vector<SolveWarning> actuator_warnings(const ActuatorReading& reading, const Body& body);

// Whether one of them is of a state that no robot takes; then the report has not converged, and says why.
bool refuse_impossible(const std::vector<SolveWarning>& warnings, SolveReport& report);

}  // namespace soft_robot_lab
