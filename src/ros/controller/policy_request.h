// SPDX-License-Identifier: BSD-3-Clause
// Service requests of the controller to tasks and options of the core, and policies and summaries back.
#pragma once

#include <optional>
#include <string>

#include <soft_robot_lab/ActuatorLimits.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/OptimisePolicy.h>

#include "soft_robot_lab/control/find_policy.h"
#include "ros/messages/messages.h"

namespace soft_robot_lab {

// `ramp_s`: of poses that do not say how long they take. Throws std::invalid_argument for lists of different lengths
// and targets that are not finite; what names and values mean is checked by find_policy.
PolicyTask policy_task(const OptimisePolicy::Request& request, double ramp_s);

// What a closed loop brings markers to: the request's goal, or else the last pose of the last task that a policy was
// found for. Throws std::invalid_argument as policy_task does, and where there is neither.
PolicyTask correction_task(const ExecutePolicy::Request& request, const std::optional<PolicyTask>& found);

ActuatorBounds bounds_of(const ActuatorLimits& limits);

// Where a request leaves the distance open.
void count_as_reached(const OptimisePolicy::Request& request, PolicyAnswer& answer);

// The message says why the last pose's search stopped, and, where the target is out of reach, what is nearest to it and
// what holds the markers back.
void fill_response(const PolicyAnswer& answer, const PolicyTask& task, OptimisePolicy::Response& response);

// Throws std::invalid_argument for an unknown method, or values out of range.
OptimiserOptions optimiser_options(const OptimisePolicy::Request& request);

// [s] of session time; throws std::invalid_argument where the request's limit is not beyond the policy's end.
double execution_time_limit_s(const ExecutePolicy::Request& request);

CommandPolicy from_message(const Policy& message);
Policy to_message(const CommandPolicy& policy);

PolicySummary to_message(const OptimisationSummary& summary);

}  // namespace soft_robot_lab
