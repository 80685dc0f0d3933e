// SPDX-License-Identifier: BSD-3-Clause
#include "fit_service.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "ros/messages/conversions.h"
#include "ros/base/log_text.h"
#include "ros/messages/message_limits.h"
#include "ros/recording/recorded_session.h"
#include "session/rest_periods.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

constexpr double kSessionKept_s = 1800.0;  // of the running session

std::optional<double> item(const std::vector<double>& list, size_t index, size_t count, const char* field) {
  if (list.empty()) return std::nullopt;
  if (list.size() != count)
    throw std::invalid_argument(std::string(field) + ": " + std::to_string(list.size()) + " given, must be none or " +
                                std::to_string(count) + ", as many as parameters");
  return list[index];
}

void keep_last(std::vector<ObservedMarkers>& all, double from_s) {
  const auto first = std::find_if(all.begin(), all.end(), [&](const auto& at) { return at.time_s >= from_s; });
  all.erase(all.begin(), first);
}

}  // namespace

FitRequest fit_request(const FitModel::Request& request) {
  FitRequest fit;
  const size_t count = request.parameters.size();
  for (size_t i = 0; i < count; ++i)
    fit.parameters.push_back({request.parameters[i], item(request.starts, i, count, "starts"),
                              item(request.mins, i, count, "mins"), item(request.maxs, i, count, "maxs")});
  if (request.mass_kg != 0.0) fit.mass_kg = request.mass_kg;
  if (request.model_error_m != 0.0) fit.model_error_m = request.model_error_m;
  fit.validate();
  require_in_limits<FitModel::Request>(request);
  for (const auto& [field, path] : {std::pair{"bag", request.bag}, {"scene", request.scene}, {"file", request.file}})
    if (!path.empty()) require_whole_path(field, path);
  return fit;
}

void fill_response(const FitResult& result, FitModel::Response& response) {
  response.success = result.converged;
  response.message = result.message;
  for (const FittedValue& value : result.values) {
    response.names.push_back(value.name);
    response.values.push_back(value.value);
    response.starts.push_back(value.start);
    response.deviations.push_back(value.deviation);
    response.lows.push_back(value.low);
    response.highs.push_back(value.high);
    response.identifiable.push_back(value.identifiable);
  }
  for (Eigen::Index row = 0; row < result.correlations.rows(); ++row)
    for (Eigen::Index column = 0; column < result.correlations.cols(); ++column)
      response.correlations.push_back(result.correlations(row, column));
  response.warnings = result.warnings;
  response.rms_before_m = result.before.rms_m;
  response.rms_after_m = result.after.rms_m;
  for (const auto& [marker, rms_m] : result.before.marker_rms_m) {
    response.markers.push_back(marker);
    response.marker_rms_before_m.push_back(rms_m);
    response.marker_rms_after_m.push_back(result.after.marker_rms_m.at(marker));
  }
  response.measured_from_base.position = to_message(result.measured_from_base.translation());
  response.measured_from_base.orientation = to_message(Eigen::Quaterniond(result.measured_from_base.linear()));
}

FitService::FitService(ros::NodeHandle& node, SceneOptions options, const std::string& scene)
    : options_(std::move(options)) {
  recording_.scene = scene;
  subscribers_ = {
      node.subscribe(topics::actuator_command, 100, &FitService::on_command, this),
      node.subscribe(topics::motor_state, 100, &FitService::on_motors, this),
      node.subscribe(topics::tracker_markers, 100, &FitService::on_markers, this),
      node.subscribe(topics::simulator_scene, 1, &FitService::on_scene, this),
  };
  service_ = node.advertiseService<FitModel::Request, FitModel::Response>(topics::fit_model,
                                                                          [this](auto& request, auto& response) {
                                                                            answer(request, response);
                                                                            return true;
                                                                          });
}

void FitService::on_command(const ActuatorCommand& command) {
  if (!is_in_limits<ActuatorCommand>(command)) return;  // no model takes it either
  const std::lock_guard lock(mutex_);
  recording_.add_commands(command.names, command.values, command.header.stamp.toSec());
}

void FitService::on_motors(const MotorState& motors) {
  const std::lock_guard lock(mutex_);
  try {
    recording_.add_motors(motor_readings(motors), motors.header.stamp.toSec());
  } catch (const std::runtime_error& error) {
    ROS_WARN_THROTTLE(10.0, "%s", log_text(error.what()).c_str());
  }
}

void FitService::on_markers(const MarkerObservations& markers) {
  const std::lock_guard lock(mutex_);
  try {
    recording_.add_measured(observed_markers(markers));
  } catch (const std::invalid_argument& error) {
    ROS_WARN_THROTTLE(10.0, "%s", log_text(error.what()).c_str());
    return;
  }
  const double from_s = markers.header.stamp.toSec() - kSessionKept_s;
  // Now and then, as it moves all that is kept.
  if (recording_.measured.front().time_s < from_s - 60.0) keep_last(recording_.measured, from_s);
}

// Another robot, another recording.
void FitService::on_scene(const std_msgs::String& path) {
  const std::lock_guard lock(mutex_);
  recording_ = Recording{};
  recording_.scene = path.data;
}

Recording FitService::heard() const {
  const std::lock_guard lock(mutex_);
  if (recording_.measured.empty())
    throw std::runtime_error(std::string("nothing to fit to: no markers came on ") + topics::tracker_markers);
  return recording_;
}

void FitService::answer(const FitModel::Request& request, FitModel::Response& response) {
  try {
    const std::unique_lock lock(fitting_, std::try_to_lock);
    if (!lock) throw std::runtime_error("busy with another fit; ask again when it ended");
    FitRequest fit = fit_request(request);
    cancelled_ = false;
    fit.progress = [this](int iteration, double rms_gap_m) {
      if (on_progress) on_progress(iteration, rms_gap_m);
      return !cancelled_;
    };
    if (!request.file.empty()) {
      require_own_or_new(request.file);
      require_writable(request.file);
    }
    const UsablePart part = usable_part(request.bag.empty() ? heard() : read_recorded_session(request.bag));
    const Recording& recording = part.recording;
    const std::string scene = request.scene.empty() ? recording.scene : request.scene;
    if (scene.empty()) throw std::invalid_argument("scene: none is given, and the recording does not name one");
    if (!request.file.empty()) require_not_read(request.file, scene);
    const std::vector<MeasuredPose> poses = measured_poses(recording);
    SceneOptions options = options_;
    options.interrupt = [this] { return cancelled_ || !ros::ok(); };
    const FitResult result = fit_model(scene, options, poses, fit, measured_swings(recording));
    fill_response(result, response);
    if (!part.note.empty()) response.warnings.push_back(part.note);
    response.poses = static_cast<int>(
        std::count_if(poses.begin(), poses.end(), [](const MeasuredPose& pose) { return !pose.markers.empty(); }));
    if (!request.file.empty()) write_fitted_scene(result, scene, request.file);
  } catch (const std::exception& error) {
    response.success = false;
    response.message = answer_text(error);
  }
  if (!response.success) ROS_WARN("%s refused: %s", topics::fit_model, log_text(response.message).c_str());
}

}  // namespace soft_robot_lab
