// SPDX-License-Identifier: BSD-3-Clause
// Generated messages beside the core types.
#pragma once

#include <soft_robot_lab/ActuatorCommand.h>
#include <soft_robot_lab/ActuatorLimits.h>
#include <soft_robot_lab/ActuatorRanges.h>
#include <soft_robot_lab/ActuatorState.h>
#include <soft_robot_lab/Contacts.h>
#include <soft_robot_lab/MarkerObservations.h>
#include <soft_robot_lab/MotorState.h>
#include <soft_robot_lab/Policy.h>
#include <soft_robot_lab/PolicyProgress.h>
#include <soft_robot_lab/PolicySummary.h>
#include <soft_robot_lab/Target.h>
