// Finds policies on a model of its own and plays them on whatever listens to the actuator commands.
//
// Parameters: ~scene (path; absent in simulated sessions, where the simulator tells which scene runs), ~ramp_s (how
// long an optimised policy takes to reach its commands).
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>

#include <ros/ros.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/OptimisePolicy.h>
#include <std_msgs/String.h>
#include <std_srvs/Trigger.h>

#include "nodes/run_node.h"
#include "soft_robot_lab/control/find_policy.h"
#include "soft_robot_lab/ros/actuator_plugins.h"
#include "soft_robot_lab/ros/conversions.h"
#include "soft_robot_lab/ros/policy_request.h"
#include "soft_robot_lab/ros/rest_detector.h"
#include "soft_robot_lab/ros/topics.h"
#include "soft_robot_lab/scene/scene.h"

namespace soft_robot_lab {
namespace {

// A policy on its way, from the first marker message after its start to the last command, and to rest.
struct Execution {
  Execution(PolicyPlayer policy_player, bool wait, double limit_s)
      : player(std::move(policy_player)), wait_until_rest(wait), time_limit_s(limit_s) {}

  PolicyPlayer player;
  bool wait_until_rest;
  double time_limit_s;  // of session time
  RestDetector rest;
  std::optional<double> start_s;  // stamp of that first message
  double elapsed_s = 0.0;
  ros::WallTime heard = ros::WallTime::now();
  MarkerObservations markers;
  bool sent = false;  // the last command
  bool rested = false;
  bool cancelled = false;

  bool done() const { return sent && (rested || !wait_until_rest); }
  bool overdue() const { return elapsed_s > time_limit_s; }
};

class ControllerNode {
 public:
  ControllerNode();

 private:
  void load(const std::string& path);
  void offer_services();  // once there is a model to answer with
  void on_scene(const std_msgs::String& path);
  void on_actuators(const ActuatorState& actuators);
  void on_markers(const MarkerObservations& markers);
  void play(Execution& execution);
  bool optimise_policy(OptimisePolicy::Request& request, OptimisePolicy::Response& response);
  bool execute_policy(ExecutePolicy::Request& request, ExecutePolicy::Response& response);
  void execute(const ExecutePolicy::Request& request, ExecutePolicy::Response& response);
  Execution new_execution(const ExecutePolicy::Request& request) const;
  bool cancel(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  PolicyAnswer find(const PolicyTask& task, const OptimiserOptions& options);
  void publish_progress(const std::string& method, const std::string& marker, const std::vector<std::string>& actuators,
                        const OptimisationProgress& progress) const;
  void publish_target(const MarkerGoal& goal) const;

  SceneOptions scene_options_;
  double ramp_s_ = 2.0;

  std::mutex model_mutex_;  // held while the model computes
  std::unique_ptr<Simulation> model_;
  std::atomic<bool> optimising_{false};
  std::atomic<bool> cancel_optimisation_{false};

  std::mutex mutex_;  // guards what follows; held briefly
  CommandLimitsByName limits_;
  std::map<std::string, double> commands_;  // as the actuators last said, whoever sent them
  std::optional<Execution> execution_;
  std::condition_variable execution_changed_;

  ros::NodeHandle node_;
  ros::Publisher command_publisher_, progress_publisher_, target_publisher_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
};

ControllerNode::ControllerNode() {
  scene_options_.actuator_factory = actuators_from_plugins();
  const ros::NodeHandle parameters("~");
  parameters.getParam("ramp_s", ramp_s_);
  if (!(ramp_s_ >= 0.0 && ramp_s_ <= 3600.0)) {
    throw std::invalid_argument("ramp_s: " + std::to_string(ramp_s_) + " is not in [0, 3600]");
  }
  std::string scene;
  if (parameters.getParam("scene", scene)) load(scene);

  command_publisher_ = node_.advertise<ActuatorCommand>(topics::actuator_command, 100);
  progress_publisher_ = node_.advertise<PolicyProgress>(topics::controller_progress, 100);
  target_publisher_ = node_.advertise<Target>(topics::controller_target, 1, true);
  subscribers_ = {
      node_.subscribe(topics::simulator_scene, 1, &ControllerNode::on_scene, this),
      node_.subscribe(topics::simulator_actuators, 1, &ControllerNode::on_actuators, this),
      node_.subscribe(topics::simulator_markers, 100, &ControllerNode::on_markers, this),
  };
  if (model_) offer_services();
}

void ControllerNode::offer_services() {
  services_ = {
      node_.advertiseService(topics::optimise_policy, &ControllerNode::optimise_policy, this),
      node_.advertiseService(topics::execute_policy, &ControllerNode::execute_policy, this),
      node_.advertiseService(topics::cancel_policy, &ControllerNode::cancel, this),
  };
}

// Throws what load_scene throws; the old model then stays.
void ControllerNode::load(const std::string& path) {
  Scene scene = load_scene(path, scene_options_);
  CommandLimitsByName limits = limits_of(*scene.simulation);
  const std::scoped_lock lock(model_mutex_, mutex_);
  model_ = std::move(scene.simulation);
  limits_ = std::move(limits);
  commands_.clear();
}

void ControllerNode::on_scene(const std_msgs::String& path) {
  try {
    load(path.data);
    ROS_INFO("models %s", path.data.c_str());
    if (services_.empty()) offer_services();
  } catch (const std::exception& error) {
    ROS_ERROR("keeps its old model: %s", error.what());
  }
}

void ControllerNode::on_actuators(const ActuatorState& actuators) {
  const std::lock_guard lock(mutex_);
  for (size_t i = 0; i < actuators.names.size(); ++i) commands_[actuators.names[i]] = actuators.commands.at(i);
}

bool ControllerNode::optimise_policy(OptimisePolicy::Request& request, OptimisePolicy::Response& response) {
  try {
    const std::unique_lock lock(model_mutex_, std::try_to_lock);
    if (!lock) throw std::runtime_error("busy with another optimisation; ask again when it ended");
    const PolicyTask task = policy_task(request, ramp_s_);
    const PolicyAnswer answer = find(task, optimiser_options(request));
    for (const OptimisationSummary& summary : answer.summaries) response.poses.push_back(to_message(summary));
    response.summary = response.poses.back();
    response.success = answer.success;
    response.message = response.summary.stop_reason;
    if (answer.success) response.policy = to_message(answer.policy);
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
  }
  if (!response.success) ROS_WARN("%s refused: %s", topics::optimise_policy, response.message.c_str());
  return true;
}

// From the rest state without commands, whatever the model was asked before.
PolicyAnswer ControllerNode::find(const PolicyTask& task, const OptimiserOptions& options) {
  model_->reset();
  cancel_optimisation_ = false;
  std::optional<size_t> told;
  optimising_ = true;
  const std::shared_ptr<void> no_longer(nullptr, [this](void*) { optimising_ = false; });
  return find_policy(*model_, task, options, [&](size_t pose, const auto& actuators, const auto& progress) {
    const MarkerGoal& goal = task.poses[pose].goals.front();
    if (told != pose) publish_target(goal);
    told = pose;
    publish_progress(options.method, goal.marker, actuators, progress);
    return ros::ok() && !cancel_optimisation_;
  });
}

bool ControllerNode::cancel(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  const std::lock_guard lock(mutex_);
  response.success = optimising_ || execution_;
  response.message = response.success ? "" : "nothing is optimised or executed now";
  if (optimising_) cancel_optimisation_ = true;
  if (execution_) execution_->cancelled = true;
  execution_changed_.notify_all();
  return true;
}

void ControllerNode::publish_target(const MarkerGoal& goal) const {
  Target target;
  target.header.stamp = ros::Time::now();
  target.header.frame_id = topics::robot_frame;
  target.marker = goal.marker;
  target.position = to_message(goal.target_m);
  target_publisher_.publish(target);
}

void ControllerNode::publish_progress(const std::string& method, const std::string& marker,
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

bool ControllerNode::execute_policy(ExecutePolicy::Request& request, ExecutePolicy::Response& response) {
  try {
    execute(request, response);
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
  }
  if (!response.success) ROS_WARN("%s refused: %s", topics::execute_policy, response.message.c_str());
  return true;
}

Execution ControllerNode::new_execution(const ExecutePolicy::Request& request) const {
  if (execution_) throw std::runtime_error("busy with another policy; ask again when it ended");
  const CommandPolicy policy = from_message(request.policy);
  validate(policy, limits_);
  std::vector<double> start_values;
  for (const std::string& name : policy.names) {
    const auto seen = commands_.find(name);
    start_values.push_back(seen != commands_.end() ? seen->second : limits_.at(name).rest);
  }
  return {PolicyPlayer(policy, start_values), request.wait_until_rest != 0, execution_time_limit_s(request)};
}

// Waits while the marker messages drive the policy on, in whatever time the session runs.
void ControllerNode::execute(const ExecutePolicy::Request& request, ExecutePolicy::Response& response) {
  constexpr double silence_s = 10.0;  // of wall time without markers
  std::unique_lock lock(mutex_);
  execution_.emplace(new_execution(request));
  const auto silent = [&] { return (ros::WallTime::now() - execution_->heard).toSec() > silence_s; };
  while (ros::ok() && !execution_->done() && !execution_->overdue() && !execution_->cancelled && !silent()) {
    execution_changed_.wait_for(lock, std::chrono::milliseconds(100));
  }
  response.success = execution_->done();
  if (!response.success) {
    response.message = execution_->cancelled   ? "cancelled"
                       : execution_->overdue() ? "not at rest within " + std::to_string(execution_->time_limit_s) + " s"
                       : ros::ok()             ? "no markers came for 10 s"
                                               : "cancelled: the session ends";
  }
  response.duration_s = execution_->elapsed_s;
  response.markers = execution_->markers;
  execution_.reset();
}

void ControllerNode::on_markers(const MarkerObservations& markers) {
  const std::lock_guard lock(mutex_);
  if (!execution_ || execution_->cancelled) return;
  Execution& execution = *execution_;
  const double now_s = markers.header.stamp.toSec();
  if (!execution.start_s) execution.start_s = now_s;
  execution.elapsed_s = now_s - *execution.start_s;
  execution.heard = ros::WallTime::now();
  execution.markers = markers;
  if (!execution.sent) {
    play(execution);
  } else {
    execution.rested = execution.rest.update(now_s, markers.positions);
  }
  if (execution.done() || execution.overdue()) execution_changed_.notify_all();
}

void ControllerNode::play(Execution& execution) {
  ActuatorCommand command;
  command.header.stamp = ros::Time::now();
  command.names = execution.player.names();
  command.values = execution.player.values_at(execution.elapsed_s);
  command_publisher_.publish(command);
  execution.sent = execution.elapsed_s >= execution.player.end_s();
}

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  using namespace soft_robot_lab;
  return run_node(argc, argv, "controller", [] {
    // One thread each for an optimisation, an execution, a scene being loaded, and the topics.
    ros::AsyncSpinner spinner(4);
    ControllerNode node;
    spinner.start();
    ros::waitForShutdown();
  });
}
