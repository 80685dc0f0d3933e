// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>

#include <ros/ros.h>
#include <std_msgs/String.h>
#include <tf2_ros/transform_broadcaster.h>

#include "read_parameter.h"
#include "run_node.h"
#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "ros/tracking/gap_meter.h"
#include "ros/messages/image_messages.h"
#include "ros/base/log_text.h"
#include "ros/messages/message_limits.h"
#include "ros/display/overlay.h"
#include "ros/display/robot_image.h"
#include "ros/base/stamps.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kOverlayAbout =
    R"(Draws markers, cables, target and error for rviz from what the session publishes,
compares tracked with simulated markers, publishes both as frames, and draws the simulated robot over what a camera sees of it, close up.

Parameters: ~camera (whose image is drawn over, where the tracker believes it; absent: none).)";

class OverlayNode {
 public:
  OverlayNode() {
    ros::NodeHandle node;
    publisher_ = node.advertise<visualization_msgs::MarkerArray>(topics::overlay, 1);
    label_publisher_ = node.advertise<visualization_msgs::MarkerArray>(topics::overlay_labels, 1);
    gap_publisher_ = node.advertise<RealityGap>(topics::reality_gap, 100);
    // A message lost here and not by a recorder makes another gap than its replay: none is, in 16 s at 60 Hz.
    subscribers_ = {
        node.subscribe(topics::simulator_markers, 1000, &OverlayNode::on_simulated, this),
        node.subscribe(topics::tracker_markers, 1000, &OverlayNode::on_measured, this),
        node.subscribe(topics::simulator_actuators, 1, &OverlayNode::on_actuators, this),
        node.subscribe(topics::controller_target, 1, &OverlayNode::on_target, this),
        node.subscribe(topics::simulator_contacts, 1, &OverlayNode::on_contacts, this),
        node.subscribe(topics::simulator_scene, 1, &OverlayNode::on_scene, this),
    };
    const std::string camera = text_parameter(ros::NodeHandle("~"), "camera");
    if (!camera.empty()) image_.emplace(node, camera);
  }

 private:
  void on_simulated(const MarkerObservations& markers) {
    attempt([&] {
      gap_.add_simulated(markers);
      inputs_.simulated = markers;
      publish(markers.header.stamp);
      broadcast(markers, "simulated/", simulated_stamp_);
    });
  }
  void on_measured(const MarkerObservations& markers) {
    attempt([&] {
      gap_.add_measured(markers);
      inputs_.measured = markers;
      publish(markers.header.stamp);
      broadcast(markers, "tracked/", tracked_stamp_);
    });
  }
  // Bad messages stand in the log; the next ones go on.
  template <typename Action>
  void attempt(const Action& action) const {
    try {
      action();
    } catch (const std::exception& error) {
      ROS_WARN_THROTTLE(5.0, "%s: %s", topics::overlay, log_text(error.what()).c_str());
    }
  }
  void on_gap(const RealityGap& gap) {
    if (!is_in_limits<RealityGap>(gap)) return;
    inputs_.gap = gap;
    if (image_) image_->show_gap(gap);
    gap_publisher_.publish(gap);
  }
  void on_actuators(const ActuatorState& actuators) {
    if (is_in_limits<ActuatorState>(actuators)) inputs_.actuators = actuators;
  }
  void on_contacts(const Contacts& contacts) {
    if (is_in_limits<Contacts>(contacts)) inputs_.contacts = contacts;
  }
  void on_target(const Target& target) {
    if (!is_in_limits<Target>(target)) return;
    inputs_.target = target;
    if (target.marker.empty()) inputs_.target.reset();
  }
  // Nothing stays of another robot but what cameras see. The first one's target may have been heard before.
  void on_scene(const std_msgs::String& scene) {
    if (!scene_.empty()) {
      inputs_ = OverlayInputs{{}, inputs_.measured, {}, {}, {}, {}};
      overlay_.forget();
      if (image_) image_->show_gap(std::nullopt);
    }
    scene_ = scene.data;
  }
  void publish(const ros::Time& stamp) {
    const double age_s = seconds_between(published_, stamp);
    if (age_s >= 0.0 && age_s < period_s) return;
    published_ = stamp;
    const DrawnOverlay drawn = overlay_.draw(inputs_, stamp);
    publisher_.publish(drawn.shapes);
    label_publisher_.publish(drawn.labels);
  }

  // As frames that are not turned. `stamp`: of the last that were sent.
  void broadcast(const MarkerObservations& markers, const std::string& kind, ros::Time& stamp) {
    const double age_s = seconds_between(stamp, markers.header.stamp);
    if (age_s >= 0.0 && age_s < period_s) return;
    stamp = markers.header.stamp;
    std::vector<geometry_msgs::TransformStamped> frames;
    for (std::size_t i = 0; i < markers.names.size(); ++i) {
      const Eigen::Translation3d place(from_message(markers.positions.at(i), "positions"));
      frames.push_back(
          transform_message(robot_frame(), frame_prefix() + kind + markers.names[i], Eigen::Isometry3d(place)));
      frames.back().header.stamp = stamp;
    }
    marker_frames_.sendTransform(frames);
  }

  static constexpr double period_s = 1.0 / 15.0;
  std::string scene_;
  OverlayInputs inputs_;
  Overlay overlay_;
  GapMeter gap_{[this](const RealityGap& gap) { on_gap(gap); }};
  std::optional<RobotImage> image_;
  ros::Time published_, simulated_stamp_, tracked_stamp_;
  tf2_ros::TransformBroadcaster marker_frames_;
  ros::Publisher publisher_, label_publisher_, gap_publisher_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace

int overlay_node(int argc, char** argv) {
  return run_node(argc, argv, "overlay", kOverlayAbout, [] {
    OverlayNode node;
    ros::spin();
  });
}

}  // namespace soft_robot_lab
