// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <ros/ros.h>
#include <std_msgs/String.h>
#include <std_srvs/Trigger.h>

#include "read_parameter.h"
#include "run_node.h"
#include "ros/base/actuator_plugins.h"
#include "ros/messages/conversions.h"
#include "ros/base/latched_publisher.h"
#include "ros/messages/load_messages.h"
#include "ros/base/log_text.h"
#include "ros/base/node_diagnosis.h"
#include "ros/messages/message_limits.h"
#include "ros/display/surface_marker.h"
#include "ros/base/topics.h"
#include "session/live_twin.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kTwinAbout =
    R"(Estimates what acts on a resting robot from outside, by its drives and tracked markers, with a model of its own.
It moves nothing. The first rest is taken for an untouched one; twin/untouched takes the next.

Parameters: ~scene (path; absent where the simulator names which scene runs), ~markers_topic (of measured markers).)";

class TwinNode {
 public:
  TwinNode() {
    options_.actuator_factory = actuators_from_plugins();
    options_.interrupt = [] { return !ros::ok(); };
    const ros::NodeHandle parameters("~");
    std::string scene;
    if (read_parameter(parameters, "scene", scene)) load(scene);
    loads_publisher_ = node_.advertise<TwinLoads>(topics::twin_loads, 10, true);
    markers_publisher_ = node_.advertise<MarkerObservations>(topics::twin_markers, 10);
    arrows_publisher_ = node_.advertise<visualization_msgs::MarkerArray>(topics::twin_arrows, 10, true);
    subscribers_ = {
        node_.subscribe(topics::simulator_scene, 1, &TwinNode::on_scene, this),
        node_.subscribe(topics::simulator_actuators, 100, &TwinNode::on_actuators, this),
        node_.subscribe(text_parameter(parameters, "markers_topic", topics::tracker_markers), 100,
                        &TwinNode::on_markers, this),
    };
    untouched_server_ = node_.advertiseService(topics::twin_untouched, &TwinNode::on_untouched, this);
    diagnosis_.add("twin", [this](auto& status) { diagnose(status); });
    diagnosis_.start();
  }

 private:
  void load(const std::string& path) {
    Scene scene = load_scene(path, options_);
    auto twin = std::make_unique<LiveTwin>(*scene.simulation, LoadEstimationOptions{});
    twin_ = std::move(twin);  // first: it refers to the model
    model_ = std::move(scene.simulation);
    skin_ = std::make_unique<SurfaceMarker>(model_->body().mesh());
    path_ = path;
    words_.clear();
  }

  template <typename Action>
  void attempt(const char* topic, const Action& action) {
    try {
      action();
    } catch (const std::exception& error) {
      ROS_WARN_THROTTLE(5.0, "%s: %s", topic, log_text(error.what()).c_str());
    }
  }

  void on_scene(const std_msgs::String& path) {
    if (path.data == path_) return;
    attempt(topics::simulator_scene, [&] { load(path.data); });
  }

  void on_actuators(const ActuatorState& actuators) {
    if (!twin_) return;
    attempt(topics::simulator_actuators, [&] {
      require_in_limits(actuators);
      twin_->add_drives(actuators.header.stamp.toSec(), actuators.names, actuators.commands,
                        actuators.actuated_commands);
    });
  }

  void on_markers(const MarkerObservations& markers) {
    if (!twin_) return;
    attempt(topics::twin_loads, [&] {
      const auto estimate = twin_->add_markers(markers.header.stamp.toSec(), measured_markers(markers));
      if (!estimate) return;
      words_ = describe(*estimate);
      touched_ = estimate->kind != LoadKind::none;
      loads_publisher_.publish(load_message(*estimate, markers.header.stamp));
      markers_publisher_.publish(estimated_markers(*estimate, markers.header.stamp));
      arrows_publisher_.publish(load_arrows(*estimate, model_->body().size_m(), markers.header.stamp));
      const bool shown = !estimate->loads.empty();
      surface_.publish(shown ? twin_skin_of(skin_->message(twin_->estimated_state().positions_m, markers.header.stamp))
                             : no_twin_skin());
    });
  }

  bool on_untouched(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    response.success = twin_ != nullptr;
    response.message = twin_ ? "the next rest is taken for an untouched one" : "there is no scene yet";
    if (twin_) twin_->expect_untouched();
    return true;
  }

  void diagnose(NodeDiagnosis::Status& status) {
    using Status = NodeDiagnosis::Status;
    if (!twin_)
      status.summary(Status::WARN, "waits for a scene");
    else if (words_.empty())
      status.summary(Status::OK, "waits for the robot to rest");
    else
      status.summary(touched_ ? Status::WARN : Status::OK, words_);
  }

  SceneOptions options_;
  std::string path_;
  std::unique_ptr<Simulation> model_;
  std::unique_ptr<LiveTwin> twin_;
  std::unique_ptr<SurfaceMarker> skin_;
  std::string words_;  // of the last estimate
  bool touched_ = false;
  ros::NodeHandle node_;
  ros::Publisher loads_publisher_, markers_publisher_, arrows_publisher_;
  PresentPublisher<visualization_msgs::Marker> surface_{topics::twin_surface};
  std::vector<ros::Subscriber> subscribers_;
  ros::ServiceServer untouched_server_;
  NodeDiagnosis diagnosis_{"none"};
};

}  // namespace

int twin_node(int argc, char** argv) {
  return run_node(argc, argv, "twin", kTwinAbout, [] {
    const TwinNode node;
    ros::spin();
  });
}

}  // namespace soft_robot_lab
