// SPDX-License-Identifier: BSD-3-Clause
// The motor driver's state as messages.
#pragma once

#include <vector>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/time.h>
#include <soft_robot_lab/MotorState.h>
#include <soft_robot_lab/ShaftState.h>

#include "hardware/motor/motor_driver.h"
#include "hardware/testbench/rig_control.h"

namespace soft_robot_lab {

MotorState motor_state(const MotorDriver& driver, const ros::Time& stamp);
ShaftState shaft_state(const RigSettings& rig, const std::vector<ShaftTruth>& shafts, const ros::Time& stamp);

// Red while no motor may move, or one may not; yellow where its position has to be set first.
void diagnose_motors(const MotorDriver& driver, diagnostic_updater::DiagnosticStatusWrapper& status);

}  // namespace soft_robot_lab
