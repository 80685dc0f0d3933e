// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
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

#include "read_parameter.h"
#include "run_node.h"
#include "ros/base/actuator_plugins.h"
#include "ros/base/behind_others.h"
#include "ros/base/log_text.h"
#include "ros/base/topics.h"
#include "ros/controller/controller_actions.h"
#include "ros/controller/controller_model.h"
#include "ros/controller/controller_publisher.h"
#include "ros/controller/fit_service.h"
#include "ros/controller/interruptible.h"
#include "ros/controller/path_following.h"
#include "ros/controller/policy_execution.h"
#include "ros/controller/policy_request.h"
#include "ros/controller/policy_search.h"
#include "ros/display/path_marker.h"
#include "ros/display/target_marker.h"
#include "ros/messages/conversions.h"
#include "ros/messages/message_limits.h"
#include "ros/messages/same_fields.h"
#include "session/live_answers.h"
#include "session/preview.h"
#include "settings/require_in_range.h"
#include "soft_robot_lab/control/forward_model.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "soft_robot_lab/robot/scene/scene_file.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kControllerAbout =
    R"(Finds policies on a model of its own, and plays and corrects them on whatever
listens to the actuator commands. Where the session's solver is reduced, the reduced
model searches, shows where commands lead and predicts in closed loops; policies end on
newton's rest state. With xpbd newton does all that: their rest states are the same.

Parameters: ~scene (path; absent where the simulator names which scene runs), ~ramp_s (how long an optimised policy
takes to reach its commands), ~markers_topic (what corrects a policy), ~lost_after_s (without any marker for so long
a closed loop stops).)";

struct ControllerOptions {
  double ramp_s = 2.0;  // [0, 3600]
  ClosedLoopOptions loop;
};

// Throws std::invalid_argument naming the parameter.
ControllerOptions read_controller_options() {
  const ros::NodeHandle node("~");
  ControllerOptions options;
  read_parameter(node, "ramp_s", options.ramp_s);
  require_in_range("ramp_s", options.ramp_s, {0.0, 3600.0});
  read_parameter(node, "lost_after_s", options.loop.lost_after_s);
  options.loop.validate();
  return options;
}

// What the session runs.
struct SessionScene {
  // With its reduced model where one is kept, unless the session chose another solver. Throws what load_scene throws.
  Scene load(const std::string& file) const;

  SceneOptions options;
  std::mutex mutex;          // held while a model is loaded; before the others
  std::string path, solver;  // empty: not known; guarded by it
};

Scene SessionScene::load(const std::string& file) const {
  SceneOptions wanted = options;
  if (solver == "reduced") wanted.method = solver;
  Scene scene = load_scene(file, wanted);
  if (!solver.empty() && solver != "reduced") scene.reduction.reset();
  return scene;
}

struct FoundPolicy {
  PolicyTask task;
  CommandPolicy policy;
};

// The robot as the session last said, and what was found for it.
struct KnownRobot {
  CommandLimitsByName limits;
  std::string name;
  std::vector<std::string> markers;        // names
  double size_m = 0.0;                     // of its body at rest, along one axis
  std::map<std::string, double> commands;  // as the actuators last said, whoever sent them
  std::optional<FoundPolicy> found;        // the last
  int found_count = 0;                     // of policies, since the node began
  Preview preview;
};

double largest_extent_m(const TetMesh& mesh) {
  return (mesh.nodes_m.rowwise().maxCoeff() - mesh.nodes_m.rowwise().minCoeff()).maxCoeff();
}

template <typename Service, typename Handler>
ros::ServiceServer serve(ros::NodeHandle& node, const std::string& name, Handler handler) {
  return node.advertiseService<typename Service::Request, typename Service::Response>(
      name, [handler](auto& request, auto& response) {
        handler(request, response);
        return true;
      });
}

class ControllerNode {
 public:
  ControllerNode();

 private:
  void load(const std::string& path);
  void offer_services();  // once there is a model to answer with
  void on_scene(const std_msgs::String& path);
  void on_solver(const std_msgs::String& solver);
  void on_actuators(const ActuatorState& actuators);
  void on_markers(const MarkerObservations& markers);
  void on_target(const std::string& marker, const Eigen::Vector3d& target_m, bool released);
  void answer_target(const MarkerGoal& goal, bool released, const std::function<bool()>& interrupted);
  void say_what_came(const PolicyTask& task, const PolicyAnswer& answer);
  void say_why_not(const std::string& why) const;
  void on_target_shown(const Target& target);
  void answer_commands();
  void hide_preview();
  void remember(const PolicyTask& task, const PolicyAnswer& answer);
  bool show_iterate(const OptimisationProgress& progress);
  void remove_ghost(int found_count);
  void show_target(const std::string& marker, const Eigen::Vector3d& target_m);
  void show_tip_as_target();
  void optimise_policy(const OptimisePolicy::Request& request, OptimisePolicy::Response& response);
  void execute_policy(const ExecutePolicy::Request& request, ExecutePolicy::Response& response);
  ControllerHandlers handlers();
  PathFollowing::Robot robot() const;
  double command_of(const std::string& actuator) const;  // with the lock
  void execute(const ExecutePolicy::Request& request, ExecutePolicy::Response& response);
  ExecutionOrder order_of(const ExecutePolicy::Request& request) const;
  ExecutePolicy::Request with_policy(ExecutePolicy::Request request) const;
  ClosedLoop loop_of(const ExecutePolicy::Request& request, const CommandPolicy& policy);
  bool cancel(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  template <typename Field>
  Field known(Field KnownRobot::*field) const {
    const std::lock_guard lock(mutex_);
    return known_.*field;
  }

  const ControllerOptions options_ = read_controller_options();
  SessionScene session_;
  ControllerModel model_;
  mutable std::mutex mutex_;  // guards what is known of the robot; held briefly
  KnownRobot known_;

  ros::NodeHandle node_;
  ControllerPublisher publisher_{node_};
  PolicyExecution execution_{options_.loop,
                             [this](const auto& names, const auto& values) { publisher_.send(names, values); }};
  PolicySearch search_{node_, [this](const MarkerGoal& goal) { show_target(goal.marker, goal.target_m); }};
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  std::unique_ptr<FitService> fit_service_;
  LiveAnswers live_;
  TargetMarker target_{node_, [this](const auto&... moved) { on_target(moved...); }};
  std::unique_ptr<ControllerActions> actions_;  // last: its threads end first
};

ControllerNode::ControllerNode() {
  session_.options.actuator_factory = actuators_from_plugins();
  session_.options.reduced = ReducedUse::if_kept;
  session_.options.interrupt = [] { return !ros::ok(); };
  const ros::NodeHandle parameters("~");
  std::string scene;
  if (read_parameter(parameters, "scene", scene)) load(scene);

  subscribers_ = {
      node_.subscribe(topics::simulator_scene, 1, &ControllerNode::on_scene, this),
      node_.subscribe(topics::simulator_solver, 1, &ControllerNode::on_solver, this),
      node_.subscribe(topics::simulator_actuators, 1, &ControllerNode::on_actuators, this),
      node_.subscribe(topics::simulator_markers, 100, &ControllerNode::on_markers, this),
      node_.subscribe(text_parameter(parameters, "markers_topic", topics::tracker_markers), 100,
                      &PolicyExecution::add_measured, &execution_),
      node_.subscribe(topics::motor_state, 100, &PolicyExecution::add_motors, &execution_),
      node_.subscribe(topics::target_shown, 10, &ControllerNode::on_target_shown, this),
  };
  fit_service_ = std::make_unique<FitService>(node_, session_.options, scene);
  if (model_.is_there()) offer_services();
}

void ControllerNode::offer_services() {
  services_ = {
      serve<OptimisePolicy>(node_, topics::optimise_policy, handlers().optimise),
      serve<ExecutePolicy>(node_, topics::execute_policy, handlers().execute),
      node_.advertiseService(topics::cancel_policy, &ControllerNode::cancel, this),
  };
  actions_ = std::make_unique<ControllerActions>(node_, handlers());
  fit_service_->on_progress = [this](int iteration, double gap_m) { actions_->on_fit_progress(iteration, gap_m); };
}

ControllerHandlers ControllerNode::handlers() {
  ControllerHandlers all;
  all.optimise = [this](const auto& request, auto& response) { optimise_policy(request, response); };
  all.execute = [this](const auto& request, auto& response) { execute_policy(request, response); };
  all.fit = [this](const auto& request, auto& response) { fit_service_->answer(request, response); };
  all.follow = [this](const auto& goal, const auto& feedback) {
    const auto show = [this](const PathPlan& plan, double tolerance_m) {
      publisher_.show_path(path_marker(plan, tolerance_m));
    };
    PathFollowing paths(
        model_, execution_, live_, [this] { return robot(); }, show, options_.ramp_s);
    return paths.follow(goal, feedback);
  };
  all.in_robot_base = [this](const auto& pose) { return target_.in_robot_base(pose); };
  all.cancel = [this] {
    execution_.cancel();
    search_.cancel();
  };
  all.cancel_fit = [this] { fit_service_->cancel(); };
  return all;
}

// Throws what load_scene throws; the old model then stays.
void ControllerNode::load(const std::string& path) {
  const std::lock_guard one_at_a_time(session_.mutex);
  Scene scene = session_.load(path);
  session_.path = path;
  KnownRobot robot;
  robot.limits = limits_of(*scene.simulation);
  robot.name = name_of_robot(path);
  for (const Marker& marker : scene.simulation->markers()) robot.markers.push_back(marker.name());
  robot.size_m = largest_extent_m(scene.simulation->body().mesh());
  const auto no_answers = live_.pause();
  const auto model_lock = model_.lock();
  model_.take(std::move(scene));
  {
    const std::lock_guard lock(mutex_);
    robot.found_count = known_.found_count;
    known_ = std::move(robot);
  }
  publisher_.remove_ghost();
  publisher_.remove_preview();
  publisher_.show_path(no_path());
  search_.forget_target();
  show_tip_as_target();
}

// Or the last marker, where none is called so.
void ControllerNode::show_tip_as_target() {
  const std::vector<Marker>& markers = model_.simulation().markers();
  if (markers.empty()) return;
  const auto tip = std::find_if(markers.begin(), markers.end(), [](const auto& one) { return one.name() == "tip"; });
  const Marker& shown = tip != markers.end() ? *tip : markers.back();
  show_target(shown.name(), model_.markers_m()[static_cast<size_t>(&shown - markers.data())]);
}

void ControllerNode::show_target(const std::string& marker, const Eigen::Vector3d& target_m) {
  constexpr double least_m = 0.028;  // with a ball that the overlay's does not hide
  target_.show(marker, target_m, std::max(0.25 * known(&KnownRobot::size_m), least_m));
}

// As the panel does where another marker is chosen, or a number typed.
void ControllerNode::on_target_shown(const Target& target) {
  const std::vector<std::string> markers = known(&KnownRobot::markers);
  const bool has_marker = std::find(markers.begin(), markers.end(), target.marker) != markers.end();
  try {
    require_in_limits<Target>(target);
    const Eigen::Vector3d position_m = from_message(target.position, "position");
    if (!has_marker) throw std::invalid_argument("marker: the scene has no '" + target.marker + "'");
    show_target(target.marker, position_m);
  } catch (const std::exception& error) {
    ROS_WARN_THROTTLE(1.0, "%s refused: %s", topics::target_shown, log_text(error.what()).c_str());
  }
}

void ControllerNode::remember(const PolicyTask& task, const PolicyAnswer& answer) {
  const std::lock_guard lock(mutex_);
  const bool played = answer.summaries.back().stop_reason != "cancelled";  // so the model is there
  if (played) publisher_.show_ghost(model_.skin());
  if (!played) publisher_.remove_ghost();
  known_.found = FoundPolicy{task, answer.policy};
  ++known_.found_count;
}

// Not where another was found since: its ghost stays.
void ControllerNode::remove_ghost(int found_count) {
  const std::lock_guard lock(mutex_);
  if (found_count == known_.found_count) publisher_.remove_ghost();
}

// Where the model is at these commands, and not at those of a step that led nowhere.
bool ControllerNode::show_iterate(const OptimisationProgress& progress) {
  const std::vector<double> commands = model_.simulation().state().commands();  // of all actuators: all may move
  if (!std::equal(commands.begin(), commands.end(), progress.commands.begin(), progress.commands.end())) return false;
  publisher_.show_ghost(model_.skin());
  return true;
}

void ControllerNode::on_target(const std::string& marker, const Eigen::Vector3d& target_m, bool released) {
  live_.ask(LiveAnswers::Kind::target,
            [this, goal = MarkerGoal{marker, target_m, 1.0}, released](const auto& interrupted) {
              try {
                answer_target(goal, released, interrupted);
              } catch (const std::exception& error) {
                if (released && !interrupted()) say_why_not(error.what());
              }
            });
}

void ControllerNode::say_why_not(const std::string& why) const {
  OptimisePolicyResult result;
  result.message = why;
  publisher_.answer(result);
}

void ControllerNode::say_what_came(const PolicyTask& task, const PolicyAnswer& answer) {
  OptimisePolicy::Response response;
  PolicyAnswer counted = answer;
  count_as_reached(counted);
  fill_response(counted, task, response);
  for (const std::string& warning : far_targets(model_.simulation(), task)) response.message += "; " + warning;
  publisher_.answer(same_fields<OptimisePolicyResult>(response));
}

// While the target is dragged, from where the model is; where it is let go, as the service does it. The ghost follows
// after each iteration, and a newer target ends the search there: to replay what was found so far would cost as much.
void ControllerNode::answer_target(const MarkerGoal& goal, bool released, const std::function<bool()>& interrupted) {
  const auto lock = model_.try_lock();
  if (!lock || !model_.is_there())
    throw std::runtime_error("the model is used by another request; drag the target when it ended");
  Simulation& simulation = model_.to_search();
  const Interruptible interruptible(simulation, [this] { return live_.must_end(); });
  PolicyTask task;
  task.poses.push_back({{goal}, options_.ramp_s, {}});
  OptimiserOptions options;
  if (released) {
    simulation.reset();
  } else {
    options.max_iterations = 12;
    options.tolerance_m = 1.0e-4;
  }
  bool shown = false;
  const auto show = [&](const OptimisationProgress& progress) {
    shown = show_iterate(progress) || shown;
    if ((shown || released) && interrupted()) throw std::runtime_error("a newer target counts");
    return true;
  };
  PolicyAnswer answer = search_.go_on(simulation, task, options, show, released ? model_.reduced() : nullptr);
  answer.policy.robot = known(&KnownRobot::name);
  if (live_.must_end()) return;
  if (answer.success) remember(task, answer);
  if (released) say_what_came(task, answer);
}

// Shows at once where the robot will rest: its drives and its silicone take their time.
void ControllerNode::answer_commands() {
  const auto lock = model_.try_lock();
  if (!lock || !model_.is_there()) return;
  const Interruptible interruptible(model_.simulation(), [this] { return live_.must_end() || !ros::ok(); });
  if (!model_.follow(known(&KnownRobot::commands))) return hide_preview();
  const visualization_msgs::Marker skin = model_.skin();
  const std::lock_guard known_lock(mutex_);
  if (known_.preview.show(model_.simulation().state().commands(), model_.markers_m())) {
    publisher_.show_preview(skin);
  } else {
    publisher_.remove_preview();
  }
}

void ControllerNode::hide_preview() {
  const std::lock_guard lock(mutex_);
  known_.preview.hide();
  publisher_.remove_preview();
}

void ControllerNode::on_scene(const std_msgs::String& path) {
  try {
    load(path.data);
    ROS_INFO("models %s", path.data.c_str());
    if (services_.empty()) offer_services();
  } catch (const std::exception& error) {
    ROS_ERROR("keeps its old model: %s", log_text(error.what()).c_str());
  }
}

// Of the same scene: what was found holds on. Said again, once a reduced model is trained.
void ControllerNode::on_solver(const std_msgs::String& solver) {
  const std::lock_guard one_at_a_time(session_.mutex);
  session_.solver = solver.data;
  if (session_.path.empty()) return;
  const bool wanted = solver.data == "reduced";
  const auto no_answers = live_.pause();
  auto model_lock = model_.lock();
  if (wanted == (model_.reduced() != nullptr)) return;
  if (!wanted) return model_.leave_reduced();
  model_lock.unlock();
  try {
    Scene scene = session_.load(session_.path);
    if (!scene.reduction) return;  // newton until it is trained
    model_lock.lock();
    model_.take(std::move(scene));
  } catch (const std::exception& error) {
    ROS_ERROR("keeps its old model: %s", log_text(error.what()).c_str());
  }
}

// What a policy commands has its ghost.
void ControllerNode::on_actuators(const ActuatorState& actuators) {
  if (!is_in_limits<ActuatorState>(actuators)) return;
  execution_.add_drives(actuators);
  std::unique_lock lock(mutex_);
  const bool was_shown = known_.preview.shown();
  known_.preview.add_drives(actuators.header.stamp.toSec(), actuators.commands, actuators.actuated_commands);
  if (was_shown && !known_.preview.shown()) publisher_.remove_preview();
  const std::map<std::string, double> before = known_.commands;
  for (size_t i = 0; i < std::min(actuators.names.size(), actuators.commands.size()); ++i)
    known_.commands[actuators.names[i]] = actuators.commands[i];
  const bool asked = !before.empty() && known_.commands != before;
  lock.unlock();
  if (asked && publisher_.preview_is_watched() && !execution_.running())
    live_.ask(LiveAnswers::Kind::commands, [this](const auto&) { answer_commands(); });
}

void ControllerNode::on_markers(const MarkerObservations& markers) {
  if (!is_in_limits<MarkerObservations>(markers)) return;
  execution_.add_simulated(markers);
  std::vector<Eigen::Vector3d> positions_m;
  for (const geometry_msgs::Point& position : markers.positions)
    positions_m.emplace_back(position.x, position.y, position.z);
  const std::lock_guard lock(mutex_);
  const bool was_shown = known_.preview.shown();
  known_.preview.add_markers(positions_m);
  if (was_shown && !known_.preview.shown()) publisher_.remove_preview();
}

void ControllerNode::optimise_policy(const OptimisePolicy::Request& request, OptimisePolicy::Response& response) {
  try {
    const auto no_answers = live_.pause();
    const auto lock = model_.lock_or_refuse();
    Simulation& simulation = model_.to_search();
    const PolicyTask task = policy_task(request, options_.ramp_s);
    PolicyAnswer answer =
        behind_others([&] { return search_.find(simulation, task, optimiser_options(request), model_.reduced()); });
    answer.policy.robot = known(&KnownRobot::name);
    count_as_reached(request, answer);
    fill_response(answer, task, response);
    for (const std::string& why : answer.full_because)
      if (!why.empty()) response.message += "; newton searched, as " + why;
    for (const std::string& warning : far_targets(simulation, task))
      response.message += "; " + warning + ": a request's numbers are metres";
    if (answer.success) remember(task, answer);
  } catch (const std::exception& error) {
    response.success = false;
    response.message = answer_text(error);
  }
  if (!response.success) ROS_WARN("%s refused: %s", topics::optimise_policy, log_text(response.message).c_str());
}

bool ControllerNode::cancel(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  const bool executing = execution_.cancel(), searching = search_.cancel();
  response.success = executing || searching;
  response.message = response.success ? "" : "nothing is optimised or executed now";
  return true;
}

void ControllerNode::execute_policy(const ExecutePolicy::Request& request, ExecutePolicy::Response& response) {
  try {
    const int found_count = known(&KnownRobot::found_count);
    execute(with_policy(request), response);
    if (response.success) remove_ghost(found_count);  // the robot is there
  } catch (const ForwardModelInterrupted&) {
    response.success = false;
    response.message = "cancelled";
  } catch (const std::exception& error) {
    response.success = false;
    response.message = answer_text(error);
  }
  if (!response.success) ROS_WARN("%s refused: %s", topics::execute_policy, log_text(response.message).c_str());
}

// An empty policy stands for the one that was found last.
ExecutePolicy::Request ControllerNode::with_policy(ExecutePolicy::Request request) const {
  if (!request.policy.names.empty() || !request.policy.steps.empty()) return request;
  const std::optional<FoundPolicy> found = known(&KnownRobot::found);
  if (!found) throw std::invalid_argument("policy: empty, and none was found yet to be played");
  request.policy = to_message(found->policy);
  return request;
}

void ControllerNode::execute(const ExecutePolicy::Request& request, ExecutePolicy::Response& response) {
  ExecutionOrder order = order_of(request);
  std::shared_ptr<void> no_answers;
  ControllerModel::Lock model_lock;
  std::optional<ClosedLoop> loop;
  std::optional<Interruptible> interruptible;
  if (request.closed_loop) {
    no_answers = live_.pause();
    model_lock = model_.lock_or_refuse();
    const auto preparation = execution_.prepare();
    interruptible.emplace(model_.simulation(), [this] { return execution_.cancelled() || !ros::ok(); });
    loop.emplace(loop_of(request, order.policy));
    if (execution_.cancelled()) throw ForwardModelInterrupted();
    order.loop = &*loop;
  }
  response = execution_.execute(order);
}

ExecutionOrder ControllerNode::order_of(const ExecutePolicy::Request& request) const {
  if (execution_.running()) throw std::runtime_error("busy with another policy; ask again when it ended");
  const std::lock_guard lock(mutex_);
  ExecutionOrder order;
  order.policy = from_message(request.policy);
  require_robot(order.policy, known_.name);
  validate(order.policy, known_.limits);
  for (const std::string& name : order.policy.names) order.start_values.push_back(command_of(name));
  order.wait_until_rest = request.wait_until_rest || request.closed_loop;
  order.time_limit_s = execution_time_limit_s(request);
  return order;
}

double ControllerNode::command_of(const std::string& actuator) const {
  const auto seen = known_.commands.find(actuator);
  return seen != known_.commands.end() ? seen->second : known_.limits.at(actuator).rest;
}

PathFollowing::Robot ControllerNode::robot() const {
  const std::lock_guard lock(mutex_);
  PathFollowing::Robot robot{known_.name, {}};
  for (const auto& [name, limits] : known_.limits) robot.commands[name] = command_of(name);
  return robot;
}

// The model goes where the policy takes the robot.
ClosedLoop ControllerNode::loop_of(const ExecutePolicy::Request& request, const CommandPolicy& policy) {
  const std::optional<FoundPolicy> found = known(&KnownRobot::found);
  const PolicyTask task = correction_task(request, found ? std::optional(found->task) : std::nullopt);
  Simulation& simulation = model_.to_search();
  model_.follow(known(&KnownRobot::commands));
  model_.to_search();
  replay(simulation, policy, {});
  return ClosedLoop(simulation, task, options_.loop, model_.reduced());
}

}  // namespace

int controller_node(int argc, char** argv) {
  return run_node(argc, argv, "controller", kControllerAbout, [] {
    // One thread each for an optimisation, an execution, a scene being loaded, and the topics.
    ros::AsyncSpinner spinner(4);
    ControllerNode node;
    spinner.start();
    ros::waitForShutdown();
  });
}

}  // namespace soft_robot_lab
