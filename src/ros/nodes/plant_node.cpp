// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <soft_robot_lab/ShaftState.h>

#include "read_parameter.h"
#include "run_node.h"
#include "hardware/plant/real_time_plant.h"
#include "hardware/plant/same_commands.h"
#include "ros/base/actuator_plugins.h"
#include "ros/messages/frames.h"
#include "ros/base/latched_publisher.h"
#include "ros/messages/conversions.h"
#include "ros/base/log_text.h"
#include "ros/base/node_diagnosis.h"
#include "ros/messages/message_limits.h"
#include "ros/simulator/pulling_hand.h"
#include "ros/display/surface_marker.h"
#include "ros/base/topics.h"
#include "settings/require_in_range.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kPlantAbout = R"(Plays the robot that an emulated rig moves: a second simulation, not quite the
model, whose cables the rig's shafts pull. What it publishes is the truth, for rendered cameras to see and for
reports, not for controller or tracker.

Parameters: ~plant (path: how it differs from the model), ~rig (path: whose shafts move it; absent: not checked),
~surface_rate_hz (how often its skin is published while it moves; cameras need it as often as they film), ~max_pull_n
(the most that plant/pull pushes it by).)";

SceneOptions scene_options() {
  SceneOptions options;
  options.actuator_factory = actuators_from_plugins();
  options.interrupt = [] { return !ros::ok(); };
  return options;
}

PlantSettings read_plant(const ros::NodeHandle& parameters) {
  return load_plant(required_text(parameters, "plant", "its file's path"));
}

class PlantNode {
 public:
  explicit PlantNode(const ros::NodeHandle& parameters)
      : plant_(read_plant(parameters), scene_options_, [] { return !ros::ok(); }),
        surface_(plant_.simulation().body().mesh()) {
    if (const auto rig = text_parameter(parameters, "rig"); !rig.empty())
      require_same_commands(plant_.simulation(), text_parameter(parameters, "plant"), load_rig(rig), rig);
    read_parameter(parameters, "surface_rate_hz", surface_rate_hz_);
    require_in_range("surface_rate_hz", surface_rate_hz_, {0.0, 1000.0, true});
    double max_pull_n = 10.0;
    read_parameter(parameters, "max_pull_n", max_pull_n);
    require_in_range("max_pull_n", max_pull_n, {0.0, 100.0, true});
    hand_ = std::make_unique<PullingHand>(max_pull_n);
    markers_publisher_ = node_.advertise<MarkerObservations>(topics::plant_markers, 10);
    surface_publisher_ = advertise_latched<visualization_msgs::Marker>(topics::plant_surface,
                                                                       [this](const auto&) { surface_.forget(); });
    shafts_subscriber_ = node_.subscribe(topics::rig_shafts, 1000, &PlantNode::on_shafts, this);
    pull_subscriber_ = node_.subscribe(topics::plant_pull, 10, &PlantNode::on_pull, this);
    diagnosis_.add("plant", [this](auto& status) { diagnose(status); });
    diagnosis_.start();
  }

  void run() {
    constexpr double poll_s = 0.005;
    while (ros::ok()) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(poll_s));
      hand_->let_go_if_silent(ros::WallTime::now().toSec(), plant_.pushed());
      const double before_s = plant_.present().time_s;
      advance(ros::Time::now().toSec());
      if (plant_.present().time_s > before_s) publish(ros::Time::now());
    }
  }

 private:
  void on_shafts(const ShaftState& shafts) {
    if (is_in_limits<ShaftState>(shafts)) late_.add(shafts.header.stamp.toSec(), shafts.names, shafts.values);
  }

  // As the simulator is pulled, by a force alone.
  void on_pull(const SkinPull& pull) {
    try {
      require_in_limits<SkinPull>(pull);
      if (pull.header.frame_id != robot_frame())
        throw std::invalid_argument("header.frame_id: '" + pull.header.frame_id + "' is not " + robot_frame());
      if (pull.stiffness_n_m != 0.0)
        throw std::invalid_argument("stiffness_n_m: " + std::to_string(pull.stiffness_n_m) +
                                    " is not 0: only a force pushes the robot of an emulated rig");
      hand_->take(pull, ros::WallTime::now().toSec(), plant_.pushed());
    } catch (const std::invalid_argument& error) {
      ROS_WARN_THROTTLE(1.0, "%s refused: %s", topics::plant_pull, log_text(error.what()).c_str());
    }
  }

  // A shaft that turned beyond what the robot's cables allow stays where it was.
  void advance(double now_s) {
    constexpr double longest_s = 0.1;  // until others have their turn
    constexpr double latest_s = 5.0;   // a move costs more than it takes, and the rest after it less
    try {
      late_.advance(now_s, longest_s, latest_s);
    } catch (const std::invalid_argument& error) {
      refusal_ = error.what();
      ROS_WARN_THROTTLE(1.0, "%s: %s", topics::rig_shafts, log_text(error.what()).c_str());
    }
  }

  void publish(const ros::Time& stamp) {
    const Simulation& simulation = plant_.simulation();
    markers_publisher_.publish(marker_observations(simulation, stamp));
    const double period = std::floor(stamp.toSec() * surface_rate_hz_);
    surface_.follow_clock(stamp);
    if (period != surface_period_ && surface_.moved(simulation.state().positions_m)) {
      surface_publisher_.publish(surface_.message(simulation.state().positions_m, stamp));
      surface_period_ = period;
    }
  }

  void diagnose(NodeDiagnosis::Status& status) {
    using Status = NodeDiagnosis::Status;
    if (!refusal_.empty())
      status.summary(Status::WARN, refusal_);
    else if (late_.lost_s() > reported_lost_s_ + 0.1)
      status.summary(Status::WARN, "slower than real time");
    else
      status.summary(Status::OK, "runs");
    status.add("late [s]", late_.late_s(ros::Time::now().toSec()));
    status.add("time lost [s]", late_.lost_s() - reported_lost_s_);
    status.add("steps not converged", plant_.failed_steps());
    refusal_.clear();
    reported_lost_s_ = late_.lost_s();
  }

  SceneOptions scene_options_ = scene_options();  // keeps the plugins loaded
  Plant plant_;
  SurfaceMarker surface_;
  double surface_rate_hz_ = 15.0;
  double surface_period_ = -1.0;
  RealTimePlant late_{plant_, ros::Time::now().toSec()};
  double reported_lost_s_ = 0.0;  // until the last diagnosis
  std::string refusal_;           // since then
  ros::NodeHandle node_;
  ros::Publisher markers_publisher_, surface_publisher_;
  std::unique_ptr<PullingHand> hand_;
  ros::Subscriber shafts_subscriber_, pull_subscriber_;
  NodeDiagnosis diagnosis_{"emulated"};
};

}  // namespace

int plant_node(int argc, char** argv) {
  return run_node(argc, argv, "plant", kPlantAbout, [] { PlantNode(ros::NodeHandle("~")).run(); });
}

}  // namespace soft_robot_lab
