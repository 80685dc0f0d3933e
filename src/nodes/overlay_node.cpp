// Draws markers, cables, target and error for rviz from what the session publishes.
#include <ros/ros.h>

#include "soft_robot_lab/ros/overlay.h"
#include "soft_robot_lab/ros/topics.h"

namespace soft_robot_lab {
namespace {

class OverlayNode {
 public:
  OverlayNode() {
    ros::NodeHandle node;
    publisher_ = node.advertise<visualization_msgs::MarkerArray>(topics::overlay, 1);
    subscribers_ = {
        node.subscribe(topics::simulator_markers, 1, &OverlayNode::on_simulated, this),
        node.subscribe(topics::tracker_markers, 1, &OverlayNode::on_measured, this),
        node.subscribe(topics::simulator_actuators, 1, &OverlayNode::on_actuators, this),
        node.subscribe(topics::controller_target, 1, &OverlayNode::on_target, this),
    };
  }

 private:
  void on_simulated(const MarkerObservations& markers) {
    inputs_.simulated = markers;
    publish(markers.header.stamp);
  }
  void on_measured(const MarkerObservations& markers) {
    inputs_.measured = markers;
    publish(markers.header.stamp);
  }
  void on_actuators(const ActuatorState& actuators) { inputs_.actuators = actuators; }
  void on_target(const Target& target) { inputs_.target = target; }

  void publish(const ros::Time& stamp) {
    const double age_s = (stamp - published_).toSec();
    if (age_s >= 0.0 && age_s < period_s) return;
    published_ = stamp;
    publisher_.publish(overlay_of(inputs_, options_, stamp));
  }

  static constexpr double period_s = 1.0 / 15.0;
  OverlayInputs inputs_;
  OverlayOptions options_;
  ros::Time published_;
  ros::Publisher publisher_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  ros::init(argc, argv, "overlay");
  soft_robot_lab::OverlayNode node;
  ros::spin();
}
