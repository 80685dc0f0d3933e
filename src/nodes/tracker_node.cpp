// Follows the robot's markers with RGB-D cameras: images in, tracker/markers out. From a session, or from a recording
// as fast as it can be read (~bag), with the same output.
//
// Parameters: ~cameras (list of names: the topics' first parts), ~tracker (path of the tracker's settings), ~poses
// (path: where the cameras stand; a calibration writes it), ~scene (path; absent where simulator/scene tells),
// ~use_simulated (simulated markers say where to look first), ~balls (path of the calibration's balls; absent: no
// calibration), ~bag and ~output (paths: a recording to read, and a bag to write).
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <diagnostic_updater/diagnostic_updater.h>
#include <message_filters/subscriber.h>
#include <message_filters/time_synchronizer.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <soft_robot_lab/Calibrate.h>
#include <std_msgs/String.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "nodes/run_node.h"
#include "soft_robot_lab/ros/actuator_plugins.h"
#include "soft_robot_lab/ros/calibrate_request.h"
#include "soft_robot_lab/ros/image_messages.h"
#include "soft_robot_lab/ros/marker_tracking.h"
#include "soft_robot_lab/ros/topics.h"
#include "soft_robot_lab/scene/scene.h"
#include "soft_robot_lab/settings/cpu_time.h"
#include "soft_robot_lab/vision/annotate.h"

namespace soft_robot_lab {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;

struct NodeOptions {
  TrackingOptions tracking;
  std::string tracker, poses, scene, balls, bag, output;
  bool use_simulated = true;
};

NodeOptions read_options(const ros::NodeHandle& node) {
  NodeOptions options;
  node.getParam("cameras", options.tracking.cameras);
  node.getParam("slop_s", options.tracking.slop_s);
  node.getParam("patience_s", options.tracking.patience_s);
  options.tracking.validate();
  if (!node.getParam("tracker", options.tracker))
    throw std::invalid_argument("tracker: missing; give the path of its settings");
  if (!node.getParam("poses", options.poses))
    throw std::invalid_argument("poses: missing; give the path of the cameras' poses");
  node.getParam("scene", options.scene);
  node.getParam("balls", options.balls);
  node.getParam("use_simulated", options.use_simulated);
  node.getParam("bag", options.bag);
  node.getParam("output", options.output);
  if (!options.bag.empty() && options.output.empty())
    throw std::invalid_argument("output: missing; give the path of the bag to write, beside bag");
  return options;
}

std::vector<TrackedMarker> markers_of(const std::string& scene_path) {
  SceneOptions options;
  options.actuator_factory = actuators_from_plugins();
  const Scene scene = load_scene(scene_path, options);
  std::vector<TrackedMarker> markers;
  for (const Marker& marker : scene.simulation->markers()) markers.push_back({marker.name(), marker.rest_position_m()});
  return markers;
}

std::string colour_topic(const std::string& camera) { return camera + "/color/image_raw"; }
std::string depth_topic(const std::string& camera) { return camera + "/aligned_depth_to_color/image_raw"; }
std::string info_topic(const std::string& camera) { return camera + "/color/camera_info"; }

using ImagePair = message_filters::TimeSynchronizer<Image, Image>;
constexpr int kWaitingImages = 10;

// Images of a camera become pairs, pairs become groups, groups become markers.
class TrackingInput {
 public:
  using OnResult = std::function<void(const MarkerTracking::Result&)>;

  TrackingInput(NodeOptions options, OnResult on_result)
      : options_(std::move(options)), settings_(load_tracker(options_.tracker)), on_result_(std::move(on_result)) {
    if (std::filesystem::exists(options_.poses)) poses_ = read_camera_poses(options_.poses);
    if (!options_.scene.empty()) start(options_.scene);
  }

  void start(const std::string& scene) {
    if (scene == scene_) return;
    tracking_ = std::make_unique<MarkerTracking>(options_.tracking, settings_, markers_of(scene));
    scene_ = scene;
    tracking_->set_poses(poses_);
    for (const auto& [camera, info] : infos_) tracking_->add_info(camera, info);
  }

  void set_poses(const std::vector<CameraPose>& poses) {
    poses_ = poses;
    if (tracking_) tracking_->set_poses(poses_);
  }

  void add_info(const std::string& camera, const CameraInfo& info) {
    if (tracking_) tracking_->add_info(camera, info);
    infos_[camera] = info;
  }
  void add_simulated(const MarkerObservations& message) {
    if (tracking_ && options_.use_simulated) tracking_->add_simulated(message);
  }
  void add_frame(const RgbdFrame& frame) {
    ++frames_[frame.camera];
    if (!tracking_) return;
    for (const auto& result : tracking_->add(frame)) on_result_(result);
  }
  void finish() {
    if (!tracking_) return;
    for (const auto& result : tracking_->finish()) on_result_(result);
  }

  const MarkerTracking* tracking() const { return tracking_.get(); }
  const std::vector<CameraPose>& poses() const { return poses_; }
  const TrackerSettings& settings() const { return settings_; }
  const std::map<std::string, long>& frames() const { return frames_; }

 private:
  NodeOptions options_;
  TrackerSettings settings_;
  OnResult on_result_;
  std::vector<CameraPose> poses_;
  std::map<std::string, CameraInfo> infos_;
  std::map<std::string, long> frames_;
  std::string scene_;
  std::unique_ptr<MarkerTracking> tracking_;
};

class TrackerNode {
 public:
  explicit TrackerNode(const NodeOptions& options);

 private:
  struct CameraSubscribers {
    message_filters::Subscriber<Image> colour, depth;
    ImagePair pair{kWaitingImages};
    ros::Subscriber info;
  };

  template <typename Action>
  void attempt(const std::string& what, Action action);
  void subscribe(const std::string& camera);
  void publish(const MarkerTracking::Result& result);
  void broadcast(const std::vector<CameraPose>& poses);
  bool calibrate_cameras(Calibrate::Request& request, Calibrate::Response& response);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  NodeOptions options_;
  TrackingInput input_;
  std::unique_ptr<CalibrationSession> calibration_;
  std::string problem_;              // the last, since the last diagnosis
  std::vector<std::string> lost_;    // as last reported
  std::vector<double> latencies_s_;  // from stamp to markers, since the last diagnosis

  ros::NodeHandle node_;
  ros::Publisher markers_, image_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<std::unique_ptr<CameraSubscribers>> cameras_;
  ros::ServiceServer calibrate_;
  tf2_ros::StaticTransformBroadcaster frames_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostics_timer_;
};

TrackerNode::TrackerNode(const NodeOptions& options)
    : options_(options), input_(options, [this](const auto& result) { publish(result); }) {
  markers_ = node_.advertise<MarkerObservations>(topics::tracker_markers, 10);
  image_ = node_.advertise<Image>(topics::tracker_image, 2);
  if (!options_.balls.empty()) {
    calibration_ = std::make_unique<CalibrationSession>(read_ball_placement(options_.balls), BallFinderSettings());
    calibrate_ = node_.advertiseService(topics::calibrate, &TrackerNode::calibrate_cameras, this);
  }
  broadcast(input_.poses());
  if (options_.scene.empty())
    subscribers_.push_back(node_.subscribe<std_msgs::String>(
        topics::simulator_scene, 1,
        [this](const std_msgs::String::ConstPtr& path) { attempt("scene", [&] { input_.start(path->data); }); }));
  subscribers_.push_back(node_.subscribe<MarkerObservations>(
      topics::simulator_markers, 60, [this](const MarkerObservations::ConstPtr& message) {
        attempt(topics::simulator_markers, [&] { input_.add_simulated(*message); });
      }));
  for (const std::string& camera : options_.tracking.cameras) subscribe(camera);
  diagnostics_.setHardwareID("cameras");
  diagnostics_.add("tracker", this, &TrackerNode::diagnose);
  diagnostics_timer_ =
      node_.createWallTimer(ros::WallDuration(1.0), [this](const auto&) { diagnostics_.force_update(); });
}

void TrackerNode::subscribe(const std::string& camera) {
  cameras_.push_back(std::make_unique<CameraSubscribers>());
  CameraSubscribers& subscribers = *cameras_.back();
  subscribers.info =
      node_.subscribe<CameraInfo>(info_topic(camera), 5, [this, camera](const CameraInfo::ConstPtr& info) {
        attempt(info_topic(camera), [&] {
          input_.add_info(camera, *info);
          if (calibration_) calibration_->set_camera({camera, camera_model(*info), Eigen::Isometry3d::Identity()});
        });
      });
  subscribers.colour.subscribe(node_, colour_topic(camera), kWaitingImages);
  subscribers.depth.subscribe(node_, depth_topic(camera), kWaitingImages);
  subscribers.pair.connectInput(subscribers.colour, subscribers.depth);
  const boost::function<void(const Image::ConstPtr&, const Image::ConstPtr&)> on_pair =
      [this, camera](const Image::ConstPtr& colour, const Image::ConstPtr& depth) {
        attempt(camera, [&] {
          const RgbdFrame frame = rgbd_frame(camera, *colour, *depth);
          if (calibration_) calibration_->add(frame);
          input_.add_frame(frame);
        });
      };
  subscribers.pair.registerCallback(boost::bind<void>(on_pair, boost::placeholders::_1, boost::placeholders::_2));
}

// Bad messages are told and counted; the next ones go on.
template <typename Action>
void TrackerNode::attempt(const std::string& what, Action action) {
  try {
    action();
  } catch (const std::exception& error) {
    problem_ = what + ": " + error.what();
    ROS_WARN_THROTTLE(1.0, "%s", problem_.c_str());
  }
}

void TrackerNode::publish(const MarkerTracking::Result& result) {
  markers_.publish(result.observations);
  latencies_s_.push_back((ros::Time::now() - result.observations.header.stamp).toSec());
  lost_ = result.report.lost;
  if (!result.report.problems.empty()) problem_ = result.report.problems.front();
  if (image_.getNumSubscribers() == 0) return;
  const RgbdFrame& frame = result.frames.front();
  const TrackerCamera& camera = input_.tracking()->cameras().at(frame.camera);
  RgbdFrame drawn = frame;
  drawn.colour = annotate(frame, camera, result.report, input_.settings().marker_radius_m);
  image_.publish(frame_messages(drawn, camera.model, result.observations.header.stamp).colour);
}

void TrackerNode::broadcast(const std::vector<CameraPose>& poses) {
  std::vector<geometry_msgs::TransformStamped> messages;
  for (const CameraPose& pose : poses)
    messages.push_back(transform_message(topics::world_frame, optical_frame(pose.name), pose.world_from_camera));
  if (!messages.empty()) frames_.sendTransform(messages);
}

bool TrackerNode::calibrate_cameras(Calibrate::Request& request, Calibrate::Response& response) {
  const std::vector<CameraPose> found = calibrate(request, *calibration_, options_.poses, response);
  if (!found.empty()) {
    input_.set_poses(found);
    broadcast(found);
  }
  if (!response.success) ROS_WARN("%s refused: %s", topics::calibrate, response.message.c_str());
  return true;
}

void TrackerNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using Status = diagnostic_msgs::DiagnosticStatus;
  const MarkerTracking* tracking = input_.tracking();
  if (!tracking) {
    status.summary(Status::WARN, "waits for a scene");
  } else if (tracking->cameras().empty()) {
    status.summary(Status::ERROR, "no camera has both a pose (" + options_.poses + ") and a camera_info");
  } else if (!problem_.empty()) {
    status.summary(Status::WARN, problem_);
  } else if (!lost_.empty()) {
    status.summary(Status::WARN, std::to_string(lost_.size()) + " markers are lost, the first is " + lost_.front());
  } else {
    status.summary(Status::OK, "all markers are followed");
  }
  for (const std::string& camera : options_.tracking.cameras) {
    const auto frames = input_.frames().find(camera);
    status.add(camera + " frames", frames == input_.frames().end() ? 0L : frames->second);
  }
  if (tracking) status.add("frames of cameras not known yet", tracking->unusable_frames());
  if (!latencies_s_.empty()) {
    std::sort(latencies_s_.begin(), latencies_s_.end());
    status.add("latency, median [ms]", 1e3 * latencies_s_[latencies_s_.size() / 2]);
    status.add("latency, worst [ms]", 1e3 * latencies_s_.back());
  }
  latencies_s_.clear();
  problem_.clear();
}

// Reads a recording in its own order; nothing waits for a clock.
void replay(const NodeOptions& options) {
  rosbag::Bag bag(options.bag, rosbag::bagmode::Read);
  rosbag::Bag output(options.output, rosbag::bagmode::Write);
  long written = 0;
  TrackingInput input(options, [&](const MarkerTracking::Result& result) {
    output.write("/" + std::string(topics::tracker_markers), result.observations.header.stamp, result.observations);
    ++written;
  });
  std::map<std::string, std::unique_ptr<ImagePair>> pairs;
  for (const std::string& camera : options.tracking.cameras) {
    pairs[camera] = std::make_unique<ImagePair>(kWaitingImages);
    const boost::function<void(const Image::ConstPtr&, const Image::ConstPtr&)> on_pair =
        [&input, camera](const auto& colour, const auto& depth) {
          input.add_frame(rgbd_frame(camera, *colour, *depth));
        };
    pairs[camera]->registerCallback(boost::bind<void>(on_pair, boost::placeholders::_1, boost::placeholders::_2));
  }
  const double start_s = cpu_time_s();
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    const std::string topic = message.getTopic().substr(message.getTopic().front() == '/' ? 1 : 0);
    if (topic == topics::simulator_markers) input.add_simulated(*message.instantiate<MarkerObservations>());
    if (topic == topics::simulator_scene && options.scene.empty())
      input.start(message.instantiate<std_msgs::String>()->data);
    for (auto& [camera, pair] : pairs) {
      if (topic == info_topic(camera)) input.add_info(camera, *message.instantiate<CameraInfo>());
      if (topic == colour_topic(camera)) pair->add<0>(ros::MessageEvent<Image const>(message.instantiate<Image>()));
      if (topic == depth_topic(camera)) pair->add<1>(ros::MessageEvent<Image const>(message.instantiate<Image>()));
    }
  }
  input.finish();
  ROS_INFO("%s: %ld times all markers, %.3f CPU-seconds", options.output.c_str(), written, cpu_time_s() - start_s);
  if (written == 0)
    throw std::runtime_error(options.bag + ": has no images of " + options.tracking.cameras.front() +
                             " that could be used: it needs images, camera_info and a scene");
}

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  using namespace soft_robot_lab;
  return run_node(argc, argv, "tracker", [] {
    const NodeOptions options = read_options(ros::NodeHandle("~"));
    if (!options.bag.empty()) return replay(options);
    const TrackerNode node(options);
    ros::spin();
  });
}
