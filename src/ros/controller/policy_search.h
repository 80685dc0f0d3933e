// SPDX-License-Identifier: BSD-3-Clause
// Searches for policies as a session sees them: controller/target says what is searched for, controller/progress how
// far it is, and a search may be cancelled.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include <ros/ros.h>

#include "soft_robot_lab/control/find_policy.h"

namespace soft_robot_lab {

class PolicySearch {
 public:
  using Aimed = std::function<void(const MarkerGoal&)>;

  // `aimed` learns what is searched for when controller/target does, in the thread that searches.
  PolicySearch(ros::NodeHandle& node, Aimed aimed);

  // From the model's rest state without commands, whatever it was asked before; one search at a time. Throws what
  // find_policy throws. `reduced` as find_policy has it.
  PolicyAnswer find(Simulation& model, const PolicyTask& task, const OptimiserOptions& options,
                    const ReducedChoice* reduced = nullptr);

  // From where the model is: quick where the task is near to the one before. What `after_each` iteration throws ends
  // the search at once, and the model stays where it then is. Where the model's own interrupt asks for an end the
  // search is cancelled.
  PolicyAnswer go_on(Simulation& model, const PolicyTask& task, const OptimiserOptions& options,
                     const ProgressCallback& after_each = {}, const ReducedChoice* reduced = nullptr);

  // Within a solve too. False where nothing is searched for; the answer then has the poses found so far.
  bool cancel();

  // Another robot runs: controller/target then names no marker. Nothing where nothing was searched for.
  void forget_target();

 private:
  void publish_target(const MarkerGoal& goal);
  void publish_progress(const std::string& method, const std::string& marker, const std::vector<std::string>& actuators,
                        const OptimisationProgress& progress) const;

  Aimed aimed_;
  ros::Publisher progress_publisher_, target_publisher_;
  std::atomic<bool> has_target_{false};
  std::atomic<bool> searching_{false};
  std::atomic<bool> cancelled_{false};
};

}  // namespace soft_robot_lab
