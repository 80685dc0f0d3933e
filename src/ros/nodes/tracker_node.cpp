// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <message_filters/subscriber.h>
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "read_parameter.h"
#include "run_node.h"
#include "perception/tracking/annotate.h"
#include "ros/base/log_text.h"
#include "ros/base/node_diagnosis.h"
#include "ros/base/topics.h"
#include "ros/cameras/calibration_service.h"
#include "ros/cameras/camera_diagnosis.h"
#include "ros/messages/frames.h"
#include "ros/messages/image_messages.h"
#include "ros/recording/replay_tracking.h"
#include "ros/tracking/tracker_parameter_server.h"
#include "ros/tracking/tracking_input.h"
#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kTrackerAbout =
    R"(Follows the robot's markers with RGB-D cameras: images in, tracker/markers out. From
a session, or from a recording as fast as it can be read (~bag), with the same output.

Parameters: ~cameras (list of names: the topics' first parts), ~tracker (path of the tracker's settings), ~poses
(path: where the cameras stand; a calibration writes it), ~default_poses (path, read while there is no such file),
~scene (path; absent where simulator/scene names it), ~use_simulated (simulated markers say where to look first),
~balls (path of the calibration's balls; absent: no calibration), ~bag and ~output (paths: a recording to read, and
a bag to write).)";

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;
using TrackerStatus = NodeDiagnosis::Status;

struct NodeOptions {
  TrackingInputOptions input;
  std::string balls, bag, output;
};

NodeOptions read_tracker_options(const ros::NodeHandle& node) {
  NodeOptions options;
  TrackingInputOptions& input = options.input;
  read_parameter(node, "cameras", input.tracking.cameras);
  read_parameter(node, "sync_tolerance_s", input.tracking.sync_tolerance_s);
  read_parameter(node, "sync_timeout_s", input.tracking.sync_timeout_s);
  input.tracker = required_text(node, "tracker", "the path of its settings");
  input.poses = required_text(node, "poses", "the path of the cameras' poses");
  read_parameter(node, "default_poses", input.default_poses);
  read_parameter(node, "scene", input.scene);
  read_parameter(node, "use_simulated", input.use_simulated);
  read_parameter(node, "balls", options.balls);
  read_parameter(node, "bag", options.bag);
  read_parameter(node, "output", options.output);
  if (!options.bag.empty() && options.output.empty())
    throw std::invalid_argument("output: missing; give the path of the bag to write, beside bag");
  return options;
}

class TrackerNode {
 public:
  explicit TrackerNode(const NodeOptions& options);

 private:
  struct Camera {
    explicit Camera(const std::string& name) : diagnosis(name) {}
    message_filters::Subscriber<Image> colour, depth;
    std::unique_ptr<ImagePair> pair;
    ros::Subscriber info;
    CameraDiagnosis diagnosis;
    int silent = 0;  // diagnoses without an image
    bool warned = false;
  };

  template <typename Action>
  bool attempt(const std::string& what, Action action);
  void subscribe(const std::string& camera);
  void pair_up(const std::string& camera);
  void on_pair(const std::string& camera, const Image& colour, const Image& depth);
  void on_result(const MarkerTracking::Result& result);
  void publish_image(const MarkerTracking::Result& result) const;
  void report_displaced_cameras();
  std::string words_of(const CameraWarning& warning) const;
  void broadcast(const std::vector<CameraPose>& poses);
  void diagnose(TrackerStatus& status);
  void diagnose_camera(const std::string& camera, TrackerStatus& status);
  void warn_of(const std::string& camera, const std::string& message);
  void diagnose_places(TrackerStatus& status);

  struct SinceDiagnosis {
    std::string problem;              // the last
    std::vector<double> latencies_s;  // from stamp to markers
  };

  NodeOptions options_;
  TrackingInput input_;
  SinceDiagnosis since_;
  std::vector<std::string> lost_;                    // as last reported
  std::vector<std::vector<std::string>> displaced_;  // named in the log

  ros::NodeHandle node_;
  ros::Publisher markers_, steps_, image_;
  std::vector<ros::Subscriber> subscribers_;
  std::map<std::string, std::unique_ptr<Camera>> cameras_;
  std::unique_ptr<CalibrationService> calibration_;
  TrackerParameterServer parameters_{input_.settings(),
                                     [this](const auto& settings) { input_.set_settings(settings); }};
  tf2_ros::StaticTransformBroadcaster frames_;
  NodeDiagnosis diagnosis_{"cameras"};
};

TrackerNode::TrackerNode(const NodeOptions& options)
    : options_(options), input_(options.input, [this](const auto& result) { on_result(result); }) {
  markers_ = node_.advertise<MarkerObservations>(topics::tracker_markers, 100);
  steps_ = node_.advertise<TrackerUpdateLog>(topics::tracker_steps, 100);
  image_ = node_.advertise<Image>(topics::tracker_image, 2);
  if (!options_.balls.empty())
    calibration_ = std::make_unique<CalibrationService>(node_, options_.balls, options_.input.poses,
                                                        [this](const std::vector<CameraPose>& found) {
                                                          input_.set_poses(found);
                                                          broadcast(found);
                                                        });
  if (!input_.poses_file().empty()) ROS_INFO("the cameras stand as %s says", input_.poses_file().c_str());
  broadcast(input_.poses());
  if (options_.input.scene.empty())
    subscribers_.push_back(node_.subscribe<std_msgs::String>(
        topics::simulator_scene, 1,
        [this](const std_msgs::String::ConstPtr& path) { attempt("scene", [&] { input_.start(path->data); }); }));
  subscribers_.push_back(node_.subscribe<MarkerObservations>(
      topics::simulator_markers, 60, [this](const MarkerObservations::ConstPtr& message) {
        attempt(topics::simulator_markers, [&] { input_.add_simulated(*message); });
      }));
  diagnosis_.add("tracker", [this](TrackerStatus& status) { diagnose(status); });
  diagnosis_.add("places of cameras", [this](TrackerStatus& status) { diagnose_places(status); });
  for (const std::string& camera : options_.input.tracking.cameras) {
    subscribe(camera);
    diagnosis_.add(camera, [this, camera](TrackerStatus& status) { diagnose_camera(camera, status); });
  }
  diagnosis_.start();
}

void TrackerNode::subscribe(const std::string& name) {
  Camera& camera = *(cameras_[name] = std::make_unique<Camera>(name));
  camera.info = node_.subscribe<CameraInfo>(info_topic(name), 5, [this, name](const CameraInfo::ConstPtr& info) {
    const bool usable = attempt(name, [&] {
      input_.add_info(name, *info);
      if (calibration_) calibration_->session().set_camera({name, camera_model(*info), Eigen::Isometry3d::Identity()});
    });
    if (!usable) cameras_.at(name)->diagnosis.failed(since_.problem);
  });
  camera.colour.subscribe(node_, colour_topic(name), waiting_images);
  camera.depth.subscribe(node_, depth_topic(name), waiting_images);
  camera.colour.registerCallback([&camera](const Image::ConstPtr&) { camera.diagnosis.colour_came(); });
  camera.depth.registerCallback([&camera](const Image::ConstPtr&) { camera.diagnosis.depth_came(); });
  pair_up(name);
}

// Pairs nothing that is older than its last pair.
void TrackerNode::pair_up(const std::string& name) {
  Camera& camera = *cameras_.at(name);
  camera.pair = std::make_unique<ImagePair>(waiting_images);
  camera.pair->connectInput(camera.colour, camera.depth);
  const boost::function<void(const Image::ConstPtr&, const Image::ConstPtr&)> paired =
      [this, name](const Image::ConstPtr& colour, const Image::ConstPtr& depth) { on_pair(name, *colour, *depth); };
  camera.pair->registerCallback(boost::bind<void>(paired, boost::placeholders::_1, boost::placeholders::_2));
}

void TrackerNode::on_pair(const std::string& camera, const Image& colour, const Image& depth) {
  CameraDiagnosis& diagnosis = cameras_.at(camera)->diagnosis;
  diagnosis.frame_came();
  const bool usable = attempt(camera, [&] {
    const RgbdFrame frame = rgbd_frame(camera, colour, depth);
    if (calibration_) calibration_->session().add(frame);
    input_.add_frame(frame);
  });
  if (!usable) diagnosis.failed(since_.problem);
}

// Whether it could be done. Bad messages are logged and counted; the next ones go on.
template <typename Action>
bool TrackerNode::attempt(const std::string& what, Action action) {
  try {
    action();
    return true;
  } catch (const std::exception& error) {
    since_.problem = what + ": " + error.what();
    ROS_WARN_THROTTLE(1.0, "%s", log_text(since_.problem).c_str());
    return false;
  }
}

void TrackerNode::on_result(const MarkerTracking::Result& result) {
  const TrackerReport& report = result.report;
  for (const CameraProblem& problem : report.problems) {
    if (problem.silent && !since_.problem.empty()) continue;  // why it has not is already logged
    since_.problem = problem.message;
    ROS_WARN_THROTTLE(1.0, "%s", log_text(since_.problem).c_str());
    if (problem.silent) continue;  // its own diagnosis finds that out
    cameras_.at(problem.camera)->diagnosis.failed(problem.message);
  }
  if (!report.updated) return;
  markers_.publish(result.observations);
  steps_.publish(result.step);
  since_.latencies_s.push_back(ros::Time::now().toSec() - result.observations.header.stamp.toSec());
  lost_ = report.lost;
  for (auto& [name, camera] : cameras_) {
    const auto own = std::count_if(report.sights.begin(), report.sights.end(),
                                   [name = name](const CameraObservation& sight) { return sight.camera == name; });
    camera->diagnosis.tracked(static_cast<std::size_t>(own), report.sights.size());
  }
  report_displaced_cameras();
  if (image_.getNumSubscribers() > 0) publish_image(result);
}

void TrackerNode::publish_image(const MarkerTracking::Result& result) const {
  const RgbdFrame& frame = result.frames.front();
  const TrackerCamera& camera = input_.tracking()->cameras().at(frame.camera);
  RgbdFrame drawn = frame;
  drawn.colour = annotate(frame, camera, result.report, input_.settings().marker_radius_m);
  image_.publish(frame_messages(drawn, camera.model, result.observations.header.stamp).colour);
}

// What was never calibrated was not moved.
std::string TrackerNode::words_of(const CameraWarning& warning) const {
  return input_.calibrated() ? warning.message : "not calibrated yet: " + warning.difference + " Calibrate.";
}

// Each once, when it begins. That cameras stand about where they are meant to is no fault before they are calibrated.
void TrackerNode::report_displaced_cameras() {
  std::vector<std::vector<std::string>> displaced;
  for (const CameraWarning& warning : input_.tracking()->watch().warnings()) {
    displaced.push_back(warning.cameras);
    if (std::find(displaced_.begin(), displaced_.end(), warning.cameras) == displaced_.end())
      ROS_LOG(input_.calibrated() ? ros::console::levels::Warn : ros::console::levels::Info, ROSCONSOLE_DEFAULT_NAME,
              "%s", words_of(warning).c_str());
  }
  displaced_ = std::move(displaced);
}

void TrackerNode::broadcast(const std::vector<CameraPose>& poses) {
  std::vector<geometry_msgs::TransformStamped> messages;
  for (const CameraPose& pose : poses)
    messages.push_back(transform_message(world_frame(), optical_frame(pose.name), pose.world_from_camera));
  if (!messages.empty()) frames_.sendTransform(messages);
}

void TrackerNode::diagnose(TrackerStatus& status) {
  const MarkerTracking* tracking = input_.tracking();
  if (!tracking) {
    status.summary(TrackerStatus::WARN, "waits for a scene");
  } else if (tracking->cameras().empty()) {
    status.summary(TrackerStatus::ERROR, "no camera can be used: of none both its pose and its lens are known");
  } else if (!since_.problem.empty()) {
    status.summary(TrackerStatus::WARN, since_.problem);
  } else if (since_.latencies_s.empty()) {
    status.summary(TrackerStatus::ERROR, "no images could be used in the last second");
  } else if (!lost_.empty()) {
    status.summary(TrackerStatus::WARN,
                   std::to_string(lost_.size()) + " markers are lost, the first is " + lost_.front());
  } else {
    status.summary(TrackerStatus::OK, "all markers are followed");
  }
  if (tracking) status.add("frames of cameras not known yet", tracking->unusable_frames());
  if (!since_.latencies_s.empty()) {
    status.add("latency, median [ms]", 1e3 * median(since_.latencies_s));
    status.add("latency, worst [ms]", 1e3 * quantile(since_.latencies_s, 1));
  }
  since_ = {};
}

void TrackerNode::diagnose_camera(const std::string& camera, TrackerStatus& status) {
  CameraDiagnosis& diagnosis = cameras_.at(camera)->diagnosis;
  if (diagnosis.unpaired()) pair_up(camera);  // as where the clock was set back
  const auto finding = diagnosis.diagnose(NodeDiagnosis::period_s, input_.missing(camera));
  using Level = CameraDiagnosis::Level;
  status.summary(finding.level == Level::ok        ? TrackerStatus::OK
                 : finding.level == Level::warning ? TrackerStatus::WARN
                                                   : TrackerStatus::ERROR,
                 finding.message);
  status.add("frames", diagnosis.all_frames());
  if (finding.level == Level::error) warn_of(camera, finding.message);
}

// Once for each camera that no image ever came of. Where others publish and it does not, most likely its name is wrong;
// else it may still start, as rendered cameras do while their robot is meshed.
void TrackerNode::warn_of(const std::string& camera, const std::string& message) {
  constexpr int patience = 5, starting = 60;  // diagnoses
  Camera& own = *cameras_.at(camera);
  if (own.warned || own.diagnosis.all_frames() > 0 || ++own.silent < patience) return;
  const std::string end = "/color/camera_info";
  std::string others;
  bool publishes = false;
  ros::master::V_TopicInfo published;
  ros::master::getTopics(published);
  for (const ros::master::TopicInfo& topic : published) {
    if (topic.name.size() <= end.size() || topic.name.compare(topic.name.size() - end.size(), end.size(), end) != 0)
      continue;
    others += " " + topic.name.substr(0, topic.name.size() - end.size());
    publishes = publishes || topic.name == node_.resolveName(info_topic(camera));
  }
  if ((others.empty() || publishes) && own.silent < starting) return;
  own.warned = true;
  ROS_WARN("camera '%s': %s Cameras that publish:%s. The session's argument camera_names chooses.", camera.c_str(),
           log_text(message).c_str(), others.empty() ? " none" : others.c_str());
}

// Whether a camera was displaced.
void TrackerNode::diagnose_places(TrackerStatus& status) {
  const MarkerTracking* tracking = input_.tracking();
  std::string unwatched;
  for (const std::string& camera : options_.input.tracking.cameras)
    if (!tracking || tracking->watch().watched().count(camera) == 0)
      unwatched += (unwatched.empty() ? "" : ", ") + camera;
  status.summary(TrackerStatus::OK,
                 unwatched.empty() ? "what all cameras see agrees"
                                   : "not watched, for want of markers that another camera sees too: " + unwatched);
  if (!tracking) return;
  for (const CameraWarning& warning : tracking->watch().warnings())
    status.mergeSummary(TrackerStatus::WARN, words_of(warning));
}

void print(const ReplaySummary& summary, const std::string& output) {
  ROS_INFO("%s: %ld times all markers, %.3f CPU-seconds", output.c_str(), summary.written, summary.cpu_s);
  for (const auto& [marker, times] : summary.seen)
    ROS_INFO("%s was seen %ld of %ld times", log_text(marker).c_str(), times, summary.written);
  for (const std::string& note : summary.notes) ROS_WARN("%s", log_text(note).c_str());
  if (!summary.repeated) return;
  ROS_INFO("%ld times markers and %ld gaps are the session's to the last digit, %ld and %ld are not",
           summary.markers_alike, summary.gaps_alike, summary.markers_other, summary.gaps_other);
  if (summary.without_images > 0)
    ROS_WARN("%ld of the tracker's steps were left out: the recording lacks their images", summary.without_images);
  ROS_INFO("%ld times the filters' state was taken from the recording, else from the step before", summary.resumed);
}

}  // namespace

int tracker_node(int argc, char** argv) {
  return run_node(argc, argv, "tracker", kTrackerAbout, [] {
    const NodeOptions options = read_tracker_options(ros::NodeHandle("~"));
    if (!options.bag.empty()) {
      print(replay_tracking(options.input, options.bag, options.output), options.output);
      return;
    }
    const TrackerNode node(options);
    ros::spin();
  });
}

}  // namespace soft_robot_lab
