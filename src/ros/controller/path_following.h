// SPDX-License-Identifier: BSD-3-Clause
// The work of the action controller/follow_path: plans on the controller's model, and plays on the actuators.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>

#include <soft_robot_lab/FollowPathAction.h>

#include "controller_model.h"
#include "policy_execution.h"
#include "session/live_answers.h"
#include "soft_robot_lab/control/motion/plan_motion.h"

namespace soft_robot_lab {

class PathFollowing {
 public:
  using Shown = std::function<void(const PathPlan& plan, double tolerance_m)>;
  using Feedback = std::function<void(const FollowPathFeedback&)>;

  // As the session has it now.
  struct Robot {
    std::string name;                        // in a policy
    std::map<std::string, double> commands;  // where its actuators stand
  };

  // Keeps references. `shown`: is handed what is planned. `ramp_s`: how long the way to the path's start takes.
  PathFollowing(ControllerModel& model, PolicyExecution& execution, LiveAnswers& live, std::function<Robot()> robot,
                Shown shown, double ramp_s)
      : model_(model),
        execution_(execution),
        live_(live),
        robot_(std::move(robot)),
        shown_(std::move(shown)),
        ramp_s_(ramp_s) {}

  // Refusals are in the answer.
  FollowPathResult follow(const FollowPathGoal& goal, const Feedback& feedback);

 private:
  struct Planned {
    PathPlan path;
    std::string robot;
    std::size_t marker = 0;  // among the scene's
    double step_s = 0.0;     // of the simulator
  };

  Planned plan(const FollowPathGoal& goal, FollowPathResult& result);
  void play(const FollowPathGoal& goal, Planned& planned, const Feedback& feedback, FollowPathResult& result);
  ExecutionReport play_once(const Planned& planned, bool with_feedback,
                            const decltype(ExecutionOrder::on_path)& on_path);

  ControllerModel& model_;
  PolicyExecution& execution_;
  LiveAnswers& live_;
  std::function<Robot()> robot_;
  Shown shown_;
  double ramp_s_;
};

}  // namespace soft_robot_lab
