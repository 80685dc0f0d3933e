// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_session.h"

#include <filesystem>
#include <stdexcept>

#include <rosbag/bag.h>
#include <std_msgs/String.h>

#include "ros/messages/conversions.h"
#include "ros/tracking/gap_meter.h"
#include "ros/messages/message_limits.h"
#include "recorded_topics.h"
#include "ros/base/topics.h"
#include "ros/tracking/tracker_parameters.h"

namespace soft_robot_lab {

std::vector<MotorReading> motor_readings(const MotorState& motors) {
  require_in_limits<MotorState>(motors);
  const size_t count = motors.names.size();
  if (motors.values.size() != count || motors.known.size() != count || motors.moving.size() != count)
    throw std::runtime_error("motor/state: lists of different lengths");
  std::vector<MotorReading> readings;
  for (size_t i = 0; i < count; ++i) {
    const double position_steps = i < motors.position_steps.size() ? motors.position_steps[i] : 0.0;
    readings.push_back({motors.names[i], motors.values[i], position_steps, motors.known[i] != 0, motors.moving[i] != 0,
                        i < motors.fault.size() ? motors.fault[i] : ""});
  }
  return readings;
}

ObservedMarkers observed_markers(const MarkerObservations& markers) {
  require_whole(markers);
  if (markers.covariances.size() != 9 * markers.names.size())
    throw std::invalid_argument("covariances: " + std::to_string(markers.covariances.size()) + " numbers for " +
                                std::to_string(markers.names.size()) + " markers, must be nine each");
  ObservedMarkers observed{markers.header.stamp.toSec(), {}};
  for (size_t i = 0; i < markers.names.size(); ++i)
    observed.markers.push_back(
        {markers.names[i], from_message(markers.positions[i], "positions"),
         Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&markers.covariances[9 * i]),
         markers.sources[i] == MarkerObservations::SEEN});
  return observed;
}

namespace {

struct MarkerMessages {
  std::vector<MarkerObservations> measured, simulated;
  dynamic_reconfigure::Config settings;  // of the tracker, the last
};

void add(const dynamic_reconfigure::Config& settings, double time_s, RecordedSession& session, MarkerMessages& before) {
  const dynamic_reconfigure::Config changes = changed(before.settings, settings);
  if (!before.settings.doubles.empty() && !changes.doubles.empty())
    session.settings.push_back({time_s, "tracker: " + changes_text(before.settings, changes)});
  before.settings = settings;
}

void add(const rosbag::MessageInstance& message, RecordedSession& session, MarkerMessages& markers) {
  const std::string topic = relative(message.getTopic());
  if (topic == topics::actuator_command) {
    const auto command = read_message<ActuatorCommand>(message);
    const double stamp_s = command->header.stamp.toSec();
    session.add_commands(command->names, command->values, stamp_s > 0.0 ? stamp_s : message.getTime().toSec());
  } else if (topic == topics::motor_state) {
    const auto motors = read_message<MotorState>(message);
    session.add_motors(motor_readings(*motors), motors->header.stamp.toSec());
  } else if (topic == topics::tracker_markers) {
    const auto observations = read_message<MarkerObservations>(message);
    if (markers.measured.empty() || observations->header.stamp > markers.measured.back().header.stamp)
      markers.measured.push_back(*observations);
  } else if (topic == topics::simulator_markers) {
    markers.simulated.push_back(*read_message<MarkerObservations>(message));
  } else if (topic == tracker_updates) {
    add(*read_message<dynamic_reconfigure::Config>(message), message.getTime().toSec(), session, markers);
  } else if (topic == topics::simulator_scene) {
    session.scene = read_message<std_msgs::String>(message)->data;
  }
}

void read(const std::string& path, RecordedSession& session) {
  const rosbag::Bag bag = open_bag(path);
  rosbag::View view(bag);
  session.start_s = view.getBeginTime().toSec();
  session.end_s = view.getEndTime().toSec();
  MarkerMessages markers;
  for (const rosbag::MessageInstance& message : view) add(message, session, markers);
  for (const MarkerObservations& at : markers.measured) session.add_measured(observed_markers(at));
  for (const MarkerObservations& at : markers.simulated) session.simulated.push_back(observed_markers(at));
  session.gaps = gaps_between(markers.measured, markers.simulated);
}

}  // namespace

RecordedSession read_recorded_session(const std::string& path) {
  if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path))
    throw std::runtime_error(path + ": cannot be read as a bag: it is no regular file");
  RecordedSession session;
  try {
    read(path, session);
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error(path + ": cannot be read as a bag: " + error.what());
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
  if (session.measured.empty())
    throw std::runtime_error(path + ": holds no markers of a tracker (topic " + topics::tracker_markers + ")");
  return session;
}

}  // namespace soft_robot_lab
