// SPDX-License-Identifier: BSD-3-Clause
#include "replay_tracking.h"

#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>

#include <rosbag/bag.h>
#include <std_msgs/String.h>

#include "bag_index.h"
#include "recorded_topics.h"
#include "repeat_steps.h"
#include "gap_meter.h"
#include "image_messages.h"
#include "log_text.h"
#include "topics.h"
#include "settings/cpu_time.h"

namespace soft_robot_lab {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;

// Pairs of each camera's images that go to the input. A bad pair is logged and left out, as in a session.
std::map<std::string, std::unique_ptr<ImagePair>> pair_up(const std::vector<std::string>& cameras,
                                                          TrackingInput& input) {
  std::map<std::string, std::unique_ptr<ImagePair>> pairs;
  for (const std::string& camera : cameras) {
    pairs[camera] = std::make_unique<ImagePair>(waiting_images);
    const boost::function<void(const Image::ConstPtr&, const Image::ConstPtr&)> on_pair =
        [&input, camera](const auto& colour, const auto& depth) {
          try {
            input.add_frame(rgbd_frame(camera, *colour, *depth));
          } catch (const std::invalid_argument& error) {
            ROS_WARN_THROTTLE(1.0, "%s: %s", camera.c_str(), log_text(error.what()).c_str());
          }
        };
    pairs[camera]->registerCallback(boost::bind<void>(on_pair, boost::placeholders::_1, boost::placeholders::_2));
  }
  return pairs;
}

template <typename Message>
ros::MessageEvent<Message const> event_of(const rosbag::MessageInstance& message) {
  return ros::MessageEvent<Message const>(read_message<Message>(message));
}

// Of bare cameras, or by a tracker that did not publish its steps.
void track_anew(const rosbag::Bag& bag, const TrackingInputOptions& options, const TrackingInput::OnResult& on_result) {
  TrackingInput input(options, on_result);
  const auto pairs = pair_up(options.tracking.cameras, input);
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    const std::string topic = relative(message.getTopic());
    if (topic == topics::simulator_markers) input.add_simulated(*read_message<MarkerObservations>(message));
    if (topic == topics::simulator_scene && options.scene.empty())
      input.start(read_message<std_msgs::String>(message)->data);
    for (const auto& [camera, pair] : pairs) {
      if (topic == info_topic(camera)) input.add_info(camera, *read_message<CameraInfo>(message));
      if (topic == colour_topic(camera)) pair->add<0>(event_of<Image>(message));
      if (topic == depth_topic(camera)) pair->add<1>(event_of<Image>(message));
    }
  }
  input.finish();
}

template <typename Message>
std::vector<Message> messages_of(const rosbag::Bag& bag, const std::string& topic) {
  std::vector<Message> messages;
  for (const rosbag::MessageInstance& message : only(bag, {topic})) messages.push_back(*read_message<Message>(message));
  return messages;
}

// Of messages at the same time; where a camera's frame came late there are several. Numbers that publishers count by
// are not compared.
template <typename Message>
void compare(const std::vector<Message>& recorded, const std::vector<Message>& replayed, long& alike, long& other) {
  std::map<ros::Time, std::vector<Message>> by_stamp;
  for (Message message : recorded) {
    message.header.seq = 0;
    by_stamp[message.header.stamp].push_back(std::move(message));
  }
  for (const Message& message : replayed) {
    const auto then = by_stamp.find(message.header.stamp);
    if (then == by_stamp.end()) continue;
    const bool found = std::find(then->second.begin(), then->second.end(), message) != then->second.end();
    ++(found ? alike : other);
  }
}

template <typename Message>
void write(rosbag::Bag& bag, const std::string& topic, const std::vector<Message>& messages) {
  for (const Message& message : messages) bag.write("/" + topic, message.header.stamp, message);
}

}  // namespace

ReplaySummary replay_tracking(const TrackingInputOptions& options, const std::string& bag_path,
                              const std::string& output_path) {
  require_sound_index(bag_path);
  const rosbag::Bag bag(bag_path, rosbag::bagmode::Read);
  rosbag::Bag output(output_path, rosbag::bagmode::Write);
  const double start_s = cpu_time_s();
  std::vector<MarkerObservations> measured;
  const auto on_result = [&](const MarkerTracking::Result& result) {
    if (result.report.updated) measured.push_back(result.observations);
  };
  ReplaySummary summary;
  const auto steps = messages_of<TrackerUpdateLog>(bag, topics::tracker_steps);
  summary.repeated = !steps.empty();
  if (summary.repeated) {
    const RepeatedSteps done = repeat_steps(bag, steps, options, on_result);
    summary.without_images = done.without_images;
    summary.resumed = done.resumed;
  } else {
    track_anew(bag, options, on_result);
  }
  if (measured.empty())
    throw std::runtime_error(bag_path + ": has no images of " + options.tracking.cameras.front() +
                             " that could be used: it needs images, camera_info and a scene");
  const auto gaps = gaps_between(measured, messages_of<MarkerObservations>(bag, topics::simulator_markers));
  write(output, topics::tracker_markers, measured);
  write(output, topics::reality_gap, gaps);
  summary.written = static_cast<long>(measured.size());
  summary.cpu_s = cpu_time_s() - start_s;
  compare(messages_of<MarkerObservations>(bag, topics::tracker_markers), measured, summary.markers_alike,
          summary.markers_other);
  compare(messages_of<RealityGap>(bag, topics::reality_gap), gaps, summary.gaps_alike, summary.gaps_other);
  return summary;
}

}  // namespace soft_robot_lab
