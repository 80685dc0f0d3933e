// SPDX-License-Identifier: BSD-3-Clause
// One run of a program, named by its content: whoever runs it finds the same.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "study_file.h"

namespace soft_robot_lab {

struct StudyTask {
  std::string hash;            // of all below, of the scene's files and of the program
  std::vector<double> values;  // of the study's parameters
  int seed = 0;                // of programs with random numbers; 0 for others
};

struct TaskOutcome {
  enum class State { good, not_good, failed };  // exit status 0; 1 with a result; no result
  std::string hash;
  State state = State::failed;
  std::string reason;  // where it is not good
  std::string result;  // JSON; empty where it failed
  double wall_s = 0.0;
};

std::string name_of(TaskOutcome::State state);
TaskOutcome::State state_named(const std::string& name);  // throws std::invalid_argument

// Of the program's file, of the libraries and the mesher beside it: another build is another version.
// Throws std::runtime_error where the program is not found.
std::string program_version(const std::string& program);

// Of a scene with what it includes, and of the files that it or the program's arguments name. Throws SettingsError.
std::string scene_hash(const std::string& scene, const std::vector<std::string>& arguments);

// In the order of the samples.
std::vector<StudyTask> make_tasks(const StudySettings& study, const std::string& version);

// What a worker needs to run it, and to check that its files are those of the study.
nlohmann::ordered_json task_request(const StudySettings& study, const StudyTask& task);

// The hash of a request: of its content but the time limit.
std::string request_hash(const nlohmann::ordered_json& request, const std::string& scene_hash,
                         const std::string& version);

}  // namespace soft_robot_lab
