// SPDX-License-Identifier: BSD-3-Clause
// Asks a running session for a task - bring a marker to a target - and reports how it went.
//
// Usage: reach_target_node TASK.yaml. Exit status: 0 done, 1 a part failed or the marker rests too far away, 2 bad
// task.
#include <chrono>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/OptimisePolicy.h>

#include "require_master.h"
#include "session_client.h"
#include "settings/command_line.h"
#include "soft_robot_lab/control/optimiser.h"
#include "ros/messages/conversions.h"
#include "ros/messages/marker_frames.h"
#include "session/rest_detector.h"
#include "ros/base/topics.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

struct Task {
  std::string marker;
  Eigen::Vector3d target_m;  // robot_base
  std::string method;
  double accepted_distance_m = 0.0;  // farther away at the end, the task failed
};

Task read_task(const std::string& path) {
  const YamlNode file = YamlNode::load_file(path);
  Task task;
  task.marker = file.text("marker");
  task.target_m = file.vector3("target_m");
  task.method = file.choice("method", optimiser_methods());
  task.accepted_distance_m = file.number("accepted_distance_m", AllowedRange::positive());
  file.require_all_read();
  return task;
}

double wall_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

class ReachTarget {
 public:
  explicit ReachTarget(const Task& task) : task_(task) {
    markers_ = node_.subscribe<MarkerObservations>(topics::simulator_markers, 10,
                                                   boost::function<void(const MarkerObservations::ConstPtr&)>(
                                                       [this](const auto& markers) { on_markers(*markers); }));
  }

  // Throws std::runtime_error naming the part that failed.
  bool run() {
    const double before_m = distance_m(wait_for_rest());
    const OptimisePolicy::Response optimised = optimise();
    const double started_s = wall_s();
    const ExecutePolicy::Response executed = execute(optimised.policy);
    const double real_time_factor = executed.duration_s / (wall_s() - started_s);
    const double after_m = distance_m(executed.markers);
    report(before_m, optimised, after_m, real_time_factor);
    return after_m <= task_.accepted_distance_m;
  }

 private:
  void on_markers(const MarkerObservations& markers) {
    last_markers_ = markers;
    resting_ = rest_.update(markers.header.stamp.toSec(), raw_positions_m(markers));
  }

  double distance_m(const MarkerObservations& markers) const {
    return (position_of(markers, task_.marker) - task_.target_m).norm();
  }

  MarkerObservations wait_for_rest() {
    constexpr double limit_s = 180.0;  // meshing may come first
    const double give_up_s = wall_s() + limit_s;
    while (!resting_) {
      if (!ros::ok()) throw std::runtime_error("the session ended");
      if (wall_s() > give_up_s) throw std::runtime_error("the robot did not come to rest within 180 s of its start");
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
    }
    return *last_markers_;
  }

  OptimisePolicy::Response optimise() {
    OptimisePolicy::Request request;
    request.method = task_.method;
    request.marker = task_.marker;
    request.target = to_message(task_.target_m);
    return call<OptimisePolicy>(node_, topics::optimise_policy, request);
  }

  ExecutePolicy::Response execute(const Policy& policy) {
    ExecutePolicy::Request request;
    request.policy = policy;
    request.wait_until_rest = true;
    return call<ExecutePolicy>(node_, topics::execute_policy, request);
  }

  void report(double before_m, const OptimisePolicy::Response& optimised, double after_m, double real_time_factor) {
    const PolicySummary& summary = optimised.summary;
    std::printf("task              bring '%s' to (%g, %g, %g) m\n", task_.marker.c_str(), task_.target_m.x(),
                task_.target_m.y(), task_.target_m.z());
    std::printf("distance          %.2f mm before, %.2f mm after (the model expected %.2f mm)\n", 1e3 * before_m,
                1e3 * after_m, 1e3 * summary.final_distance_m);
    std::printf("optimisation      %s: %d iterations, %d equilibria, %.2f s (%s)\n", task_.method.c_str(),
                summary.iterations, summary.evaluations, summary.wall_s, summary.stop_reason.c_str());
    for (size_t i = 0; i < optimised.policy.names.size(); ++i) {
      std::printf("command           %s = %.4f\n", optimised.policy.names[i].c_str(),
                  optimised.policy.steps.back().values[i]);
    }
    std::printf("real-time factor  %.2f\n", real_time_factor);
    std::fflush(stdout);
  }

  Task task_;
  ros::NodeHandle node_;
  ros::Subscriber markers_;
  RestDetector rest_;
  std::optional<MarkerObservations> last_markers_;
  bool resting_ = false;
};

int reach(const std::string& path) {
  const Task task = read_task(path);
  try {
    if (ReachTarget(task).run()) return kGood;
    std::fprintf(stderr, "the marker rests farther than %g mm from the target\n", 1e3 * task.accepted_distance_m);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return kNotGood;
}

}  // namespace

int reach_target_node(int argc, char** argv) {
  ros::init(argc, argv, "reach_target");
  CommandLine app("Brings a marker of the running session to a target, and reports how it went.", "reach_target_node");
  std::string task;
  app.add_option("TASK", task, "a task's file").type_name("FILE").required();
  app.footer("Exit status: 0 done, 1 a part failed or the marker rests too far away, 2 bad task.");
  return run_program(app, argc, argv, [&] {
    require_master();
    return reach(task);
  });
}

}  // namespace soft_robot_lab
