// Generated messages beside the core types.
#pragma once

// The generator puts messages into this package's namespace, where the core has an ActuatorState of its own.
#define ActuatorState ActuatorStateMessage
#include <soft_robot_lab/ActuatorState.h>
#undef ActuatorState

#include <soft_robot_lab/ActuatorCommand.h>
#include <soft_robot_lab/ActuatorLimits.h>
#include <soft_robot_lab/MarkerObservations.h>
#include <soft_robot_lab/Policy.h>
#include <soft_robot_lab/PolicyProgress.h>
#include <soft_robot_lab/PolicySummary.h>
#include <soft_robot_lab/Target.h>
