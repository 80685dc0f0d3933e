// SPDX-License-Identifier: BSD-3-Clause
// Plays a policy's file on a running session and, where asked, corrects it by tracked markers.
//
// Exit status: 0 the robot rests where it was to go, 1 it does not, 2 bad file or arguments.
#include <cstdio>
#include <string>
#include <vector>

#include <ros/ros.h>
#include <soft_robot_lab/ExecutePolicy.h>

#include "require_master.h"
#include "session_client.h"
#include "settings/command_line.h"
#include "soft_robot_lab/control/policy.h"
#include "ros/messages/conversions.h"
#include "ros/controller/policy_request.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

struct PolicyArguments {
  std::string policy;
  ExecutePolicy::Request request;
};

void declare(CommandLine& app, PolicyArguments& arguments) {
  PolicyPose& goal = arguments.request.goal;
  const auto add_target = [&goal](const std::vector<double>& target_m) {
    goal.targets.push_back(to_message(Eigen::Vector3d(target_m[0], target_m[1], target_m[2])));
  };
  app.add_option("POLICY", arguments.policy, "a policy's file").type_name("FILE").required();
  app.add_flag_callback(
      "--closed-loop", [&arguments] { arguments.request.closed_loop = true; },
      "then bring markers to targets by what the tracker sees; without any, to those of the last policy that the "
      "controller found");
  app.add_option("--marker", goal.markers, "can be repeated").type_name("NAME").one_value_at_a_time();
  app.add_option_function<std::vector<double>>("--target", add_target, "of the marker before it [m, robot_base]")
      .type_name("X Y Z")
      .expected(3)
      .in_order();
  app.footer("Exit status: 0 at rest where it was to go, 1 stopped early, 2 bad file or arguments.");
}

int play(const PolicyArguments& arguments) {
  ExecutePolicy::Request request = arguments.request;
  request.policy = to_message(load_policy(arguments.policy));
  request.wait_until_rest = true;
  ros::NodeHandle node;
  try {
    const auto answer = call<ExecutePolicy>(node, topics::execute_policy, request);
    std::printf("at rest after %.1f s%s\n", answer.duration_s, request.closed_loop ? ":" : "");
    if (request.closed_loop) {
      std::printf("closed loop       %s after %d corrections\n", answer.message.c_str(), answer.corrections);
      if (answer.final_distance_m >= 0.0) std::printf("distance          %.2f mm\n", 1e3 * answer.final_distance_m);
    }
    for (size_t i = 0; i < answer.names.size(); ++i)
      std::printf("command           %s = %.4f\n", answer.names[i].c_str(), answer.values[i]);
    return kGood;
  } catch (const std::runtime_error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return kNotGood;
  }
}

}  // namespace

int play_policy_node(int argc, char** argv) {
  ros::init(argc, argv, "play_policy", ros::init_options::AnonymousName);
  CommandLine app("Plays a policy on the running session and waits for rest.", "play_policy_node");
  PolicyArguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] {
    require_master();
    return play(arguments);
  });
}

}  // namespace soft_robot_lab
