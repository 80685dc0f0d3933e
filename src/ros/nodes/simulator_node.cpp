// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <soft_robot_lab/LoadScene.h>
#include <soft_robot_lab/UseSolver.h>
#include <std_msgs/String.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "run_node.h"
#include "simulator_options.h"
#include "hardware/plant/same_commands.h"
#include "ros/base/actuator_plugins.h"
#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "ros/messages/image_messages.h"
#include "ros/base/latched_publisher.h"
#include "ros/simulator/least_determinant.h"
#include "ros/base/log_text.h"
#include "ros/messages/message_limits.h"
#include "ros/base/publish_limit.h"
#include "ros/simulator/pulling_hand.h"
#include "ros/simulator/simulation_publisher.h"
#include "ros/display/surface_marker.h"
#include "ros/base/topics.h"
#include "robot/scene/background_training.h"
#include "robot/scene/scene_motion.h"
#include "soft_robot_lab/robot/scene/scene.h"

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

double machine_time_s() { return std::chrono::duration<double>(SteadyClock::now().time_since_epoch()).count(); }

// A scene ready to run, with the state that `reset` brings back.
struct RunningScene {
  RunningScene(Scene loaded, double skin_opacity)
      : path(loaded.file),
        warnings(std::move(loaded.warnings)),
        fidelity(std::move(loaded.fidelity)),
        untrained(loaded.untrained),
        simulation(std::move(loaded.simulation)),
        motion(*simulation, std::move(loaded.reduction)),
        surface(simulation->body().mesh(), skin_opacity > 0.0 ? skin_opacity : fitting_opacity(*simulation)) {}

  std::string path;
  std::vector<SolveWarning> warnings;
  std::optional<FidelityReport> fidelity;
  bool untrained;  // its reduced model is to be trained
  std::unique_ptr<Simulation> simulation;
  SceneMotion motion;  // of the simulation, by a reduced model where there is one
  SurfaceMarker surface;
  SceneMotion::Place start;

  // What was asked for: a reduced model that is not trained yet, or was left, counts.
  std::string solver() const {
    if (untrained || motion.reduction()) return "reduced";
    return simulation->options().method == SolverOptions::Method::xpbd ? "xpbd" : "newton";
  }
};

// Asks for the end of what is solved, as long as it lives, beside others.
class Ending {
 public:
  explicit Ending(std::atomic<int>& ends) : ends_(ends) { ++ends_; }
  ~Ending() { --ends_; }
  Ending(const Ending&) = delete;
  Ending& operator=(const Ending&) = delete;

 private:
  std::atomic<int>& ends_;
};

// Wall and session time over the last second or so.
class RealTimeFactor {
 public:
  void update(double session_s) {
    const double wall_s = std::chrono::duration<double>(SteadyClock::now() - wall_start_).count();
    if (wall_s < 1.0) return;
    value_ = (session_s - session_start_s_) / wall_s;
    wall_start_ = SteadyClock::now();
    session_start_s_ = session_s;
  }
  double value() const { return value_; }

 private:
  SteadyClock::time_point wall_start_ = SteadyClock::now();
  double session_start_s_ = 0.0;
  double value_ = 0.0;
};

class SimulatorNode {
 public:
  explicit SimulatorNode(const SimulatorOptions& options);
  ~SimulatorNode() {
    loading_.stop();
    control_.stop();
  }
  void run();

 private:
  void serve();
  std::unique_ptr<RunningScene> prepare(const std::string& path, const std::string& solver) const;
  std::string settle(RunningScene& scene) const;  // returns why it is not at rest, where it should be
  void start(std::unique_ptr<RunningScene> scene);
  void run_from_now(std::unique_ptr<RunningScene> scene);  // with the mutex held
  void publish_solver(const std::string& solver);
  double step();  // returns the scene's time step [s]
  void serve_until(SteadyClock::time_point deadline);
  void on_command(const ActuatorCommand& command);
  void on_pull(const SkinPull& pull);
  SkinPull in_robot_base(SkinPull pull) const;
  bool reset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool stop(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool load(LoadScene::Request& request, LoadScene::Response& response);
  bool use_solver(UseSolver::Request& request, UseSolver::Response& response);
  std::string change_solver(const std::string& solver);
  void use_reduced();
  void diagnose_solver(diagnostic_updater::DiagnosticStatusWrapper& status) const;
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);
  void report_what_lasts(const std::string& what, diagnostic_updater::DiagnosticStatusWrapper& status) const;
  void publish_frames();
  ros::Time session_time() const { return ros::Time(session_s_); }

  SimulatorOptions options_;
  SceneOptions scene_options_;

  std::atomic<int> ends_{0};                       // a request waits for the step that is solved, which ends
  std::atomic<int> stops_{0};                      // how often a stop was asked for: a scene that is loaded gives up
  std::atomic<double> since_s_{machine_time_s()};  // what runs now, of the machine's time
  std::timed_mutex mutex_;                         // guards what follows between stepping, loading and requests
  std::unique_ptr<RunningScene> scene_;
  double session_s_ = 0.0;  // goes back with the machine's clock only, unlike the scene's own time at a reset
  SolveReport last_report_;
  int unconverged_steps_ = 0;           // since the last diagnosis
  std::vector<SolveWarning> warnings_;  // likewise
  int refused_commands_ = 0;
  std::string last_refusal_;
  RealTimeFactor real_time_factor_;
  PublishLimit publish_limit_{options_.max_publish_rate_hz};
  BackgroundTraining training_;
  double reduced_asked_s_ = 0.0;  // of the machine's time: when the reduced model was last asked to take over

  ros::NodeHandle node_;
  SimulationPublisher publisher_{options_.surface_rate_hz, options_.publish_clock};
  LatchedPublisher<std_msgs::String> scene_path_{topics::simulator_scene};
  LatchedPublisher<ActuatorRanges> ranges_{topics::simulator_ranges};
  PresentPublisher<std_msgs::String> solver_{topics::simulator_solver};
  ros::Subscriber commands_, pulls_;
  PullingHand hand_{options_.max_pull_n};
  tf2_ros::StaticTransformBroadcaster frames_;
  ros::CallbackQueue control_queue_;  // what has to be answered while a step is solved, which may last
  diagnostic_updater::Updater diagnostics_;
  ros::SteadyTimer diagnostics_timer_;
  ros::ServiceServer reset_, stop_, load_, use_solver_;
  // Loading takes seconds; meanwhile the old scene goes on.
  ros::CallbackQueue loading_queue_;
  ros::AsyncSpinner loading_{1, &loading_queue_}, control_{2, &control_queue_};  // the diagnosis waits too
};

SimulatorNode::SimulatorNode(const SimulatorOptions& options) : options_(options) {
  scene_options_.actuator_factory = actuators_from_plugins();
  scene_options_.interrupt = [] { return !ros::ok(); };
  scene_options_.reduced = ReducedUse::if_kept;
  publish_frames();
  serve();
  auto first = prepare(options_.scene, options_.solver);
  if (const std::string failure = settle(*first); !failure.empty()) ROS_WARN("%s", log_text(failure).c_str());
  start(std::move(first));
  commands_ = node_.subscribe(topics::actuator_command, 100, &SimulatorNode::on_command, this);
  pulls_ = node_.subscribe(topics::simulator_pull, 10, &SimulatorNode::on_pull, this);
  auto load_options = ros::AdvertiseServiceOptions::create<LoadScene>(
      topics::simulator_load, [this](auto& request, auto& response) { return load(request, response); },
      ros::VoidConstPtr(), &loading_queue_);
  load_ = node_.advertiseService(load_options);
  auto solver_options = ros::AdvertiseServiceOptions::create<UseSolver>(
      topics::simulator_use_solver, [this](auto& request, auto& response) { return use_solver(request, response); },
      ros::VoidConstPtr(), &loading_queue_);
  use_solver_ = node_.advertiseService(solver_options);
  loading_.start();
}

void SimulatorNode::serve() {
  const auto trigger = [this](const std::string& name, auto handler) {
    auto options = ros::AdvertiseServiceOptions::create<std_srvs::Trigger>(
        name, [this, handler](auto& request, auto& response) { return (this->*handler)(request, response); },
        ros::VoidConstPtr(), &control_queue_);
    return node_.advertiseService(options);
  };
  reset_ = trigger(topics::simulator_reset, &SimulatorNode::reset);
  stop_ = trigger(topics::simulator_stop, &SimulatorNode::stop);
  diagnostics_.setHardwareID("simulated");
  diagnostics_.add("simulation", this, &SimulatorNode::diagnose);
  ros::SteadyTimerOptions every_second(
      ros::WallDuration(1.0), [this](const auto&) { diagnostics_.force_update(); }, &control_queue_);
  diagnostics_timer_ = node_.createSteadyTimer(every_second);
  control_.start();
}

void SimulatorNode::publish_frames() {
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  std::vector<geometry_msgs::TransformStamped> frames = {transform_message(world_frame(), robot_frame(), here)};
  const Eigen::Vector3d position_m = Eigen::Vector3d::Map(options_.position_m.data());
  if (world_frame() != room_frame) {
    frames.push_back(transform_message(room_frame, world_frame(), Eigen::Translation3d(position_m) * here));
  } else if (!position_m.isZero(0.0)) {
    throw std::invalid_argument("position_m: must be zero in a session that has no namespace");
  }
  frames_.sendTransform(frames);
}

std::unique_ptr<RunningScene> SimulatorNode::prepare(const std::string& path, const std::string& solver) const {
  std::set<std::string> said;
  SceneOptions scene_options = scene_options_;
  scene_options.method = solver;
  scene_options.on_warnings = [&](const std::vector<SolveWarning>& warnings) {
    for (const SolveWarning& warning : warnings)
      if (said.insert(warning.text).second) ROS_WARN("%s: %s", path.c_str(), log_text(warning.text).c_str());
  };
  auto scene = std::make_unique<RunningScene>(load_scene(path, scene_options), options_.skin_opacity);
  if (!options_.rig.empty()) require_same_commands(*scene->simulation, path, load_rig(options_.rig), options_.rig);
  const TetMesh& mesh = scene->simulation->body().mesh();
  ROS_INFO("%s: %d elements, %d nodes", path.c_str(), mesh.tet_count(), mesh.node_count());
  scene_options.on_warnings(scene->warnings);
  if (scene->fidelity) {
    ROS_INFO("%s: %s", path.c_str(), summary(*scene->fidelity).c_str());
    if (!scene->fidelity->met)
      ROS_WARN("%s: expected error of the markers: %s", path.c_str(), expected_error_text(*scene->fidelity).c_str());
  }
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
  scene.simulation->set_interrupt([this] { return ends_ || !ros::ok(); });
  return failure;
}

void SimulatorNode::start(std::unique_ptr<RunningScene> scene) {
  std_msgs::String path;
  path.data = scene->path;
  const std::string solver = scene->solver();
  ActuatorRanges ranges;
  {
    const std::lock_guard lock(mutex_);
    ranges = actuator_ranges(*scene->simulation, session_time());
    run_from_now(std::move(scene));
    publisher_.show(*scene_->simulation, session_time());
  }
  scene_path_.publish(path);
  ranges_.publish(ranges);
  publish_solver(solver);
}

void SimulatorNode::run_from_now(std::unique_ptr<RunningScene> scene) {
  training_.stop();
  scene_ = std::move(scene);
  if (scene_->untrained) {
    SceneOptions trained = scene_options_;
    trained.method = "reduced";
    training_.start(scene_->path, trained);
  }
  hand_.forget();
}

void SimulatorNode::publish_solver(const std::string& solver) {
  std_msgs::String message;
  message.data = solver;
  solver_.publish(message);
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
  while (ends_) std::this_thread::sleep_for(std::chrono::milliseconds(1));  // a request comes first
  const std::lock_guard lock(mutex_);
  since_s_ = machine_time_s();
  hand_.let_go_if_silent(machine_time_s(), *scene_->simulation);
  use_reduced();
  last_report_ = hand_.holds() ? hand_.step(*scene_->simulation) : scene_->motion.step();
  if (last_report_.interrupted && (ends_ || !ros::ok())) return 0.0;
  if (!last_report_.converged) ++unconverged_steps_;
  for (const SolveWarning& warning : last_report_.warnings) add_warning(warning, warnings_);
  const double time_step_s = scene_->simulation->options().time_step_s;
  session_s_ = options_.publish_clock ? session_s_ + time_step_s : ros::Time::now().toSec();
  real_time_factor_.update(session_s_);
  if (publish_limit_.due(session_s_, machine_time_s())) {
    scene_->motion.show();
    publisher_.publish(*scene_->simulation, scene_->surface, session_time());
  }
  return time_step_s;
}

// Once it is trained, or knows the state again that it had left.
void SimulatorNode::use_reduced() {
  constexpr double every_s = 0.5;
  if (hand_.holds() || scene_->motion.reduced() || machine_time_s() < reduced_asked_s_ + every_s) return;
  reduced_asked_s_ = machine_time_s();
  std::shared_ptr<const SceneReduction> trained = training_.take();
  if (!trained) {
    scene_->motion.to_reduced();
    return;
  }
  scene_->motion.to_reduced(std::move(trained));
  publish_solver("reduced");  // who waits for it finds it among the kept ones now
}

void SimulatorNode::on_command(const ActuatorCommand& command) {
  const std::lock_guard lock(mutex_);
  try {
    require_in_limits<ActuatorCommand>(command);
    apply_command(command, scene_->motion);
  } catch (const std::invalid_argument& error) {
    ++refused_commands_;
    last_refusal_ = log_text(error.what());
    ROS_WARN_THROTTLE(1.0, "%s refused: %s", topics::actuator_command, last_refusal_.c_str());
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
    *place = to_message(from_message(*place, "point") - Eigen::Vector3d::Map(options_.position_m.data()));
  return pull;
}

void SimulatorNode::on_pull(const SkinPull& pull) {
  const std::lock_guard lock(mutex_);
  try {
    require_in_limits<SkinPull>(pull);
    scene_->motion.show();
    hand_.take(in_robot_base(pull), machine_time_s(), *scene_->simulation);
    if (hand_.holds()) scene_->motion.to_newton("a hand pulls at the skin");
  } catch (const std::invalid_argument& error) {
    ROS_WARN_THROTTLE(1.0, "%s refused: %s", topics::simulator_pull, log_text(error.what()).c_str());
  }
}

bool SimulatorNode::reset(std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response) {
  const Ending ending(ends_);
  const std::lock_guard lock(mutex_);
  if (!scene_) {
    response.message = "no scene runs yet";
    return true;
  }
  hand_.let_go(*scene_->simulation);
  scene_->motion.go_to(scene_->start);
  response.success = true;
  response.message = "at the start of " + scene_->path;
  return true;
}

// The drives stay where they are, as motors do.
bool SimulatorNode::stop(std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response) {
  ++stops_;
  const Ending ending(ends_);
  const std::lock_guard lock(mutex_);
  response.success = true;
  response.message = scene_ ? "the drives stay where they are" : "the scene does not wait until it rests";
  if (!scene_) return true;
  hand_.let_go(*scene_->simulation);
  const DriveStates drives = scene_->motion.drives();
  for (std::size_t i = 0; i < drives.size(); ++i)
    scene_->motion.set_command(scene_->simulation->actuators()[i]->name(), drives[i].actuated_command);
  return true;
}

bool SimulatorNode::load(LoadScene::Request& request, LoadScene::Response& response) {
  try {
    auto next = prepare(request.path, options_.solver);
    if (const std::string failure = settle(*next); !failure.empty()) throw std::runtime_error(failure);
    start(std::move(next));
    response.success = true;
    response.message = "runs " + request.path;
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
    ROS_WARN("%s refused: %s", topics::simulator_load, log_text(error.what()).c_str());
  }
  return true;
}

// Of the same scene; where it was at the start holds on. The old one moves until the new one is loaded.
std::string SimulatorNode::change_solver(const std::string& solver) {
  std::string path, before;
  SimulationState start;
  {
    const std::lock_guard lock(mutex_);
    path = scene_->path;
    before = training_.failed() ? "" : scene_->solver();
    start = scene_->start.full;
  }
  auto next = prepare(path, solver);
  next->simulation->set_interrupt([this] { return ends_ || !ros::ok(); });
  next->motion.go_on_from(start);
  next->start = next->motion.place();
  const std::string name = next->solver();
  if (name == before) return name + " moves the robot already";
  training_.stop();
  const Ending ending(ends_);
  const std::lock_guard lock(mutex_);
  if (hand_.holds()) hand_.let_go(*scene_->simulation);
  next->motion.go_on_from(scene_->motion.place().full);
  const bool waits = name == "reduced" && !next->motion.reduced();
  run_from_now(std::move(next));
  options_.solver = solver;
  publish_solver(name);
  return name + (waits ? " is asked for; newton moves the robot until it can take over" : " moves the robot");
}

bool SimulatorNode::use_solver(UseSolver::Request& request, UseSolver::Response& response) {
  try {
    require_solver(request.solver);
    response.message = change_solver(request.solver);
    response.success = true;
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
    ROS_WARN("%s refused: %s", topics::simulator_use_solver, log_text(error.what()).c_str());
  }
  return true;
}

void SimulatorNode::report_what_lasts(const std::string& what,
                                      diagnostic_updater::DiagnosticStatusWrapper& status) const {
  const auto lasts_s = static_cast<long>(machine_time_s() - since_s_);
  status.summary(diagnostic_msgs::DiagnosticStatus::WARN,
                 what + " for " + std::to_string(lasts_s) + " s; Stop ends it");
  status.add("lasts [s]", lasts_s);
}

void SimulatorNode::diagnose_solver(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  const SceneMotion& motion = scene_->motion;
  const bool xpbd = scene_->simulation->options().method == SolverOptions::Method::xpbd;
  status.add("solver", motion.reduced() ? "reduced" : xpbd ? "xpbd" : "newton");
  const std::string training = training_.status();
  if (!training.empty()) status.add("reduced model", training);
  if (!motion.reduction()) return;
  status.add("modes", motion.reduction()->choice.model->energy.modes());
  status.add("audited error [m]", motion.audits().largest_estimate_m);
  status.add("trusted error [m]", motion.audits().limit_m);
}

void SimulatorNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const std::unique_lock lock(mutex_, std::chrono::milliseconds(500));
  if (!lock || !scene_) return report_what_lasts(lock ? "loading" : "solving", status);
  using Status = diagnostic_msgs::DiagnosticStatus;
  for (const SolveWarning& warning : scene_->simulation->unmodelled_contact()) add_warning(warning, warnings_);
  if (unconverged_steps_ > 0) {
    status.summary(Status::WARN, "steps that did not converge: " + last_report_.message);
  } else if (!warnings_.empty()) {
    status.summary(Status::WARN, warnings_.front().text);
  } else if (training_.failed()) {
    status.summary(Status::WARN, training_.status());
  } else {
    status.summary(Status::OK, "runs");
  }
  status.add("scene", scene_->path);
  status.add("elements", scene_->simulation->body().mesh().tet_count());
  status.add("nodes", scene_->simulation->body().mesh().node_count());
  status.add("expected error", scene_->fidelity ? expected_error_text(*scene_->fidelity) : "not asked for");
  status.add("fidelity", scene_->fidelity ? sentence(*scene_->fidelity) : "not asked for");
  status.add("steps not converged in the last second", unconverged_steps_);
  diagnose_solver(status);
  status.add("iterations", last_report_.iterations);
  status.add("residual", last_report_.residual);
  status.add("inverted elements", last_report_.inverted_elements);
  status.add("least det F",
             least_determinant(scene_->simulation->body().mesh(), scene_->simulation->state().positions_m));
  const std::vector<ContactReading> contacts = scene_->simulation->contacts();
  double contact_n = 0.0;
  for (const ContactReading& contact : contacts) contact_n += contact.normal_force_n;
  if (!contacts.empty()) status.add("contact force [N]", contact_n);
  for (const SolveWarning& warning : warnings_)
    status.add(warning.kind + (warning.actuator.empty() ? "" : " " + warning.actuator), warning.text);
  status.add("real-time factor", real_time_factor_.value());
  status.add("refused commands", refused_commands_);
  status.add("last refusal", last_refusal_);
  unconverged_steps_ = 0;
  warnings_.clear();
}

}  // namespace

int simulator_node(int argc, char** argv) {
  return run_node(argc, argv, "simulator", kSimulatorAbout, [] {
    SimulatorNode node(read_options(ros::NodeHandle("~")));
    node.run();
  });
}

}  // namespace soft_robot_lab
