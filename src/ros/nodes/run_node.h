// SPDX-License-Identifier: BSD-3-Clause
// How a node of this package starts and ends.
#pragma once

#include <chrono>
#include <clocale>
#include <cstring>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <langinfo.h>
#include <ros/ros.h>
#include <unistd.h>

#include "ros/base/node_process.h"
#include "settings/outlast_launch.h"
#include "settings/words.h"
#include "require_master.h"

namespace soft_robot_lab {

// Of what ROS itself does not take. The status where the node ends with it: 0 after --help, 2 for an unknown argument.
inline std::optional<int> read_node_arguments(int argc, char** argv, const std::string& name,
                                              const std::string& about) {
  if (argc < 2) return std::nullopt;
  const std::string first = argv[1];
  if (first == "--help" || first == "-h") {
    std::cout << about << "\n\nParameters are set as _name:=value, topics are renamed as topic:=other.\n";
    return 0;
  }
  std::cerr << name << ": unknown argument '" << first << "'; parameters are set as _name:=value, --help names them\n";
  return 2;
}

// Throws std::runtime_error where a node of this name runs already: ROS would end that one, and with it what it drives.
inline void require_free_name(double longest_answer_s = 0.5) {
  const std::string& name = ros::this_node::getName();
  if (const std::optional<pid_t> other = answering_process(name, longest_answer_s); other && *other != getpid())
    throw std::runtime_error(name + " runs already, as process " + std::to_string(*other) +
                             "; end that session first, or start this one in a namespace of its own");
}

// ROS writes its log in the letters of the locale: by default those of ASCII, and question marks for all others.
inline void write_letters_as_they_are() {
  const char* const set = std::setlocale(LC_CTYPE, "");
  if (set == nullptr || std::strcmp(nl_langinfo(CODESET), "UTF-8") != 0) std::setlocale(LC_CTYPE, "C.UTF-8");
}

// Runs `run` after ROS has been set up; what it throws is written to the log, and gives the exit status 2, unless the
// node was asked to end. `about` is what --help prints: what the node does, and its parameters.
template <class Run>
int run_node(int argc, char** argv, const std::string& name, const std::string& about, Run run) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<char*> words(argv, argv + argc);  // ROS takes out what it knows
  const auto fail = [&] {
    outlast_launch(static_cast<int>(words.size()), words.data(), begin);
    return 2;
  };
  write_letters_as_they_are();
  ros::init(argc, argv, name);
  if (const std::optional<int> ended = read_node_arguments(argc, argv, name, about)) return *ended;
  try {
    require_master();
    require_free_name();
  } catch (const std::exception& error) {
    std::cerr << name << ": " << reason_of(error) << "\n";
    return fail();
  }
  const ros::NodeHandle keeps_the_log_open;  // without any, a failure could not be logged
  try {
    run();
  } catch (const std::exception& error) {
    if (!ros::ok()) return 0;  // asked to end, it ended what it did
    ROS_FATAL("%s", reason_of(error).c_str());
    return fail();
  }
  return 0;
}

}  // namespace soft_robot_lab
