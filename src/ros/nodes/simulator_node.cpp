// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include "run_node.h"
#include "simulator_options.h"
#include "hardware/plant/same_commands.h"
#include "ros/base/actuator_plugins.h"
#include "ros/base/log_text.h"
#include "ros/base/machine_time.h"
#include "ros/base/publish_limit.h"
#include "ros/base/topics.h"
#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "ros/messages/message_limits.h"
#include "ros/simulator/pulling_hand.h"
#include "ros/simulator/reduced_handover.h"
#include "ros/simulator/running_scene.h"
#include "ros/simulator/scene_announcement.h"
#include "ros/simulator/simulation_publisher.h"
#include "ros/simulator/simulator_services.h"
#include "ros/simulator/step_gate.h"
#include "ros/simulator/step_monitor.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kSimulatorAbout =
    R"(Simulates a scene in real time, or as fast as possible, behind the topics that a rig
has too.

Parameters: ~scene (path), ~solver (newton, xpbd or reduced; empty: the scene's own; a reduced model that is not kept
is trained while newton moves the robot, and then takes over; simulator/use_solver changes it), ~real_time_factor (1: real time, 0: as fast as possible), ~start_at_rest (hang under
gravity before the first step), ~surface_rate_hz (how often the skin is published while it moves; cameras need it as
often as they film), ~skin_opacity (1: opaque; 0: opaque where that hides no chamber or cable), ~publish_clock (false
beside a rig: time is then the wall's), ~rig (path: the rig that takes the same commands, which a scene has to suit),
~position_m (x, y, z in the room, of a session in a namespace), ~max_publish_rate_hz (1000: clock, markers and
actuators of at most so many steps in each second of the session, or of the wall where that is longer), ~max_pull_n
(10: pulls at the skin are cut to this force).)";

using SteadyClock = std::chrono::steady_clock;

class SimulatorNode {
 public:
  explicit SimulatorNode(const SimulatorOptions& options);
  void run();

 private:
  std::unique_ptr<RunningScene> prepare(const std::string& path, const std::string& solver) const;
  std::string settle(RunningScene& scene) const;  // returns why it is not at rest, where it should be
  void start(std::unique_ptr<RunningScene> scene);
  void run_from_now(std::unique_ptr<RunningScene> scene);  // between steps
  double step();                                           // returns the scene's time step [s]
  void serve_until(SteadyClock::time_point deadline);
  void on_command(const ActuatorCommand& command);
  void on_pull(const SkinPull& pull);
  SkinPull in_robot_base(SkinPull pull) const;
  void reset(std_srvs::Trigger::Response& response);
  void stop(std_srvs::Trigger::Response& response);
  std::string load(const std::string& path);
  std::string change_solver(const std::string& solver);
  void diagnose(NodeDiagnosis::Status& status);
  Eigen::Vector3d position_m() const { return Eigen::Vector3d::Map(options_.position_m.data()); }
  ros::Time session_time() const { return ros::Time(session_s_); }

  SimulatorOptions options_;
  SceneOptions scene_options_;

  std::atomic<int> stops_{0};  // how often a stop was asked for: a scene that is loaded gives up
  StepGate gate_;              // guards what follows between stepping, loading and requests
  std::unique_ptr<RunningScene> scene_;
  double session_s_ = 0.0;  // goes back with the machine's clock only, unlike the scene's own time at a reset
  StepMonitor monitor_;
  PublishLimit publish_limit_{options_.max_publish_rate_hz};
  ReducedHandover handover_;
  PullingHand hand_{options_.max_pull_n};

  ros::NodeHandle node_;
  SimulationPublisher publisher_{options_.surface_rate_hz, options_.publish_clock};
  SceneAnnouncement announcement_;
  std::vector<ros::Subscriber> subscribers_;
  SimulatorServices services_;  // last: its threads end first
};

SimulatorNode::SimulatorNode(const SimulatorOptions& options) : options_(options) {
  scene_options_.actuator_factory = actuators_from_plugins();
  scene_options_.interrupt = [] { return !ros::ok(); };
  scene_options_.reduced = ReducedUse::if_kept;
  announcement_.announce_frames(position_m());
  services_.serve_control([this](auto& response) { reset(response); }, [this](auto& response) { stop(response); },
                          [this](auto& status) { diagnose(status); });
  auto first = prepare(options_.scene, options_.solver);
  if (const std::string failure = settle(*first); !failure.empty()) ROS_WARN("%s", log_text(failure).c_str());
  start(std::move(first));
  subscribers_ = {node_.subscribe(topics::actuator_command, 100, &SimulatorNode::on_command, this),
                  node_.subscribe(topics::simulator_pull, 10, &SimulatorNode::on_pull, this)};
  const auto load = [this](const auto& request) {
    require_whole_path("path", request.path);
    return this->load(request.path);
  };
  services_.serve_changes(load, [this](const auto& request) { return change_solver(request.solver); });
}

std::unique_ptr<RunningScene> SimulatorNode::prepare(const std::string& path, const std::string& solver) const {
  SceneOptions options = scene_options_;
  options.method = solver;
  auto scene = load_running_scene(path, options, options_.skin_opacity);
  if (!options_.rig.empty()) require_same_commands(*scene->simulation, path, load_rig(options_.rig), options_.rig);
  return scene;
}

std::string SimulatorNode::settle(RunningScene& scene) const {
  std::string failure;
  scene.simulation->set_interrupt([this, before = stops_.load()] { return stops_ != before || !ros::ok(); });
  if (options_.start_at_rest) {
    const SolveReport report = scene.motion.solve_equilibrium();
    if (!report.converged) failure = scene.path + ": does not start at rest: " + report.message;
  }
  scene.start = scene.motion.place();
  scene.simulation->set_interrupt([this] { return gate_.step_must_end() || !ros::ok(); });
  return failure;
}

void SimulatorNode::start(std::unique_ptr<RunningScene> scene) {
  const std::string path = scene->path, solver = scene->solver();
  ActuatorRanges ranges;
  {
    const StepGate::Turn turn(gate_);  // the old scene's step may last
    ranges = actuator_ranges(*scene->simulation, session_time());
    run_from_now(std::move(scene));
    publisher_.show(*scene_->simulation, session_time());
  }
  announcement_.announce(path, ranges);
  announcement_.announce_solver(solver);
}

void SimulatorNode::run_from_now(std::unique_ptr<RunningScene> scene) {
  handover_.stop();
  scene_ = std::move(scene);
  if (scene_->untrained) handover_.train(scene_->path, scene_options_);
  hand_.forget();
}

void SimulatorNode::run() {
  constexpr auto made_up_for = std::chrono::milliseconds(100);  // longer delays are not
  auto due = SteadyClock::now();
  while (ros::ok()) {
    const double time_step_s = step();
    if (options_.real_time_factor > 0.0) {
      const std::chrono::duration<double> period(time_step_s / options_.real_time_factor);
      due += std::chrono::duration_cast<SteadyClock::duration>(period);
      due = std::max(due, SteadyClock::now() - made_up_for);
    }
    serve_until(due);
  }
}

void SimulatorNode::serve_until(SteadyClock::time_point deadline) {
  ros::CallbackQueue* queue = ros::getGlobalCallbackQueue();
  queue->callAvailable();
  while (ros::ok() && SteadyClock::now() < deadline) {
    queue->callAvailable(ros::WallDuration(std::chrono::duration<double>(deadline - SteadyClock::now()).count()));
  }
}

double SimulatorNode::step() {
  const auto lock = gate_.begin_step();
  hand_.let_go_if_silent(machine_time_s(), *scene_->simulation);
  // Who waits for a model that is trained finds it among the kept ones now.
  if (!hand_.holds() && handover_.hand_over(scene_->motion)) announcement_.announce_solver("reduced");
  const SolveReport report = hand_.holds() ? hand_.step(*scene_->simulation) : scene_->motion.step();
  if (report.interrupted && (gate_.step_must_end() || !ros::ok())) return 0.0;
  monitor_.add_step(report);
  const double time_step_s = scene_->simulation->options().time_step_s;
  session_s_ = options_.publish_clock ? session_s_ + time_step_s : ros::Time::now().toSec();
  monitor_.add_time(session_s_);
  if (publish_limit_.due(session_s_, machine_time_s())) {
    scene_->motion.show();
    publisher_.publish(*scene_->simulation, scene_->surface, session_time());
  }
  return time_step_s;
}

void SimulatorNode::on_command(const ActuatorCommand& command) {
  const auto lock = gate_.wait();
  try {
    require_in_limits<ActuatorCommand>(command);
    apply_command(command, scene_->motion);
  } catch (const std::invalid_argument& error) {
    const std::string why = log_text(error.what());
    monitor_.add_refusal(why);
    ROS_WARN_THROTTLE(1.0, "%s refused: %s", topics::actuator_command, why.c_str());
  }
}

// The room is not turned against robot_base.
SkinPull SimulatorNode::in_robot_base(SkinPull pull) const {
  const std::string& frame = pull.header.frame_id;
  if (frame == robot_frame() || frame == world_frame()) return pull;
  if (frame != room_frame)
    throw std::invalid_argument("header.frame_id: '" + frame + "' is none of " + robot_frame() + ", " + world_frame() +
                                ", " + room_frame);
  for (geometry_msgs::Point* place : {&pull.point, &pull.hand})
    *place = to_message(from_message(*place, "point") - position_m());
  return pull;
}

void SimulatorNode::on_pull(const SkinPull& pull) {
  const auto lock = gate_.wait();
  try {
    require_in_limits<SkinPull>(pull);
    scene_->motion.show();
    hand_.take(in_robot_base(pull), machine_time_s(), *scene_->simulation);
    if (hand_.holds()) scene_->motion.to_newton("a hand pulls at the skin");
  } catch (const std::invalid_argument& error) {
    ROS_WARN_THROTTLE(1.0, "%s refused: %s", topics::simulator_pull, log_text(error.what()).c_str());
  }
}

void SimulatorNode::reset(std_srvs::Trigger::Response& response) {
  const StepGate::Turn turn(gate_);
  if (!scene_) {
    response.message = "no scene runs yet";
    return;
  }
  hand_.let_go(*scene_->simulation);
  scene_->motion.go_to(scene_->start);
  response.success = true;
  response.message = "at the start of " + scene_->path;
}

// The drives stay where they are, as motors do.
void SimulatorNode::stop(std_srvs::Trigger::Response& response) {
  ++stops_;
  const StepGate::Turn turn(gate_);
  response.success = true;
  response.message = scene_ ? "the drives stay where they are" : "the scene does not wait until it rests";
  if (!scene_) return;
  hand_.let_go(*scene_->simulation);
  const DriveStates drives = scene_->motion.drives();
  for (std::size_t i = 0; i < drives.size(); ++i)
    scene_->motion.set_command(scene_->simulation->actuators()[i]->name(), drives[i].actuated_command);
}

std::string SimulatorNode::load(const std::string& path) {
  auto next = prepare(path, options_.solver);
  if (const std::string failure = settle(*next); !failure.empty()) throw std::runtime_error(failure);
  start(std::move(next));
  return "runs " + path;
}

// Of the same scene; where it was at the start holds on. The old one moves until the new one is loaded.
std::string SimulatorNode::change_solver(const std::string& solver) {
  require_solver(solver);
  std::string path, before;
  SimulationState start;
  {
    const StepGate::Turn turn(gate_);
    path = scene_->path;
    before = handover_.training().failed() ? "" : scene_->solver();
    start = scene_->start.full;
  }
  auto next = prepare(path, solver);
  next->simulation->set_interrupt([this] { return gate_.step_must_end() || !ros::ok(); });
  next->motion.go_on_from(start);
  next->start = next->motion.place();
  const std::string name = next->solver();
  if (name == before) return name + " moves the robot already";
  handover_.stop();
  const StepGate::Turn turn(gate_);
  if (hand_.holds()) hand_.let_go(*scene_->simulation);
  next->motion.go_on_from(scene_->motion.place().full);
  const bool waits = name == "reduced" && !next->motion.reduced();
  run_from_now(std::move(next));
  options_.solver = solver;
  announcement_.announce_solver(name);
  return name + (waits ? " is asked for; newton moves the robot until it can take over" : " moves the robot");
}

void SimulatorNode::diagnose(NodeDiagnosis::Status& status) {
  const auto lock = gate_.try_for(std::chrono::milliseconds(500));
  if (lock && scene_) return monitor_.diagnose(*scene_, handover_.training(), status);
  const auto lasts_s = static_cast<long>(gate_.lasts_s());
  status.summary(NodeDiagnosis::Status::WARN,
                 std::string(lock ? "loading" : "solving") + " for " + std::to_string(lasts_s) + " s; Stop ends it");
  status.add("lasts [s]", lasts_s);
}

}  // namespace

int simulator_node(int argc, char** argv) {
  return run_node(argc, argv, "simulator", kSimulatorAbout, [] {
    SimulatorNode node(read_options(ros::NodeHandle("~")));
    node.run();
  });
}

}  // namespace soft_robot_lab
