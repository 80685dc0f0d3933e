// SPDX-License-Identifier: BSD-3-Clause
// Says of a robot's file, or of the scene that runs, whether it can be cast, and colours its skin by that.
#include <stdexcept>
#include <string>
#include <vector>

#include <ros/ros.h>
#include <soft_robot_lab/CheckDesign.h>
#include <std_msgs/String.h>
#include <visualization_msgs/Marker.h>

#include "run_node.h"
#include "robot/casting/cast_robot.h"
#include "robot/casting/mould_plan.h"
#include "robot/casting/verdict_page.h"
#include "ros/base/actuator_plugins.h"
#include "ros/messages/conversions.h"
#include "ros/messages/message_limits.h"
#include "ros/base/latched_publisher.h"
#include "ros/base/log_text.h"
#include "ros/display/surface_marker.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

constexpr char kDesignAbout[] =
    "design_node: the service design/check says whether a robot can be cast in silicone, and design/casting shows "
    "where it cannot.";

constexpr char kSkin[] = "casting";

// At rest, and a little outside the simulated skin, which would shine through it.
visualization_msgs::Marker skin_of(const CastingVerdict& verdict, double min_thickness_m) {
  constexpr double outside = 2e-3;  // of the robot's size
  const Surface& judged = verdict.judged;
  const std::vector<Paint> paints = verdict_paints(verdict, min_thickness_m);
  visualization_msgs::Marker marker = no_skin(kSkin);
  marker.action = visualization_msgs::Marker::ADD;
  marker.type = visualization_msgs::Marker::TRIANGLE_LIST;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color.a = 1.0f;
  for (int t = 0; t < judged.triangle_count(); ++t) {
    const Eigen::Vector3d normal = judged.normals.col(t);
    const Paint& paint = paints[static_cast<std::size_t>(t)];
    const std_msgs::ColorRGBA colour = shaded(normal, 1.0, {paint.red, paint.green, paint.blue}, 1.0);
    for (int i = 0; i < 3; ++i) {
      marker.points.push_back(to_message(judged.corner(t, i) + outside * judged.size_m() * normal));
      marker.colors.push_back(colour);
    }
  }
  return marker;
}

void fill(const CastingVerdict& verdict, CheckDesign::Response& response) {
  response.castable = verdict.castable;
  response.direction = vector_message(verdict.direction);
  std::string failed;
  for (const CastingTest& test : verdict.tests) {
    response.tests.push_back(test.name);
    response.passed.push_back(test.passed);
    response.by.push_back(test.by);
    response.margins.push_back(margin_text(test));
    response.reasons.push_back(test.passed || !test.at_m ? test.why : test.why + ", at " + place_text(*test.at_m));
    if (!test.passed) failed += (failed.empty() ? "; fails: " : ", ") + test.name;
  }
  response.message = (verdict.castable ? "castable" : "not castable") + failed;
}

class DesignNode {
 public:
  DesignNode() {
    options_.actuator_factory = actuators_from_plugins();
    options_.interrupt = [] { return !ros::ok(); };
    ros::NodeHandle node;
    scene_subscriber_ = node.subscribe<std_msgs::String>(topics::simulator_scene, 1, [this](const auto& path) {
      if (!scene_.empty() && scene_ != path->data) skin_.publish(no_skin(kSkin));  // of a robot that is gone
      scene_ = path->data;
    });
    service_ = node.advertiseService(topics::check_design, &DesignNode::on_request, this);
  }

 private:
  bool on_request(CheckDesign::Request& request, CheckDesign::Response& response) {
    try {
      check(request, response);
      response.success = true;
    } catch (const std::exception& error) {
      response = CheckDesign::Response();
      response.message = answer_text(error);
    }
    return true;
  }

  void check(const CheckDesign::Request& request, CheckDesign::Response& response) {
    require_in_limits<CheckDesign::Request>(request);
    if (!request.robot.empty()) require_whole_path("robot", request.robot);
    const std::string& path = request.robot.empty() ? scene_ : request.robot;
    if (path.empty()) throw std::invalid_argument("robot: empty, and no scene runs; give the path of a robot's file");
    const CastRobotFile file = load_cast_robot_in_use(path, options_);
    const CastingVerdict verdict = with_allowed_moulds(file, check_casting(file));
    fill(verdict, response);
    skin_.publish(request.show ? skin_of(verdict, file.settings.min_thickness_m) : no_skin(kSkin));
  }

  SceneOptions options_;
  std::string scene_;  // that runs; empty: not heard yet
  ros::Subscriber scene_subscriber_;
  PresentPublisher<visualization_msgs::Marker> skin_{topics::design_casting};
  ros::ServiceServer service_;
};

}  // namespace

int design_node(int argc, char** argv) {
  return run_node(argc, argv, "design", kDesignAbout, [] {
    const DesignNode node;
    ros::spin();
  });
}

}  // namespace soft_robot_lab
