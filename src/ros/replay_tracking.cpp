#include "soft_robot_lab/ros/replay_tracking.h"

#include <map>
#include <memory>
#include <stdexcept>

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>

#include "soft_robot_lab/ros/gap_meter.h"
#include "soft_robot_lab/ros/image_messages.h"
#include "soft_robot_lab/ros/topics.h"
#include "soft_robot_lab/settings/cpu_time.h"

namespace soft_robot_lab {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;

// Pairs of each camera's images that go to the input. A bad pair is told and left out, as in a session.
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
            ROS_WARN_THROTTLE(1.0, "%s: %s", camera.c_str(), error.what());
          }
        };
    pairs[camera]->registerCallback(boost::bind<void>(on_pair, boost::placeholders::_1, boost::placeholders::_2));
  }
  return pairs;
}

template <typename Message>
ros::MessageEvent<Message const> event_of(const rosbag::MessageInstance& message) {
  return ros::MessageEvent<Message const>(message.instantiate<Message>());
}

}  // namespace

ReplaySummary replay_tracking(const TrackingInputOptions& options, const std::string& bag_path,
                              const std::string& output_path) {
  rosbag::Bag bag(bag_path, rosbag::bagmode::Read);
  rosbag::Bag output(output_path, rosbag::bagmode::Write);
  ReplaySummary summary;
  GapMeter gap([&](const RealityGap& found) {
    output.write("/" + std::string(topics::reality_gap), found.header.stamp, found);
  });
  TrackingInput input(options, [&](const MarkerTracking::Result& result) {
    if (!result.report.updated) return;
    output.write("/" + std::string(topics::tracker_markers), result.observations.header.stamp, result.observations);
    gap.add_measured(result.observations);
    ++summary.written;
  });
  const auto pairs = pair_up(options.tracking.cameras, input);
  const double start_s = cpu_time_s();
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    const std::string topic = message.getTopic().substr(message.getTopic().front() == '/' ? 1 : 0);
    if (topic == topics::simulator_markers) {
      const auto simulated = message.instantiate<MarkerObservations>();
      input.add_simulated(*simulated);
      gap.add_simulated(*simulated);
    }
    if (topic == topics::simulator_scene && options.scene.empty())
      input.start(message.instantiate<std_msgs::String>()->data);
    for (const auto& [camera, pair] : pairs) {
      if (topic == info_topic(camera)) input.add_info(camera, *message.instantiate<CameraInfo>());
      if (topic == colour_topic(camera)) pair->add<0>(event_of<Image>(message));
      if (topic == depth_topic(camera)) pair->add<1>(event_of<Image>(message));
    }
  }
  input.finish();
  summary.cpu_s = cpu_time_s() - start_s;
  if (summary.written == 0)
    throw std::runtime_error(bag_path + ": has no images of " + options.tracking.cameras.front() +
                             " that could be used: it needs images, camera_info and a scene");
  return summary;
}

}  // namespace soft_robot_lab
