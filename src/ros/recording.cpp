// SPDX-License-Identifier: BSD-3-Clause
#include "recording.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include <rosbag/bag.h>
#include <std_msgs/String.h>

#include "bag_index.h"
#include "recorded_topics.h"
#include "gap_meter.h"
#include "topics.h"

namespace soft_robot_lab {
namespace {

double item(const std::vector<double>& list, size_t index) { return index < list.size() ? list[index] : 0.0; }

std::string tenths(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

}  // namespace

void Recording::add(const ActuatorCommand& command, double time_s) {
  std::map<std::string, double> values = commands.empty() ? std::map<std::string, double>{} : commands.back().values;
  if (!commands.empty() && time_s < commands.back().time_s) return;
  for (size_t i = 0; i < command.names.size() && i < command.values.size(); ++i)
    values[command.names[i]] = command.values[i];
  if (commands.empty() || values != commands.back().values) commands.push_back({time_s, std::move(values)});
}

void Recording::add(const MotorState& motors, double time_s) {
  if (!reached.empty() && time_s < reached.back().time_s) return;
  const size_t count = motors.names.size();
  if (motors.values.size() != count || motors.known.size() != count || motors.moving.size() != count)
    throw std::runtime_error("motor/state: lists of different lengths");
  std::map<std::string, double> values;
  for (size_t i = 0; i < count; ++i)
    if (motors.known[i] && !motors.moving[i]) values[motors.names[i]] = motors.values[i];
  if (reached.empty() || values != reached.back().values) reached.push_back({time_s, std::move(values)});
  note_events(motors, time_s);
}

// Before the first command nothing is spoilt: there the rig is linked and set to zero.
void Recording::note_events(const MotorState& motors, double time_s) {
  constexpr double most_steps = 8.0;  // that a motor takes between two states of one that stands
  for (size_t i = 0; i < motors.names.size() && motors.names == motors_.names && !commands.empty(); ++i) {
    const double before = item(motors_.position_steps, i), now = item(motors.position_steps, i);
    if (motors_.known[i] && !motors.known[i]) {
      const std::string reason = i < motors.fault.size() ? motors.fault[i] : "";
      events.push_back(
          {time_s, motors.names[i] + " does not know where it is" + (reason.empty() ? "" : ": " + reason)});
    } else if (now == 0.0 && std::abs(before) > most_steps && !motors.moving[i] && !motors_.moving[i]) {
      events.push_back({time_s, motors.names[i] + " was set to zero"});
    }
  }
  motors_ = motors;
}

void Recording::add_measured(const MarkerObservations& markers) {
  if (!measured.empty() && markers.header.stamp <= measured.back().header.stamp) return;
  const size_t count = markers.names.size();
  if (markers.positions.size() != count || markers.covariances.size() != 9 * count || markers.sources.size() != count)
    throw std::runtime_error("tracker/markers: lists of different lengths");
  measured.push_back(markers);
}

namespace {

void add(const rosbag::MessageInstance& message, Recording& recording) {
  const std::string topic = relative(message.getTopic());
  if (topic == topics::actuator_command) {
    const auto command = read_message<ActuatorCommand>(message);
    const double stamp_s = command->header.stamp.toSec();
    recording.add(*command, stamp_s > 0.0 ? stamp_s : message.getTime().toSec());
  } else if (topic == topics::motor_state) {
    const auto motors = read_message<MotorState>(message);
    recording.add(*motors, motors->header.stamp.toSec());
  } else if (topic == topics::tracker_markers) {
    recording.add_measured(*read_message<MarkerObservations>(message));
  } else if (topic == topics::simulator_markers) {
    recording.simulated.push_back(*read_message<MarkerObservations>(message));
  } else if (topic == topics::simulator_scene) {
    recording.scene = read_message<std_msgs::String>(message)->data;
  }
}

}  // namespace

UsablePart usable_part(const Recording& recording, std::optional<double> from_s, std::optional<double> to_s) {
  UsablePart part{recording, {}};
  Recording& kept = part.recording;
  if (kept.measured.empty()) return part;
  const double start_s = kept.measured.front().header.stamp.toSec(), last_s = kept.measured.back().header.stamp.toSec();
  const double first_s = start_s + from_s.value_or(0.0);
  double end_s = to_s ? start_s + *to_s : last_s;
  const auto event = std::find_if(kept.events.begin(), kept.events.end(),
                                  [&](const RecordedEvent& one) { return one.time_s > first_s; });
  const bool spoilt = event != kept.events.end() && event->time_s <= end_s;
  if (spoilt && !to_s) end_s = event->time_s;
  if (spoilt) part.note = tenths(event->time_s - start_s) + " s: " + event->text;
  if (from_s || end_s < last_s)
    part.note = "used from " + tenths(first_s - start_s) + " s to " + tenths(end_s - start_s) + " s of " +
                tenths(last_s - start_s) + " s" + (spoilt ? "; at " + part.note : "");
  const auto outside = [&](const auto& message) {
    return message.header.stamp.toSec() < first_s || message.header.stamp.toSec() > end_s;
  };
  const auto cut = [&](auto& messages) {
    messages.erase(std::remove_if(messages.begin(), messages.end(), outside), messages.end());
  };
  cut(kept.measured);
  cut(kept.simulated);
  cut(kept.gaps);
  if (kept.measured.empty())
    throw std::invalid_argument("no markers were tracked from " + tenths(first_s - start_s) + " s to " +
                                tenths(end_s - start_s) + " s; the recording has " + tenths(last_s - start_s) + " s" +
                                (part.note.empty() ? "" : " (" + part.note + ")"));
  return part;
}

Recording read_recording(const std::string& path) {
  if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path))
    throw std::runtime_error(path + ": cannot be read as a bag: it is no regular file");
  Recording recording;
  try {
    require_sound_index(path);
    const rosbag::Bag bag(path, rosbag::bagmode::Read);
    rosbag::View view(bag);
    recording.start_s = view.getBeginTime().toSec();
    recording.end_s = view.getEndTime().toSec();
    for (const rosbag::MessageInstance& message : view) add(message, recording);
    recording.gaps = gaps_between(recording.measured, recording.simulated);
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error(path + ": cannot be read as a bag: " + error.what());
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
  if (recording.measured.empty())
    throw std::runtime_error(path + ": holds no markers of a tracker (topic " + topics::tracker_markers + ")");
  return recording;
}

}  // namespace soft_robot_lab
