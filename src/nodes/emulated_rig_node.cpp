// Tells where the shafts of an emulated rig really are, and passes requests for faults on to it.
//
// Parameters: ~rig (path), ~control (the emulator's socket), ~reality (path: the backlash that its motors really have;
// absent: none).
#include <memory>
#include <stdexcept>
#include <string>

#include <ros/ros.h>
#include <soft_robot_lab/RigCommand.h>

#include "nodes/run_node.h"
#include "soft_robot_lab/motor/rig_settings.h"
#include "soft_robot_lab/rig/reality.h"
#include "soft_robot_lab/rig/rig_control.h"
#include "soft_robot_lab/ros/motor_messages.h"
#include "soft_robot_lab/ros/topics.h"

namespace soft_robot_lab {
namespace {

std::string required(const ros::NodeHandle& node, const std::string& name) {
  std::string value;
  if (!node.getParam(name, value)) throw std::invalid_argument(name + ": missing");
  return value;
}

// The emulator may still be starting.
std::unique_ptr<RigControl> connect(const std::string& path) {
  const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(10.0);
  while (true) {
    try {
      return std::make_unique<RigControl>(path);
    } catch (const std::runtime_error&) {
      if (!ros::ok() || ros::WallTime::now() > limit) throw;
    }
    ros::WallDuration(0.05).sleep();
  }
}

class EmulatedRigNode {
 public:
  explicit EmulatedRigNode(const ros::NodeHandle& node)
      : rig_(load_rig(required(node, "rig"))), control_(connect(required(node, "control"))) {
    if (const auto path = node.param<std::string>("reality", ""); !path.empty()) set_backlash(load_reality(path));
    shafts_ = node_.advertise<ShaftState>(topics::rig_shafts, 10);
    command_ = node_.advertiseService(topics::rig_command, &EmulatedRigNode::command, this);
    timer_ = node_.createWallTimer(ros::WallDuration(0.01), [this](const auto&) { publish(); });
  }

 private:
  void set_backlash(const RealitySettings& reality) {
    for (std::size_t i = 0; i < rig_.motors.size(); ++i) {
      const auto steps = reality.backlash_steps.find(rig_.motors[i].name);
      if (steps != reality.backlash_steps.end())
        control_->ask("backlash " + std::to_string(i) + " " + std::to_string(steps->second));
    }
  }

  void publish() {
    try {
      shafts_.publish(shaft_state(rig_, control_->shafts(), ros::Time::now()));
    } catch (const std::runtime_error& error) {  // it was stopped first
      ROS_WARN("%s", error.what());
      ros::requestShutdown();
    }
  }

  bool command(RigCommand::Request& request, RigCommand::Response& response) {
    try {
      response.message = control_->ask(request.command);
      response.success = true;
    } catch (const std::invalid_argument& error) {
      response.message = error.what();
    }
    return true;
  }

  RigSettings rig_;
  std::unique_ptr<RigControl> control_;
  ros::NodeHandle node_;
  ros::Publisher shafts_;
  ros::ServiceServer command_;
  ros::WallTimer timer_;
};

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  using namespace soft_robot_lab;
  return run_node(argc, argv, "emulated_rig", [] {
    EmulatedRigNode node(ros::NodeHandle("~"));
    ros::spin();
  });
}
