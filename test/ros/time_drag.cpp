// SPDX-License-Identifier: BSD-3-Clause
// Drags the target of a session round a circle, or moves its first slider, and prints how long the ghost or preview
// takes to answer, and how near it gets. For hands, beside session.launch: `rosrun soft_robot_lab time_drag [TARGETS]`,
// `rosrun soft_robot_lab time_drag slider [MOVES]`. No test compares speed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <ros/ros.h>
#include <unistd.h>
#include <visualization_msgs/InteractiveMarkerFeedback.h>
#include <visualization_msgs/Marker.h>

#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "ros/messages/messages.h"
#include "ros/base/node_process.h"
#include "ros/base/topics.h"
#include "session_ears.h"
#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

using Feedback = visualization_msgs::InteractiveMarkerFeedback;

// Of all its threads, as proc(5) counts them.
double cpu_s(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string word;
  double user = 0.0, system = 0.0;
  for (int i = 0; i < 13; ++i) in >> word;
  in >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

class Drag {
 public:
  // Waits until the session is there, and at rest.
  bool begin() {
    feedback_ = node_.advertise<Feedback>(std::string(topics::target_marker) + "/feedback", 10);
    markers_ = node_.subscribe<MarkerObservations>(topics::simulator_markers, 1,
                                                   boost::function<void(const MarkerObservations::ConstPtr&)>(
                                                       [this](const auto& m) { tip_ = position_of(*m, "tip"); }));
    ghosts_ = node_.subscribe<visualization_msgs::Marker>(
        topics::controller_ghost, 100,
        boost::function<void(const visualization_msgs::Marker::ConstPtr&)>([this](const auto& m) {
          if (m->action == visualization_msgs::Marker::ADD) ++seen_;
        }));
    progress_ = node_.subscribe<PolicyProgress>(
        topics::controller_progress, 100,
        boost::function<void(const PolicyProgress::ConstPtr&)>([this](const auto& m) { distance_m_ = m->distance_m; }));
    return spin_until([&] { return tip_ && feedback_.getNumSubscribers() > 0 && ghosts_.getNumPublishers() > 0; },
                      60.0);
  }

  // Circles of 15 mm beside the tip's rest, by steps of about 1.6 mm.
  void run(int targets) {
    const pid_t controller = answering_process(ros::names::resolve("controller"), 5.0).value_or(getpid());
    const Eigen::Vector3d centre = *tip_ + Eigen::Vector3d(0.0, 0.0, 0.01);
    std::vector<double> walls_s, distances_m;
    const double cpu_before_s = cpu_s(controller);
    move(Feedback::MOUSE_DOWN, centre);
    for (int i = 0; i < targets; ++i) {
      const double angle = 2.0 * M_PI * i / 60.0;
      const int before = seen_;
      const ros::WallTime start = ros::WallTime::now();
      move(Feedback::POSE_UPDATE, centre + 0.015 * Eigen::Vector3d(std::sin(angle), 1.0 - std::cos(angle), 0.0));
      if (!spin_until([&] { return seen_ > before; }, 30.0)) break;
      walls_s.push_back((ros::WallTime::now() - start).toSec());
      distances_m.push_back(distance_m_);
      spin_until([&] { return ros::WallTime::now() > start + ros::WallDuration(pause_s); }, 5.0);
    }
    const double cpu = (cpu_s(controller) - cpu_before_s) / targets;
    if (walls_s.empty()) {
      std::printf("none of %d targets answered\n", targets);
      return;
    }
    std::printf("%zu of %d targets answered: median %.3f s, slowest %.3f s, CPU %.3f s each; left over %.2f mm\n",
                walls_s.size(), targets, median(walls_s), quantile(walls_s, 1.0), cpu, 1e3 * median(distances_m));
  }

 private:
  void move(int event, const Eigen::Vector3d& place_m) {
    Feedback feedback;
    feedback.header.frame_id = robot_frame();
    feedback.header.stamp = ros::Time(0);
    feedback.client_id = "time_drag";
    feedback.marker_name = "target";
    feedback.event_type = static_cast<unsigned char>(event);
    feedback.pose.position = to_message(place_m);
    feedback.pose.orientation.w = 1.0;
    feedback_.publish(feedback);
  }

  static constexpr double pause_s = 0.2;  // a hand's next target comes later

  ros::NodeHandle node_;
  ros::Publisher feedback_;
  ros::Subscriber markers_, ghosts_, progress_;
  std::optional<Eigen::Vector3d> tip_;
  int seen_ = 0;
  double distance_m_ = 0.0;
};

// The session's first actuator, back and forth between rest and a fifth less.
class Slider {
 public:
  bool begin() {
    commands_ = node_.advertise<ActuatorCommand>(topics::actuator_command, 10, true);
    actuators_ = node_.subscribe<ActuatorState>(
        topics::simulator_actuators, 1,
        boost::function<void(const ActuatorState::ConstPtr&)>([this](const auto& m) { state_ = *m; }));
    previews_ = listen(topics::controller_preview, preview_, previewed_);
    surfaces_ = listen(topics::simulator_surface, surface_, shown_);
    return spin_until([&] { return !state_.names.empty() && shown_ > 0 && previews_.getNumPublishers() > 0; }, 60.0) &&
           spin_until([&] { return commands_.getNumSubscribers() > 0; }, 10.0);
  }

  void run(int moves) {
    std::vector<double> answers_s, arrivals_s, errors_m;
    const double rest = state_.commands[0];
    for (int i = 0; i < moves; ++i) {
      ActuatorCommand command;
      command.names = {state_.names[0]};
      command.values = {rest * (1.0 - 0.2 * std::fmod(0.3819660112501051 * (i + 1), 1.0))};
      const int before = previewed_;
      const ros::WallTime start = ros::WallTime::now();
      commands_.publish(command);
      if (!spin_until([&] { return previewed_ > before; }, 10.0)) continue;  // no farther than nobody sees
      answers_s.push_back((ros::WallTime::now() - start).toSec());
      const visualization_msgs::Marker answer = preview_;
      if (!spin_until([&] { return preview_.action == visualization_msgs::Marker::DELETE; }, 20.0)) continue;
      arrivals_s.push_back((ros::WallTime::now() - start).toSec());
      const ros::WallTime settled = ros::WallTime::now() + ros::WallDuration(2.0);
      spin_until([&] { return ros::WallTime::now() > settled; }, 5.0);
      errors_m.push_back(farthest(answer, surface_));
    }
    if (errors_m.empty()) {
      std::printf("none of %d moves answered\n", moves);
      return;
    }
    std::printf(
        "%zu of %d moves answered: median %.3f s, slowest %.3f s; the robot is there after %.3f s in the median; "
        "skins at rest differ by %.2f mm in the median, %.2f mm at most\n",
        answers_s.size(), moves, median(answers_s), quantile(answers_s, 1.0), median(arrivals_s),
        1e3 * median(errors_m), 1e3 * quantile(errors_m, 1.0));
  }

 private:
  ros::Subscriber listen(const char* topic, visualization_msgs::Marker& last, int& added) {
    return node_.subscribe<visualization_msgs::Marker>(
        topic, 100, boost::function<void(const visualization_msgs::Marker::ConstPtr&)>([&](const auto& m) {
          last = *m;
          if (m->action == visualization_msgs::Marker::ADD) ++added;
        }));
  }

  static double farthest(const visualization_msgs::Marker& a, const visualization_msgs::Marker& b) {
    double farthest_m = a.points.size() == b.points.size() ? 0.0 : INFINITY;
    for (std::size_t i = 0; i < std::min(a.points.size(), b.points.size()); ++i)
      farthest_m = std::max(farthest_m, std::hypot(a.points[i].x - b.points[i].x, a.points[i].y - b.points[i].y,
                                                   a.points[i].z - b.points[i].z));
    return farthest_m;
  }

  ros::NodeHandle node_;
  ros::Publisher commands_;
  ros::Subscriber actuators_, previews_, surfaces_;
  ActuatorState state_;
  visualization_msgs::Marker preview_, surface_;
  int previewed_ = 0, shown_ = 0;
};

template <typename Hand>
int play(int count) {
  Hand hand;
  if (!hand.begin()) {
    std::fprintf(stderr, "time_drag: no session answers\n");
    return 1;
  }
  hand.run(count);
  return 0;
}

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  using namespace soft_robot_lab;
  ros::init(argc, argv, "time_drag");
  const bool slider = argc > 1 && std::string(argv[1]) == "slider";
  const int number = slider ? 2 : 1;
  const int count = argc > number ? std::atoi(argv[number]) : 60;
  return slider ? play<Slider>(count) : play<Drag>(count);
}
