// SPDX-License-Identifier: BSD-3-Clause
// Plays a policy's file on a running session and, where asked, corrects it by tracked markers.
//
// Exit status: 0 the robot rests where it was to go, 1 it does not, 2 bad file or arguments.
#include <cstdio>
#include <string>

#include <ros/ros.h>
#include <soft_robot_lab/ExecutePolicy.h>

#include "session_client.h"
#include "settings/command_line.h"
#include "soft_robot_lab/control/policy.h"
#include "ros/policy_request.h"
#include "ros/topics.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kUsage =
    "usage: play_policy_node POLICY.yaml [--closed-loop [(--marker NAME --target X Y Z)...]]\n"
    "Plays the policy on the running session and waits for rest. --closed-loop then brings markers to targets\n"
    "[m, robot_base] by what the tracker sees; without any, to those of the last policy that the controller found.\n"
    "Exit status: 0 at rest where it was to go, 1 stopped early, 2 bad file or arguments.\n";

struct Arguments {
  std::string policy;
  ExecutePolicy::Request request;
  bool help = false;
};

Arguments parse(int count, char** values) {
  Arguments arguments;
  PolicyPose& goal = arguments.request.goal;
  for (Words words(count, values); words.next();) {
    const std::string word = words.word();
    if (word == "-h" || word == "--help") {
      arguments.help = true;
    } else if (word == "--closed-loop") {
      arguments.request.closed_loop = true;
    } else if (word == "--marker") {
      goal.markers.push_back(words.value());
    } else if (word == "--target") {
      goal.targets.emplace_back();
      for (double* axis : {&goal.targets.back().x, &goal.targets.back().y, &goal.targets.back().z})
        *axis = std::stod(words.value());
    } else if (arguments.policy.empty() && word.rfind("--", 0) != 0) {
      arguments.policy = word;
    } else {
      throw std::invalid_argument("not understood: " + word);
    }
  }
  if (!arguments.help && arguments.policy.empty()) throw std::invalid_argument("no policy given");
  return arguments;
}

int play(const Arguments& arguments) {
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
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  using namespace soft_robot_lab;
  ros::init(argc, argv, "play_policy", ros::init_options::AnonymousName);
  return run_program("play_policy_node", kUsage, argc, argv, parse, play);
}
