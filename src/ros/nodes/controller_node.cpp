// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
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
#include "ros/base/behind_others.h"
#include "ros/base/actuator_plugins.h"
#include "ros/controller/controller_actions.h"
#include "ros/messages/conversions.h"
#include "ros/messages/message_limits.h"
#include "ros/controller/policy_execution.h"
#include "ros/controller/fit_service.h"
#include "ros/controller/interruptible.h"
#include "ros/base/latched_publisher.h"
#include "ros/base/log_text.h"
#include "ros/controller/policy_request.h"
#include "ros/controller/policy_search.h"
#include "ros/messages/same_fields.h"
#include "ros/display/surface_marker.h"
#include "ros/display/target_marker.h"
#include "ros/base/topics.h"
#include "robot/scene/reduction.h"
#include "robot/scene/scene_motion.h"
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

ClosedLoopOptions read_loop_options() {
  ClosedLoopOptions options;
  read_parameter(ros::NodeHandle("~"), "lost_after_s", options.lost_after_s);
  options.validate();
  return options;
}

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
  Scene load_model(const std::string& path);
  void take_model(Scene scene);  // with the model's mutex held
  const ReducedChoice* reduced() const { return motion_->reduction() ? &motion_->reduction()->choice : nullptr; }
  std::string robot() const;
  void offer_services();  // once there is a model to answer with
  void on_scene(const std_msgs::String& path);
  void on_solver(const std_msgs::String& solver);
  void on_actuators(const ActuatorState& actuators);
  void send(const std::vector<std::string>& names, const std::vector<double>& values) const;
  void on_markers(const MarkerObservations& markers);
  void on_target(const std::string& marker, const Eigen::Vector3d& target_m, bool released);
  void answer_target(const MarkerGoal& goal, bool released, const std::function<bool()>& interrupted);
  void say_what_came(const PolicyTask& task, const PolicyAnswer& answer) const;
  void say_why_not(const std::string& why) const;
  void on_target_shown(const Target& target);
  void answer_commands();
  bool model_follows(const std::map<std::string, double>& commands);  // false where it finds no rest state there
  void hide_preview();
  void remember(const PolicyTask& task, const PolicyAnswer& answer);
  bool show_iterate(const OptimisationProgress& progress);
  void show_ghost();  // of the model as it is
  void remove_ghost(int found_count);
  void show_target(const std::string& marker, const Eigen::Vector3d& target_m);
  void optimise_policy(const OptimisePolicy::Request& request, OptimisePolicy::Response& response);
  void execute_policy(const ExecutePolicy::Request& request, ExecutePolicy::Response& response);
  ControllerHandlers handlers();
  void execute(const ExecutePolicy::Request& request, ExecutePolicy::Response& response);
  ExecutionOrder order_of(const ExecutePolicy::Request& request) const;
  ExecutePolicy::Request with_policy(ExecutePolicy::Request request) const;
  ClosedLoop loop_of(const ExecutePolicy::Request& request, const CommandPolicy& policy);
  bool cancel(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  SceneOptions scene_options_;
  double ramp_s_ = 2.0;

  std::mutex load_mutex_;      // held while a model is loaded; before the others
  std::string path_, solver_;  // of the session, empty: not known; guarded by it

  std::mutex model_mutex_;  // held while the model computes
  std::unique_ptr<Simulation> model_;
  std::optional<SceneMotion> motion_;             // of the model, for rest states that the robot is followed to
  std::unique_ptr<SurfaceMarker> ghost_surface_;  // of the model
  bool model_searched_ = false;                   // it was elsewhere than the robot since it last followed it

  mutable std::mutex mutex_;  // guards what follows; held briefly
  CommandLimitsByName limits_;
  std::string robot_;                       // whose model it is
  std::vector<std::string> markers_;        // its names
  double size_m_ = 0.0;                     // of its body at rest, along one axis
  std::map<std::string, double> commands_;  // as the actuators last said, whoever sent them
  std::optional<PolicyTask> found_;         // the last task that a policy was found for
  CommandPolicy found_policy_;              // and that policy
  std::atomic<int> found_count_{0};         // of policies, so far
  std::atomic<bool> cancelled_{false};      // since an execution began
  std::atomic<bool> preparing_{false};      // an execution: its model goes where the policy leads
  Preview preview_;

  const ClosedLoopOptions loop_options_ = read_loop_options();
  PolicyExecution execution_{loop_options_, [this](const auto& names, const auto& values) { send(names, values); }};

  ros::NodeHandle node_;
  PolicySearch search_{node_, [this](const MarkerGoal& goal) { show_target(goal.marker, goal.target_m); }};
  ros::Publisher command_publisher_, target_answers_;
  PresentPublisher<visualization_msgs::Marker> ghost_{topics::controller_ghost};
  PresentPublisher<visualization_msgs::Marker> shown_preview_{topics::controller_preview};
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  std::unique_ptr<FitService> fit_service_;
  LiveAnswers live_;
  TargetMarker target_{node_, [this](const auto&... moved) { on_target(moved...); }};
  std::unique_ptr<ControllerActions> actions_;  // last: its threads end first
};

ControllerNode::ControllerNode() {
  scene_options_.actuator_factory = actuators_from_plugins();
  scene_options_.reduced = ReducedUse::if_kept;
  scene_options_.interrupt = [] { return !ros::ok(); };
  const ros::NodeHandle parameters("~");
  read_parameter(parameters, "ramp_s", ramp_s_);
  require_in_range("ramp_s", ramp_s_, {0.0, 3600.0});
  std::string scene;
  if (read_parameter(parameters, "scene", scene)) load(scene);

  target_answers_ = node_.advertise<OptimisePolicyResult>(topics::target_answer, 10);
  command_publisher_ = node_.advertise<ActuatorCommand>(topics::actuator_command, 100);
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
  fit_service_ = std::make_unique<FitService>(node_, scene_options_, scene);
  if (model_) offer_services();
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
  const std::lock_guard one_at_a_time(load_mutex_);
  Scene scene = load_model(path);
  path_ = path;
  CommandLimitsByName limits = limits_of(*scene.simulation);
  const auto no_answers = live_.pause();
  const std::lock_guard model_lock(model_mutex_);
  take_model(std::move(scene));
  {
    const std::lock_guard lock(mutex_);
    limits_ = std::move(limits);
    robot_ = name_of_robot(path);
    markers_.clear();
    for (const Marker& marker : model_->markers()) markers_.push_back(marker.name());
    size_m_ = largest_extent_m(model_->body().mesh());
    commands_.clear();
    found_.reset();
    found_policy_ = {};
    preview_ = {};
  }
  ghost_.publish(no_ghost());
  shown_preview_.publish(no_preview());
  search_.forget_target();
  const std::vector<Marker>& markers = model_->markers();
  if (markers.empty()) return;
  const auto tip = std::find_if(markers.begin(), markers.end(), [](const auto& one) { return one.name() == "tip"; });
  const auto shown =
      static_cast<int>(tip != markers.end() ? tip - markers.begin() : markers.end() - markers.begin() - 1);
  show_target(markers[static_cast<size_t>(shown)].name(), model_->marker_position(shown));
}

// With its reduced model where one is kept, unless the session chose another solver.
Scene ControllerNode::load_model(const std::string& path) {
  SceneOptions options = scene_options_;
  if (solver_ == "reduced") options.method = solver_;
  Scene scene = load_scene(path, options);
  if (!solver_.empty() && solver_ != "reduced") scene.reduction.reset();
  return scene;
}

void ControllerNode::take_model(Scene scene) {
  motion_.reset();
  model_ = std::move(scene.simulation);
  motion_.emplace(*model_, std::move(scene.reduction));
  ghost_surface_ = std::make_unique<SurfaceMarker>(model_->body().mesh());
  model_searched_ = true;
}

std::string ControllerNode::robot() const {
  const std::lock_guard lock(mutex_);
  return robot_;
}

void ControllerNode::show_target(const std::string& marker, const Eigen::Vector3d& target_m) {
  std::unique_lock lock(mutex_);
  const double size_m = size_m_;
  lock.unlock();
  constexpr double least_m = 0.028;  // with a ball that the overlay's does not hide
  target_.show(marker, target_m, std::max(0.25 * size_m, least_m));
}

// As the panel does where another marker is chosen, or a number typed.
void ControllerNode::on_target_shown(const Target& target) {
  std::unique_lock lock(mutex_);
  const bool known = std::find(markers_.begin(), markers_.end(), target.marker) != markers_.end();
  lock.unlock();
  try {
    require_in_limits<Target>(target);
    const Eigen::Vector3d position_m = from_message(target.position, "position");
    if (!known) throw std::invalid_argument("marker: the scene has no '" + target.marker + "'");
    show_target(target.marker, position_m);
  } catch (const std::exception& error) {
    ROS_WARN_THROTTLE(1.0, "%s refused: %s", topics::target_shown, log_text(error.what()).c_str());
  }
}

void ControllerNode::show_ghost() {
  ghost_.publish(ghost_of(ghost_surface_->message(model_->state().positions_m, ros::Time::now())));
}

void ControllerNode::remember(const PolicyTask& task, const PolicyAnswer& answer) {
  const std::lock_guard lock(mutex_);
  const bool played = answer.summaries.back().stop_reason != "cancelled";  // so the model is there
  if (played) show_ghost();
  if (!played) ghost_.publish(no_ghost());
  found_ = task;
  found_policy_ = answer.policy;
  ++found_count_;
}

// Not where another was found since: its ghost stays.
void ControllerNode::remove_ghost(int found_count) {
  const std::lock_guard lock(mutex_);
  if (found_count == found_count_) ghost_.publish(no_ghost());
}

// Where the model is at these commands, and not at those of a step that led nowhere.
bool ControllerNode::show_iterate(const OptimisationProgress& progress) {
  const std::vector<double> commands = model_->state().commands();  // of all actuators: all may move
  if (!std::equal(commands.begin(), commands.end(), progress.commands.begin(), progress.commands.end())) return false;
  show_ghost();
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
  target_answers_.publish(result);
}

void ControllerNode::say_what_came(const PolicyTask& task, const PolicyAnswer& answer) const {
  OptimisePolicy::Response response;
  PolicyAnswer counted = answer;
  count_as_reached(counted);
  fill_response(counted, task, response);
  for (const std::string& warning : far_targets(*model_, task)) response.message += "; " + warning;
  target_answers_.publish(same_fields<OptimisePolicyResult>(response));
}

// While the target is dragged, from where the model is; where it is let go, as the service does it. The ghost follows
// after each iteration, and a newer target ends the search there: to replay what was found so far would cost as much.
void ControllerNode::answer_target(const MarkerGoal& goal, bool released, const std::function<bool()>& interrupted) {
  const std::unique_lock lock(model_mutex_, std::try_to_lock);
  if (!lock || !model_) throw std::runtime_error("the model is used by another request; drag the target when it ended");
  model_searched_ = true;
  const Interruptible interruptible(*model_, [this] { return live_.must_end(); });
  PolicyTask task;
  task.poses.push_back({{goal}, ramp_s_, {}});
  OptimiserOptions options;
  if (released) {
    model_->reset();
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
  PolicyAnswer answer = search_.go_on(*model_, task, options, show, released ? reduced() : nullptr);
  answer.policy.robot = robot();
  if (live_.must_end()) return;
  if (answer.success) remember(task, answer);
  if (released) say_what_came(task, answer);
}

// Shows at once where the robot will rest: its drives and its silicone take their time.
void ControllerNode::answer_commands() {
  const std::unique_lock lock(model_mutex_, std::try_to_lock);
  if (!lock || !model_) return;
  const Interruptible interruptible(*model_, [this] { return live_.must_end() || !ros::ok(); });
  std::unique_lock state_lock(mutex_);
  const std::map<std::string, double> commands = commands_;
  state_lock.unlock();
  if (!model_follows(commands)) return hide_preview();
  std::vector<Eigen::Vector3d> markers_m;
  for (int i = 0; i < static_cast<int>(model_->markers().size()); ++i) markers_m.push_back(model_->marker_position(i));
  const visualization_msgs::Marker skin =
      preview_of(ghost_surface_->message(model_->state().positions_m, ros::Time::now()));
  state_lock.lock();
  shown_preview_.publish(preview_.show(model_->state().commands(), markers_m) ? skin : no_preview());
}

// After a search by way of the rest shape, else from where it followed the robot before.
bool ControllerNode::model_follows(const std::map<std::string, double>& commands) {
  if (model_searched_) motion_->reset();
  model_searched_ = false;
  motion_->to_reduced();
  for (const auto& [name, value] : commands) motion_->set_command(name, value);
  const bool found = motion_->solve_equilibrium().converged;
  motion_->show();
  return found;
}

void ControllerNode::hide_preview() {
  const std::lock_guard lock(mutex_);
  preview_.hide();
  shown_preview_.publish(no_preview());
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
  const std::lock_guard one_at_a_time(load_mutex_);
  solver_ = solver.data;
  if (path_.empty()) return;
  const bool wanted = solver_ == "reduced";
  const auto no_answers = live_.pause();
  std::unique_lock model_lock(model_mutex_);
  if (wanted == (reduced() != nullptr)) return;
  if (!wanted) {
    motion_.emplace(*model_, nullptr);
    model_searched_ = true;
    return;
  }
  model_lock.unlock();
  try {
    Scene scene = load_model(path_);
    if (!scene.reduction) return;  // newton until it is trained
    model_lock.lock();
    take_model(std::move(scene));
  } catch (const std::exception& error) {
    ROS_ERROR("keeps its old model: %s", log_text(error.what()).c_str());
  }
}

// What a policy commands has its ghost.
void ControllerNode::on_actuators(const ActuatorState& actuators) {
  if (!is_in_limits<ActuatorState>(actuators)) return;
  execution_.add_drives(actuators);
  std::unique_lock lock(mutex_);
  const bool was_shown = preview_.shown();
  preview_.add_drives(actuators.header.stamp.toSec(), actuators.commands, actuators.actuated_commands);
  if (was_shown && !preview_.shown()) shown_preview_.publish(no_preview());
  const std::map<std::string, double> before = commands_;
  for (size_t i = 0; i < std::min(actuators.names.size(), actuators.commands.size()); ++i)
    commands_[actuators.names[i]] = actuators.commands[i];
  const bool asked = !before.empty() && commands_ != before;
  lock.unlock();
  if (asked && shown_preview_.has_subscribers() && !execution_.running())
    live_.ask(LiveAnswers::Kind::commands, [this](const auto&) { answer_commands(); });
}

void ControllerNode::on_markers(const MarkerObservations& markers) {
  if (!is_in_limits<MarkerObservations>(markers)) return;
  execution_.add_simulated(markers);
  std::vector<Eigen::Vector3d> positions_m;
  for (const geometry_msgs::Point& position : markers.positions)
    positions_m.emplace_back(position.x, position.y, position.z);
  const std::lock_guard lock(mutex_);
  const bool was_shown = preview_.shown();
  preview_.add_markers(positions_m);
  if (was_shown && !preview_.shown()) shown_preview_.publish(no_preview());
}

void ControllerNode::optimise_policy(const OptimisePolicy::Request& request, OptimisePolicy::Response& response) {
  try {
    const auto no_answers = live_.pause();
    const std::unique_lock lock(model_mutex_, std::try_to_lock);
    if (!lock) throw std::runtime_error("busy: the model is used by another request; ask again when that ended");
    model_searched_ = true;
    const PolicyTask task = policy_task(request, ramp_s_);
    PolicyAnswer answer =
        behind_others([&] { return search_.find(*model_, task, optimiser_options(request), reduced()); });
    answer.policy.robot = robot();
    count_as_reached(request, answer);
    fill_response(answer, task, response);
    for (const std::string& why : answer.full_because)
      if (!why.empty()) response.message += "; newton searched, as " + why;
    for (const std::string& warning : far_targets(*model_, task))
      response.message += "; " + warning + ": a request's numbers are metres";
    if (answer.success) remember(task, answer);
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
  }
  if (!response.success) ROS_WARN("%s refused: %s", topics::optimise_policy, log_text(response.message).c_str());
}

bool ControllerNode::cancel(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  cancelled_ = true;
  const bool executing = execution_.cancel(), searching = search_.cancel();
  response.success = executing || searching || preparing_;
  response.message = response.success ? "" : "nothing is optimised or executed now";
  return true;
}

void ControllerNode::execute_policy(const ExecutePolicy::Request& request, ExecutePolicy::Response& response) {
  try {
    const int found_count = found_count_;
    execute(with_policy(request), response);
    if (response.success) remove_ghost(found_count);  // the robot is there
  } catch (const ForwardModelInterrupted&) {
    response.success = false;
    response.message = "cancelled";
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
  }
  if (!response.success) ROS_WARN("%s refused: %s", topics::execute_policy, log_text(response.message).c_str());
}

// An empty policy stands for the one that was found last.
ExecutePolicy::Request ControllerNode::with_policy(ExecutePolicy::Request request) const {
  if (!request.policy.names.empty() || !request.policy.steps.empty()) return request;
  const std::lock_guard lock(mutex_);
  if (found_policy_.names.empty()) throw std::invalid_argument("policy: empty, and none was found yet to be played");
  request.policy = to_message(found_policy_);
  return request;
}

void ControllerNode::execute(const ExecutePolicy::Request& request, ExecutePolicy::Response& response) {
  ExecutionOrder order = order_of(request);
  std::shared_ptr<void> no_answers;
  std::unique_lock model_lock(model_mutex_, std::defer_lock);
  std::optional<ClosedLoop> loop;
  std::optional<Interruptible> interruptible;
  if (request.closed_loop) {
    no_answers = live_.pause();
    if (!model_lock.try_lock())
      throw std::runtime_error("busy: the model is used by another request; ask again when that ended");
    preparing_ = true;
    cancelled_ = false;
    const std::shared_ptr<void> prepared(nullptr, [this](void*) { preparing_ = false; });
    interruptible.emplace(*model_, [this] { return cancelled_ || !ros::ok(); });
    loop.emplace(loop_of(request, order.policy));
    if (cancelled_) throw ForwardModelInterrupted();
    order.loop = &*loop;
  }
  response = execution_.execute(order);
}

ExecutionOrder ControllerNode::order_of(const ExecutePolicy::Request& request) const {
  if (execution_.running()) throw std::runtime_error("busy with another policy; ask again when it ended");
  const std::lock_guard lock(mutex_);
  ExecutionOrder order;
  order.policy = from_message(request.policy);
  require_robot(order.policy, robot_);
  validate(order.policy, limits_);
  for (const std::string& name : order.policy.names) {
    const auto seen = commands_.find(name);
    order.start_values.push_back(seen != commands_.end() ? seen->second : limits_.at(name).rest);
  }
  order.wait_until_rest = request.wait_until_rest || request.closed_loop;
  order.time_limit_s = execution_time_limit_s(request);
  return order;
}

// The model goes where the policy takes the robot.
ClosedLoop ControllerNode::loop_of(const ExecutePolicy::Request& request, const CommandPolicy& policy) {
  std::unique_lock lock(mutex_);
  const PolicyTask task = correction_task(request, found_);
  const std::map<std::string, double> commands = commands_;
  lock.unlock();
  model_searched_ = true;
  model_follows(commands);
  model_searched_ = true;
  replay(*model_, policy, {});
  return ClosedLoop(*model_, task, loop_options_, reduced());
}

void ControllerNode::send(const std::vector<std::string>& names, const std::vector<double>& values) const {
  ActuatorCommand command;
  command.header.stamp = ros::Time::now();
  command.names = names;
  command.values = values;
  command_publisher_.publish(command);
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
