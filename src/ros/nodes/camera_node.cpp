// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <soft_robot_lab/MoveCamera.h>
#include <std_srvs/SetBool.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "read_parameter.h"
#include "run_node.h"
#include "hardware/plant/plant.h"
#include "ros/cameras/camera_driver.h"
#include "ros/messages/frames.h"
#include "ros/messages/image_messages.h"
#include "ros/base/log_text.h"
#include "ros/base/node_diagnosis.h"
#include "ros/messages/message_limits.h"
#include "ros/cameras/rendered_rig.h"
#include "ros/base/topics.h"
#include "perception/calibration/calibration.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kCameraAbout = R"(Films the simulated robot with rendered RGB-D cameras, behind the topics of
realsense2_camera.

Parameters: ~cameras (path of a rig, config/cameras/*.yaml), ~seed (of the sensors' noise), ~balls (path: where the
calibration's balls are, instead of the rig's own), ~show_balls (them, from the start), ~max_rate_hz (slower than
the rig says, for machines with few cores), ~plant (path: by how much the cameras really stand elsewhere).)";

const Eigen::Vector3d kWhite(0.9, 0.9, 0.9);

struct CameraOptions {
  std::string cameras, balls, plant;
  int seed = 1;  // >= 0
  bool show_balls = false;
  double max_rate_hz = std::numeric_limits<double>::infinity();  // > 0

  void validate() const {
    if (seed < 0) throw std::invalid_argument("seed: " + std::to_string(seed) + " is not in [0, 2147483647]");
    if (!(max_rate_hz > 0.0))
      throw std::invalid_argument("max_rate_hz: " + std::to_string(max_rate_hz) + " is not in (0, inf)");
  }
};

CameraOptions read_camera_options(const ros::NodeHandle& node) {
  CameraOptions options;
  options.cameras = required_text(node, "cameras", "the path of a rig of cameras");
  read_parameter(node, "seed", options.seed);
  read_parameter(node, "balls", options.balls);
  read_parameter(node, "show_balls", options.show_balls);
  read_parameter(node, "max_rate_hz", options.max_rate_hz);
  read_parameter(node, "plant", options.plant);
  options.validate();
  return options;
}

std::vector<Ball> white_balls(const BallPlacement& placement) {
  std::vector<Ball> balls;
  for (const PlacedBall& ball : placement.balls) balls.push_back({ball.position_m, placement.radius_m, kWhite});
  return balls;
}

CameraSetup read_rig(const CameraOptions& options) {
  CameraSetup rig = read_camera_setup(options.cameras);
  if (!options.balls.empty()) rig.calibration_balls = white_balls(read_ball_placement(options.balls));
  if (!options.plant.empty()) rig = load_plant(options.plant).shifted(std::move(rig));
  for (RigCamera& camera : rig.cameras) camera.rate_hz = std::min(camera.rate_hz, options.max_rate_hz);
  return rig;
}

class CameraPublishers {
 public:
  CameraPublishers(ros::NodeHandle node, const std::string& camera)
      : colour_(node.advertise<sensor_msgs::Image>(camera + "/color/image_raw", 2)),
        depth_(node.advertise<sensor_msgs::Image>(camera + "/aligned_depth_to_color/image_raw", 2)),
        colour_info_(node.advertise<sensor_msgs::CameraInfo>(camera + "/color/camera_info", 2)),
        depth_info_(node.advertise<sensor_msgs::CameraInfo>(camera + "/aligned_depth_to_color/camera_info", 2)),
        descriptions_(
            node.advertise<dynamic_reconfigure::ConfigDescription>(parameter_descriptions_topic(camera), 1, true)),
        updates_(node.advertise<dynamic_reconfigure::Config>(parameter_updates_topic(camera), 1, true)) {}

  void describe(const CameraSettingLimits& limits, const CameraSetting& own) const {
    descriptions_.publish(description_message(limits, own));
  }
  void publish(const CameraSetting& setting) const { updates_.publish(config_message(setting)); }

  bool wanted() const {
    return colour_.getNumSubscribers() + depth_.getNumSubscribers() + colour_info_.getNumSubscribers() +
               depth_info_.getNumSubscribers() >
           0;
  }
  void publish(const FrameMessages& messages) const {
    colour_info_.publish(messages.info);
    depth_info_.publish(messages.info);
    colour_.publish(messages.colour);
    depth_.publish(messages.depth);
  }

 private:
  ros::Publisher colour_, depth_, colour_info_, depth_info_, descriptions_, updates_;
};

class CameraNode {
 public:
  explicit CameraNode(const CameraOptions& options);
  void run();

 private:
  void film();
  template <typename Message>
  void add(const Message& message, void (SeenRobotStates::*add)(const Message&));
  void publish_true_poses();
  void serve_settings(std::size_t camera);
  bool show_balls(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);
  bool move(MoveCamera::Request& request, MoveCamera::Response& response);
  void diagnose(NodeDiagnosis::Status& status);

  RenderedRig rig_;
  SeenRobotStates robot_;
  std::string refusal_;  // the last of a message from the simulator, since the last diagnosis
  long reported_dropped_ = 0;

  ros::NodeHandle node_;
  std::vector<CameraPublishers> publishers_;  // as rig_.cameras()
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  tf2_ros::StaticTransformBroadcaster true_poses_;
  NodeDiagnosis diagnosis_{"rendered"};
};

CameraNode::CameraNode(const CameraOptions& options)
    : rig_(read_rig(options), static_cast<std::uint64_t>(options.seed)) {
  rig_.show_balls(options.show_balls);
  for (std::size_t i = 0; i < rig_.cameras().size(); ++i) {
    publishers_.emplace_back(node_, rig_.cameras()[i].pose.name);
    serve_settings(i);
  }
  publish_true_poses();
  // Deep enough for what arrives while frames are rendered.
  subscribers_ = {
      node_.subscribe<MarkerObservations>(
          topics::simulator_markers, 60,
          [this](const MarkerObservations::ConstPtr& m) { add(*m, &SeenRobotStates::add_markers); }),
      node_.subscribe<visualization_msgs::Marker>(
          topics::simulator_surface, 10,
          [this](const visualization_msgs::Marker::ConstPtr& m) { add(*m, &SeenRobotStates::add_surface); }),
  };
  services_.push_back(node_.advertiseService(topics::show_balls, &CameraNode::show_balls, this));
  services_.push_back(node_.advertiseService(topics::move_camera, &CameraNode::move, this));
  diagnosis_.add("rendered cameras", [this](auto& status) { diagnose(status); });
  diagnosis_.start();
}

void CameraNode::run() {
  while (ros::ok()) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
    try {
      film();
    } catch (const std::exception& error) {  // of what a message or a request asks for: the session goes on without it
      refusal_ = error.what();
      ROS_ERROR_THROTTLE(1.0, "%s", log_text(error.what()).c_str());
    }
  }
}

void CameraNode::film() {
  const auto frames = rig_.take_due(robot_, [this](std::size_t camera) { return publishers_[camera].wanted(); });
  for (const TakenFrame& taken : frames)
    publishers_[taken.camera].publish(frame_messages(taken.frame, rig_.cameras()[taken.camera].model, taken.stamp));
}

template <typename Message>
void CameraNode::add(const Message& message, void (SeenRobotStates::*add_message)(const Message&)) {
  try {
    (robot_.*add_message)(message);
  } catch (const std::invalid_argument& error) {
    refusal_ = error.what();
    ROS_WARN_THROTTLE(1.0, "%s", log_text(error.what()).c_str());
  }
}

// Under names that no tracker uses: it has to find the poses by itself.
void CameraNode::publish_true_poses() {
  std::vector<geometry_msgs::TransformStamped> poses;
  for (const RigCamera& camera : rig_.cameras())
    poses.push_back(
        transform_message(world_frame(), optical_frame("truth/" + camera.pose.name), camera.pose.world_from_camera));
  true_poses_.sendTransform(poses);
}

// As realsense2_camera's: what is out of range is cut, and the answer is what holds now.
void CameraNode::serve_settings(std::size_t camera) {
  using Reconfigure = dynamic_reconfigure::Reconfigure;
  publishers_[camera].describe({}, rig_.setting(camera));
  publishers_[camera].publish(rig_.setting(camera));
  services_.push_back(node_.advertiseService<Reconfigure::Request, Reconfigure::Response>(
      set_parameters_service(rig_.cameras()[camera].pose.name),
      [this, camera](Reconfigure::Request& request, Reconfigure::Response& response) {
        rig_.set(camera, with_request(rig_.setting(camera), request.config, {}));
        publishers_[camera].publish(rig_.setting(camera));
        response.config = config_message(rig_.setting(camera));
        return true;
      }));
}

bool CameraNode::show_balls(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
  rig_.show_balls(request.data);
  response.success = true;
  response.message = request.data ? "the rig's calibration balls are shown" : "calibration balls are hidden";
  return true;
}

bool CameraNode::move(MoveCamera::Request& request, MoveCamera::Response& response) {
  const auto vector = [](const geometry_msgs::Vector3& v) { return Eigen::Vector3d(v.x, v.y, v.z); };
  try {
    require_in_limits<MoveCamera::Request>(request);
    const RigCamera& camera = rig_.move(request.name, vector(request.translation), vector(request.rotation));
    publish_true_poses();
    std::ostringstream text;
    text << request.name << " stands at [" << camera.pose.world_from_camera.translation().transpose() << "] m";
    response.success = true;
    response.message = text.str();
  } catch (const std::invalid_argument& error) {
    response.message = answer_text(error);
    ROS_WARN("%s refused: %s", topics::move_camera, log_text(error.what()).c_str());
  }
  return true;
}

void CameraNode::diagnose(NodeDiagnosis::Status& status) {
  using Status = diagnostic_msgs::DiagnosticStatus;
  long dropped = 0;
  for (std::size_t i = 0; i < rig_.cameras().size(); ++i) dropped += rig_.counts(i).dropped;
  if (!refusal_.empty())
    status.summary(Status::WARN, refusal_);
  else if (dropped > reported_dropped_)
    status.summary(Status::WARN, "frames dropped in the last second: " + std::to_string(dropped - reported_dropped_));
  else
    status.summary(Status::OK, "renders what is subscribed to");
  for (std::size_t i = 0; i < rig_.cameras().size(); ++i) {
    const FrameCounts& counts = rig_.counts(i);
    const std::string& name = rig_.cameras()[i].pose.name;
    status.add(name + " frames", counts.taken);
    status.add(name + " dropped frames", counts.dropped);
    status.add(name + " CPU time per frame [ms]",
               counts.taken > 0 ? 1000.0 * counts.cpu_s / static_cast<double>(counts.taken) : 0.0);
  }
  reported_dropped_ = dropped;
  refusal_.clear();
}

}  // namespace

int camera_node(int argc, char** argv) {
  return run_node(argc, argv, "cameras", kCameraAbout, [] {
    CameraNode node(read_camera_options(ros::NodeHandle("~")));
    node.run();
  });
}

}  // namespace soft_robot_lab
