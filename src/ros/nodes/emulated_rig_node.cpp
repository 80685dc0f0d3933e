// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <ros/ros.h>
#include <soft_robot_lab/RigCommand.h>

#include "read_parameter.h"
#include "run_node.h"
#include "hardware/motor/rig_settings.h"
#include "hardware/plant/plant.h"
#include "hardware/testbench/rig_control.h"
#include "ros/base/log_text.h"
#include "ros/messages/motor_messages.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kEmulatedRigAbout =
    R"(Publishes where the shafts of an emulated rig really are, or which pressures its
chambers really have, and passes requests for faults on to it. Where the line to the emulator breaks, it connects again; without one, it fails.

Parameters: ~rig (path), ~control (the emulator's socket), ~plant (path: the backlash that its motors really have;
absent: none).)";

// The emulator may still be starting.
std::unique_ptr<RigControl> connect(const std::string& path) {
  const ros::SteadyTime limit = ros::SteadyTime::now() + ros::WallDuration(10.0);
  while (true) {
    try {
      return std::make_unique<RigControl>(path);
    } catch (const std::runtime_error&) {
      if (!ros::ok() || ros::SteadyTime::now() > limit) throw;
    }
    ros::WallDuration(0.05).sleep();
  }
}

class EmulatedRigNode {
 public:
  explicit EmulatedRigNode(const ros::NodeHandle& node)
      : rig_(load_rig(required_text(node, "rig", "the path of a rig's file"))),
        plant_(plant_of(node)),
        path_(required_text(node, "control", "the path of the emulator's socket")),
        control_(connect(path_)) {
    set_backlash();
    shafts_ = node_.advertise<ShaftState>(topics::rig_shafts, 10);
    command_ = node_.advertiseService(topics::rig_command, &EmulatedRigNode::command, this);
    timer_ = node_.createSteadyTimer(ros::WallDuration(0.01), [this](const auto&) { publish(); });
  }

 private:
  static std::optional<PlantSettings> plant_of(const ros::NodeHandle& node) {
    const std::string path = text_parameter(node, "plant");
    return path.empty() ? std::nullopt : std::optional(load_plant(path));
  }

  void set_backlash() {
    if (!plant_) return;
    for (std::size_t i = 0; i < rig_.motors.size(); ++i) {
      const auto steps = plant_->backlash_steps.find(rig_.motors[i].name);
      if (steps != plant_->backlash_steps.end())
        control_->ask("backlash " + std::to_string(i) + " " + std::to_string(steps->second));
    }
  }

  void publish() {
    if (!control_) return;
    try {
      shafts_.publish(rig_.channels.empty() ? shaft_state(rig_, control_->shafts(), ros::Time::now())
                                            : shaft_state(rig_, control_->pressures_pa(), ros::Time::now()));
    } catch (const std::runtime_error& error) {
      ROS_WARN("%s", log_text(error.what()).c_str());
      connect_again();
    }
  }

  void connect_again() {
    control_.reset();
    try {
      control_ = connect(path_);
      set_backlash();
    } catch (const std::runtime_error&) {
      if (ros::ok()) throw;  // otherwise the session ends, and the emulator was stopped first
    }
  }

  bool command(RigCommand::Request& request, RigCommand::Response& response) {
    try {
      if (!control_) throw std::runtime_error("the emulator is not there");
      response.message = control_->ask(request.command);
      response.success = true;
    } catch (const std::exception& error) {  // where the line broke, the next publish() connects again
      response.message = answer_text(error);
    }
    return true;
  }

  RigSettings rig_;
  std::optional<PlantSettings> plant_;
  std::string path_;
  std::unique_ptr<RigControl> control_;
  ros::NodeHandle node_;
  ros::Publisher shafts_;
  ros::ServiceServer command_;
  ros::SteadyTimer timer_;
};

}  // namespace

int emulated_rig_node(int argc, char** argv) {
  return run_node(argc, argv, "emulated_rig", kEmulatedRigAbout, [] {
    EmulatedRigNode node(ros::NodeHandle("~"));
    ros::spin();
  });
}

}  // namespace soft_robot_lab
