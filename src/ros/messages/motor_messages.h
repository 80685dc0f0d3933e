// SPDX-License-Identifier: BSD-3-Clause
// The drivers' states as messages.
#pragma once

#include <vector>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/time.h>
#include <soft_robot_lab/MotorState.h>
#include <soft_robot_lab/PressureState.h>
#include <soft_robot_lab/ShaftState.h>

#include "hardware/motor/motor_driver.h"
#include "hardware/motor/pressure_driver.h"
#include "hardware/testbench/rig_control.h"

namespace soft_robot_lab {

MotorState motor_state(const MotorDriver& driver, const ros::Time& stamp);
MotorState motor_state(const PressureDriver& driver, const ros::Time& stamp);  // for whoever watches any rig
PressureState pressure_state(const PressureDriver& driver, const ros::Time& stamp);
ShaftState shaft_state(const RigSettings& rig, const std::vector<ShaftTruth>& shafts, const ros::Time& stamp);
ShaftState shaft_state(const RigSettings& rig, const std::vector<double>& pressures_pa, const ros::Time& stamp);

// Red while no drive may move, or one may not; yellow where its position has to be set first.
void diagnose(const MotorDriver& driver, diagnostic_updater::DiagnosticStatusWrapper& status);
void diagnose(const PressureDriver& driver, diagnostic_updater::DiagnosticStatusWrapper& status);

}  // namespace soft_robot_lab
