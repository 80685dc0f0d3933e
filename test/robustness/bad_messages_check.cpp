// SPDX-License-Identifier: BSD-3-Clause
// bad_messages_check [PART]: hands bad and extreme messages to the parts behind our nodes, of which PART takes every
// PART-th only, and counts how each ended: taken, or refused with a reason. Status 1 where one ended as none may.
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <opencv2/core.hpp>
#include <ros/serialization.h>
#include <std_msgs/Float64.h>

#include "control/cabled_bar.h"
#include "bad_bytes.h"
#include "guarded.h"
#include "soft_robot_lab/control/closed_loop.h"
#include "ros/messages/conversions.h"
#include "ros/controller/fit_service.h"
#include "ros/messages/frames.h"
#include "ros/tracking/gap_meter.h"
#include "ros/messages/image_messages.h"
#include "ros/messages/marker_frames.h"
#include "ros/display/overlay.h"
#include "ros/controller/policy_execution.h"
#include "ros/controller/policy_request.h"
#include "ros/recording/recorded_session.h"
#include "ros/cameras/seen_robot.h"
#include "ros/base/topics.h"
#include "session/measured_rest.h"
#include "session/rest_detector.h"
#include "session/rest_periods.h"

namespace soft_robot_lab {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <typename Message>
Bytes bytes_of(const Message& message) {
  Bytes bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

// As long as it lives, this process may take 1 GB at most.
class LittleMemory {
 public:
  LittleMemory() {
    getrlimit(RLIMIT_AS, &before_);
    const rlimit little{1'000'000'000, before_.rlim_max};
    setrlimit(RLIMIT_AS, &little);
  }
  ~LittleMemory() { setrlimit(RLIMIT_AS, &before_); }
  LittleMemory(const LittleMemory&) = delete;
  LittleMemory& operator=(const LittleMemory&) = delete;

 private:
  rlimit before_{};
};

// As roscpp reads it before any of our code has it; what it cannot read is its own to refuse. It takes the memory that
// a list's length asks for before it looks how much was sent, which with 8 GB takes longer than a case may.
template <typename Message>
Message message_of(const Bytes& bytes) {
  Message message;
  Bytes copy = bytes;
  try {
    const LittleMemory reading;
    ros::serialization::IStream stream(copy.data(), static_cast<std::uint32_t>(copy.size()));
    ros::serialization::deserialize(stream, message);
  } catch (const std::exception&) {
    throw std::runtime_error("roscpp cannot read it");
  }
  return message;
}

struct Feed {
  std::string name;
  Bytes good;
  std::function<void(const Bytes&)> take;
};

template <typename Message>
Feed feed(const std::string& name, const Message& good, std::function<void(const Message&)> take) {
  return {name, bytes_of(good), [take](const Bytes& bytes) { take(message_of<Message>(bytes)); }};
}

void require_finite(double value, const char* what) {
  if (!std::isfinite(value)) throw Nonsense(std::string(what) + " is not finite");
}

void require_finite(const geometry_msgs::Point& point, const char* what) {
  for (const double x : {point.x, point.y, point.z}) require_finite(x, what);
}

MarkerObservations two_markers(double time_s) {
  MarkerObservations markers;
  markers.header.stamp = ros::Time(time_s);
  markers.header.frame_id = robot_frame();
  markers.names = {"middle", "tip"};
  markers.positions.resize(2);
  markers.positions[0].x = 0.05;
  markers.positions[1].x = 0.1;
  markers.covariances.assign(18, 1e-8);
  markers.sources = {MarkerObservations::SEEN, MarkerObservations::SEEN};
  return markers;
}

Simulation& model() {
  static Simulation simulation = bar();
  simulation.reset();
  return simulation;
}

void take_command(const ActuatorCommand& command) {
  Simulation& simulation = model();
  apply_command(command, simulation);
  for (std::size_t i = 0; i < simulation.actuators().size(); ++i) {
    const CommandLimits& limits = simulation.actuators()[i]->limits();
    const double taken = simulation.state().drives[i].command;
    if (!(taken >= limits.min && taken <= limits.max)) throw Nonsense("a command beyond its limits was taken");
  }
}

void require_finite(const Policy& policy) {
  for (const PolicyStep& step : policy.steps) {
    require_finite(step.time_s, "time_s");
    for (const double value : step.values) require_finite(value, "a value of the policy");
  }
}

void take_optimise_request(const OptimisePolicy::Request& request) {
  const PolicyTask task = policy_task(request, 2.0);
  OptimiserOptions options = optimiser_options(request);
  options.max_iterations = 1;
  static int tasks = 0;
  if (tasks++ % 8 != 0) return;  // an equilibrium of the bar costs as much as a thousand other messages
  const PolicyAnswer answer = find_policy(model(), task, options, [](auto&&...) { return false; });
  OptimisePolicy::Response response;
  fill_response(answer, task, response);
  if (!response.success && response.message.empty()) throw Nonsense("refused without reason");
  require_finite(response.policy);
  for (const double value : {response.summary.initial_distance_m, response.summary.final_distance_m})
    require_finite(value, "distance_m");
  require_finite(response.summary.marker, "marker");
}

// As the controller takes it before anything moves.
void take_execute_request(const ExecutePolicy::Request& request) {
  Simulation& simulation = model();
  const CommandPolicy policy = from_message(request.policy);
  validate(policy, limits_of(simulation));
  require_finite(execution_time_limit_s(request), "time_limit_s");
  const PolicyPlayer player(policy, std::vector<double>(policy.names.size(), 1.0));
  for (const double time_s : {0.0, 0.5, 1.0, player.end_s(), 1e9})
    for (const double value : player.values_at(time_s)) require_finite(value, "a command played");
  if (request.closed_loop) ClosedLoop(simulation, correction_task(request, std::nullopt), {});
}

void take_in_gap_meter(const MarkerObservations& markers) {
  GapMeter meter([](const RealityGap& gap) {
    require_finite(gap.rms_m, "rms_m");
    for (const geometry_msgs::Point& point : gap.measured) require_finite(point, "measured");
  });
  meter.add_simulated(two_markers(10.0));
  meter.add_simulated(markers);
  meter.add_measured(markers);
  meter.add_measured(two_markers(10.5));
  meter.add_simulated(two_markers(11.0));
}

void take_in_rest(const MarkerObservations& markers) {
  RestDetector rest;
  rest.update(markers.header.stamp.toSec(), raw_positions_m(markers));
  require_whole(markers);
  MeasuredRest measured;
  for (int i = 0; i < 20; ++i) measured.add(seen_frame(i == 10 ? markers : two_markers(10.0 + 0.1 * i)));
  if (!measured.at_rest()) return;
  for (const auto& [name, position_m] : *measured.at_rest())
    if (!position_m.allFinite()) throw Nonsense(name + " rests nowhere");
}

void take_in_recording(const MarkerObservations& markers) {
  Recording recording;
  for (int i = 0; i < 60; ++i)
    recording.add_measured(observed_markers(i == 30 ? markers : two_markers(10.0 + 0.1 * i)));
  recording.commands.push_back({10.0, {{"left", 1.0}}});
  for (const MeasuredPose& pose : measured_poses(recording))
    for (const MeasuredMarker& marker : pose.markers)
      if (!marker.position_m.allFinite() || !marker.covariance_m2.allFinite()) throw Nonsense("a pose is not finite");
}

void require_moment(const SeenRobotStates& states) {
  const auto moment = states.newest();
  if (!moment) return;
  if (!moment->motion.present.vertices_m.allFinite() || !moment->motion.present.stickers_m.allFinite())
    throw Nonsense("what cameras see is not finite");
}

visualization_msgs::Marker triangle(double time_s) {
  visualization_msgs::Marker surface;
  surface.header.stamp = ros::Time(time_s);
  surface.header.frame_id = robot_frame();
  surface.type = visualization_msgs::Marker::TRIANGLE_LIST;
  surface.points.resize(3);
  surface.points[1].x = surface.points[2].y = 0.01;
  return surface;
}

void take_as_cameras(const MarkerObservations& markers, const visualization_msgs::Marker& surface) {
  SeenRobotStates states;
  states.add_markers(two_markers(10.0));
  states.add_surface(triangle(10.0));
  states.add_markers(markers);
  states.add_surface(surface);
  require_moment(states);
  states.add_markers(two_markers(11.0));
  states.add_surface(triangle(11.0));
  require_moment(states);
}

ActuatorState actuators() {
  ActuatorState state;
  state.names = {"left"};
  state.commands = state.actuated_commands = {1.0};
  state.cables.resize(1);
  state.cables[0].name = "left";
  state.cables[0].path.resize(2);
  state.chambers.resize(1);
  return state;
}

Target target() {
  Target target;
  target.marker = "tip";
  target.position.x = 0.1;
  return target;
}

RealityGap gap() {
  RealityGap gap;
  gap.names = {"tip"};
  gap.measured.resize(1);
  gap.gaps.resize(1);
  gap.distances_m = {0.001};
  gap.seen = {1};
  return gap;
}

Contacts contacts() {
  Contacts contacts;
  contacts.contacts.resize(1);
  Contact& contact = contacts.contacts[0];
  contact.first = "skin";
  contact.second = "floor";
  contact.force.z = contact.normal_force_n = 0.5;
  contact.normal.z = 1.0;
  contact.area_m2 = contact.sticking_area_m2 = 1e-4;
  return contacts;
}

void draw(const OverlayInputs& inputs) {
  const DrawnOverlay drawn = Overlay().draw(inputs, ros::Time(10.0));
  for (const visualization_msgs::MarkerArray& shapes : {drawn.shapes, drawn.labels})
    for (const visualization_msgs::Marker& shape : shapes.markers) {
      require_finite(shape.pose.position, "a drawn place");
      for (const auto& point : shape.points) require_finite(point, "a drawn line");
      for (const double part : {shape.color.r, shape.color.g, shape.color.b}) require_finite(part, "a colour");
    }
}

OverlayInputs inputs() { return {two_markers(10.0), two_markers(10.0), actuators(), target(), gap(), contacts()}; }

MotorState motors(double time_s) {
  MotorState state;
  state.header.stamp = ros::Time(time_s);
  state.linked = 1;
  state.names = {"left"};
  state.position_steps = state.target_steps = state.pull_m = {0.0};
  state.values = {1.0};
  state.known = {1};
  state.moving = {0};
  state.fault = {""};
  return state;
}

void take_motors(const MotorState& state) {
  MotorWatch watch;
  watch.add(motor_report(state), 1.0);
  watch.fault({"left", "right"}, 1.5);
  watch.moving();
  Recording recording;
  recording.add_motors(motor_readings(motors(10.0)), 10.0);
  recording.add_motors(motor_readings(state), state.header.stamp.toSec());
  recording.add_motors(motor_readings(motors(11.0)), 11.0);
}

FrameMessages frame() {
  const RgbdFrame frame{"camera", 1.0, cv::Mat(2, 3, CV_8UC3, cv::Scalar(9, 9, 9)),
                        cv::Mat(2, 3, CV_32FC1, cv::Scalar(0.5)), 0.001};
  return frame_messages(frame, d415_camera(64, 36), ros::Time(1.0));
}

void take_frame(const sensor_msgs::Image& colour, const sensor_msgs::Image& depth) {
  const RgbdFrame read = rgbd_frame("camera", colour, depth);
  if (!cv::checkRange(read.depth_m, true, nullptr, 0.0, 66.0)) throw Nonsense("a depth that no camera has");
  if (read.colour.empty()) throw Nonsense("an empty image was taken");
}

void take_info(const sensor_msgs::CameraInfo& info) {
  const CameraModel model = camera_model(info);
  for (const double value : {model.focal_x_px, model.focal_y_px, model.centre_x_px, model.centre_y_px})
    require_finite(value, "the camera's matrix");
  for (const double value : model.distortion) require_finite(value, "the lens");
}

PolicyPose pose() {
  PolicyPose pose;
  pose.markers = {"tip"};
  pose.targets.resize(1);
  pose.targets[0].x = 0.1;
  pose.targets[0].y = 0.005;
  pose.weights = {1.0};
  pose.actuators = {"left"};
  return pose;
}

ActuatorLimits limits() {
  ActuatorLimits limits;
  limits.name = "left";
  limits.min = 0.8;
  limits.max = 1.0;
  limits.max_tension_n = 5.0;
  limits.max_rate_per_s = 1.0;
  return limits;
}

OptimisePolicy::Request optimise_request() {
  OptimisePolicy::Request request;
  request.method = "gauss_newton";
  request.poses = {pose()};
  request.limits = {limits()};
  request.effort_m = 0.001;
  request.max_iterations = 5;
  return request;
}

Policy policy() {
  Policy policy;
  policy.names = {"left", "right"};
  policy.steps.resize(2);
  policy.steps[0].time_s = 1.0;
  policy.steps[0].values = {0.9, 1.0};
  policy.steps[1].time_s = 2.0;
  policy.steps[1].values = {0.95, 0.9};
  return policy;
}

ExecutePolicy::Request execute_request() {
  ExecutePolicy::Request request;
  request.policy = policy();
  request.closed_loop = 1;
  request.time_limit_s = 10.0;
  request.goal = pose();
  request.limits = {limits()};
  return request;
}

FitModel::Request fit_model_request() {
  FitModel::Request request;
  request.parameters = {"youngs_modulus_pa", "damping"};
  request.starts = {2e5, 0.002};
  request.mins = {1e5, 0.0001};
  request.maxs = {4e5, 0.01};
  request.mass_kg = 0.05;
  request.model_error_m = 1e-4;
  return request;
}

ActuatorCommand command() {
  ActuatorCommand command;
  command.names = {"left", "right"};
  command.values = {0.9, 1.0};
  return command;
}

std::vector<Feed> feeds() {
  const FrameMessages seen = frame();
  const MarkerObservations markers = two_markers(10.5);
  return {
      feed<ActuatorCommand>("a command to the simulator", command(), take_command),
      feed<OptimisePolicy::Request>("optimise_policy", optimise_request(), take_optimise_request),
      feed<ExecutePolicy::Request>("execute_policy", execute_request(), take_execute_request),
      feed<FitModel::Request>("fit_model", fit_model_request(), [](const auto& request) { fit_request(request); }),
      feed<MarkerObservations>("markers to the gap meter", markers, take_in_gap_meter),
      feed<MarkerObservations>("markers to who waits for rest", markers, take_in_rest),
      feed<MarkerObservations>("markers to a recording", two_markers(13.0), take_in_recording),
      feed<MarkerObservations>("markers to the cameras", markers,
                               [](const auto& bad) { take_as_cameras(bad, triangle(10.5)); }),
      feed<visualization_msgs::Marker>("a skin to the cameras", triangle(10.5),
                                       [](const auto& bad) { take_as_cameras(two_markers(10.5), bad); }),
      feed<MarkerObservations>("markers to the overlay", markers,
                               [](const auto& bad) {
                                 OverlayInputs all = inputs();
                                 all.simulated = bad;
                                 draw(all);
                                 all.simulated = two_markers(10.0);
                                 all.measured = bad;
                                 draw(all);
                               }),
      feed<ActuatorState>("actuators to the overlay", actuators(),
                          [](const auto& bad) {
                            OverlayInputs all = inputs();
                            all.actuators = bad;
                            draw(all);
                          }),
      feed<Target>("a target to the overlay", target(),
                   [](const auto& bad) {
                     OverlayInputs all = inputs();
                     all.target = bad;
                     draw(all);
                   }),
      feed<Contacts>("contacts to the overlay", contacts(),
                     [](const auto& bad) {
                       OverlayInputs all = inputs();
                       all.contacts = bad;
                       draw(all);
                     }),
      feed<RealityGap>("a gap to the overlay", gap(),
                       [](const auto& bad) {
                         OverlayInputs all = inputs();
                         all.gap = bad;
                         draw(all);
                       }),
      feed<MotorState>("motors", motors(10.5), take_motors),
      feed<sensor_msgs::Image>("a colour image", seen.colour, [seen](const auto& bad) { take_frame(bad, seen.depth); }),
      feed<sensor_msgs::Image>("a depth image", seen.depth, [seen](const auto& bad) { take_frame(seen.colour, bad); }),
      feed<sensor_msgs::CameraInfo>("a camera's lens", seen.info, take_info),
  };
}

const char* const kGood = "as it is";

// Only in the process that may end so: OpenCV's threads do not survive a fork.
void take(const Feed& feed, const BadBytes& bad) {
  try {
    feed.take(bad.bytes);
  } catch (const std::exception& error) {
    if (bad.name == kGood) throw Nonsense(std::string("what is good was refused: ") + error.what());
    throw;
  }
}

bool check(std::size_t part) {
  struct Case {
    const Feed* feed;
    BadBytes bad;
  };
  const std::vector<Feed> all_feeds = feeds();
  std::vector<Case> cases;
  for (const Feed& one : all_feeds) {
    cases.push_back({&one, {kGood, one.good}});
    std::vector<BadBytes> all = bad_bytes(one.good, 1);
    for (std::size_t i = cases.size() % part; i < all.size(); i += part) cases.push_back({&one, std::move(all[i])});
  }
  return all_good(
      run_guarded({cases.size(), [&](std::size_t i) { return cases[i].feed->name + ": " + cases[i].bad.name; },
                   [&](std::size_t i) { take(*cases[i].feed, cases[i].bad); }}));
}

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  return soft_robot_lab::run_check(argc, argv, "bad_messages_check", soft_robot_lab::check);
}
