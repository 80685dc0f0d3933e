// Service requests of the controller to problems and options of the core, and summaries back.
#pragma once

#include <string>
#include <vector>

#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/OptimisePolicy.h>

#include "soft_robot_lab/control/optimiser.h"
#include "soft_robot_lab/ros/messages.h"
#include "soft_robot_lab/sim/simulation.h"

namespace soft_robot_lab {

// The problem without its model: target, and all actuators within their own and the requested limits, from their rest
// commands. Throws std::invalid_argument naming field, value and allowed range.
ReachProblem reach_problem(const OptimisePolicy::Request& request, const Simulation& simulation);

// Throws std::invalid_argument for an unknown method.
OptimiserOptions optimiser_options(const OptimisePolicy::Request& request);

// [s] of session time; throws std::invalid_argument where the request's limit is not beyond the policy's end.
double execution_time_limit_s(const ExecutePolicy::Request& request);

Policy policy_of(const std::vector<std::string>& names, const Eigen::VectorXd& commands, double ramp_s);

PolicySummary to_message(const OptimisationSummary& summary);

}  // namespace soft_robot_lab
