// SPDX-License-Identifier: BSD-3-Clause
#include "policy_search.h"

#include <memory>
#include <optional>
#include <utility>

#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "interruptible.h"
#include "ros/messages/messages.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {

PolicySearch::PolicySearch(ros::NodeHandle& node, Aimed aimed)
    : aimed_(std::move(aimed)),
      progress_publisher_(node.advertise<PolicyProgress>(topics::controller_progress, 100)),
      target_publisher_(node.advertise<Target>(topics::controller_target, 1, true)) {}

PolicyAnswer PolicySearch::find(Simulation& model, const PolicyTask& task, const OptimiserOptions& options,
                                const ReducedChoice* reduced) {
  model.reset();
  return go_on(model, task, options, {}, reduced);
}

PolicyAnswer PolicySearch::go_on(Simulation& model, const PolicyTask& task, const OptimiserOptions& options,
                                 const ProgressCallback& after_each, const ReducedChoice* reduced) {
  cancelled_ = false;
  std::optional<size_t> published;
  searching_ = true;
  const std::shared_ptr<void> no_longer(nullptr, [this](void*) { searching_ = false; });
  const Interruptible interruptible(
      model, [this, others = model.interrupt()] { return cancelled_ || !ros::ok() || (others && others()); });
  const auto show = [&](size_t pose, const auto& actuators, const auto& progress) {
    const MarkerGoal& goal = task.poses[pose].goals.front();
    if (published != pose) {
      publish_target(goal);
      aimed_(goal);
    }
    published = pose;
    publish_progress(options.method, goal.marker, actuators, progress);
    return ros::ok() && !cancelled_ && (!after_each || after_each(progress));
  };
  return find_policy(model, task, options, show, reduced);
}

bool PolicySearch::cancel() {
  if (!searching_) return false;
  cancelled_ = true;
  return true;
}

void PolicySearch::forget_target() {
  if (has_target_.exchange(false)) publish_target({});
}

void PolicySearch::publish_target(const MarkerGoal& goal) {
  has_target_ = !goal.marker.empty();
  Target target;
  target.header.stamp = ros::Time::now();
  target.header.frame_id = robot_frame();
  target.marker = goal.marker;
  target.position = to_message(goal.target_m);
  target_publisher_.publish(target);
}

void PolicySearch::publish_progress(const std::string& method, const std::string& marker,
                                    const std::vector<std::string>& actuators,
                                    const OptimisationProgress& progress) const {
  PolicyProgress message;
  message.header.stamp = ros::Time::now();
  message.method = method;
  message.marker = marker;
  message.iteration = progress.iteration;
  message.distance_m = progress.distance_m;
  message.names = actuators;
  message.values.assign(progress.commands.data(), progress.commands.data() + progress.commands.size());
  progress_publisher_.publish(message);
}

}  // namespace soft_robot_lab
