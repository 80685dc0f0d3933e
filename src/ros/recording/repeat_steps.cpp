// SPDX-License-Identifier: BSD-3-Clause
#include "repeat_steps.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "recorded_topics.h"
#include "ros/messages/conversions.h"
#include "ros/messages/image_messages.h"
#include "ros/messages/image_stamp.h"
#include "ros/base/topics.h"
#include "ros/tracking/tracker_parameters.h"

namespace soft_robot_lab {
namespace {

using sensor_msgs::Image;

// Where in the recording each image is; read when it is needed, as all of them would not fit into memory.
class RecordedImages {
 public:
  RecordedImages(const rosbag::Bag& bag, const std::vector<std::string>& topics) {
    for (const rosbag::MessageInstance& message : only(bag, topics))
      images_.emplace(Key(relative(message.getTopic()), read_message<ImageStamp>(message)->header.stamp.toSec()),
                      message);
  }

  // Absent where the recording lacks colour or depth.
  std::optional<RgbdFrame> frame(const std::string& camera, double stamp_s) const {
    const auto colour = images_.find({colour_topic(camera), stamp_s});
    const auto depth = images_.find({depth_topic(camera), stamp_s});
    if (colour == images_.end() || depth == images_.end()) return std::nullopt;
    return rgbd_frame(camera, *read_message<Image>(colour->second), *read_message<Image>(depth->second));
  }

 private:
  using Key = std::pair<std::string, double>;
  std::map<Key, rosbag::MessageInstance> images_;
};

std::vector<std::string> image_topics(const std::vector<TrackerUpdateLog>& steps) {
  std::vector<std::string> topics;
  for (const TrackerUpdateLog& step : steps)
    for (const std::string& camera : step.cameras)
      for (const std::string& topic : {colour_topic(camera), depth_topic(camera)})
        if (std::find(topics.begin(), topics.end(), topic) == topics.end()) topics.push_back(topic);
  return topics;
}

// All of a step, or none.
std::vector<RgbdFrame> frames_of(const TrackerUpdateLog& step, const RecordedImages& images) {
  std::vector<RgbdFrame> frames;
  for (std::size_t i = 0; i < step.cameras.size(); ++i) {
    auto frame = images.frame(step.cameras[i], step.stamps_s.at(i));
    if (!frame) return {};
    frames.push_back(std::move(*frame));
  }
  return frames;
}

std::vector<TrackedMarker> markers_of(const TrackerUpdateLog& step) {
  std::vector<TrackedMarker> markers;
  for (std::size_t i = 0; i < step.markers.size(); ++i)
    markers.push_back({step.markers[i], from_message(step.rest.at(i), "rest")});
  return markers;
}

// For each step: which numbers of the tracker are other ones than in the step before.
std::vector<dynamic_reconfigure::Config> changes_before(const rosbag::Bag& bag) {
  std::vector<dynamic_reconfigure::Config> changes;
  dynamic_reconfigure::Config before, now;
  for (const rosbag::MessageInstance& message : only(bag, {topics::tracker_steps, tracker_updates})) {
    if (relative(message.getTopic()) == topics::tracker_steps) {
      changes.push_back(changed(before, now));
      before = now;
      continue;
    }
    now = *read_message<dynamic_reconfigure::Config>(message);
    if (before.doubles.empty()) before = now;  // as they were from the start
  }
  return changes;
}

}  // namespace

RepeatedSteps repeat_steps(const rosbag::Bag& bag, const std::vector<TrackerUpdateLog>& steps,
                           const TrackingInputOptions& options, const TrackingInput::OnResult& on_result) {
  TrackerSettings settings = load_tracker(options.tracker);
  const std::vector<dynamic_reconfigure::Config> changes = changes_before(bag);
  const RecordedImages images(bag, image_topics(steps));
  RepeatedSteps done;
  std::unique_ptr<MarkerTracking> tracking;
  const TrackerUpdateLog* last = nullptr;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const TrackerUpdateLog& step = steps[i];
    if (!changes[i].doubles.empty()) {
      settings = with_request(settings, changes[i]);
      if (tracking) tracking->set_settings(settings);
    }
    std::vector<RgbdFrame> frames = frames_of(step, images);
    if (frames.empty()) {
      ++done.without_images;
      continue;
    }
    if (!last || last->markers != step.markers || last->rest != step.rest)
      tracking = std::make_unique<MarkerTracking>(options.tracking, settings, markers_of(step));
    if (!tracking->follows(step)) ++done.resumed;
    on_result(tracking->repeat(step, std::move(frames)));
    last = &step;
  }
  return done;
}

}  // namespace soft_robot_lab
