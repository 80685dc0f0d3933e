// SPDX-License-Identifier: BSD-3-Clause
#include "task.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "robot/design/content_hash.h"
#include "robot/scene/parameters.h"
#include "sampling.h"
#include "settings/find_program.h"
#include "settings/limits.h"
#include "settings/read_file.h"
#include "soft_robot_lab/settings/config_folder.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kLargestFile_bytes = limits::kTaskFile_bytes;

// Our libraries that the programs of tasks may load; not those of this runner. Recordings are read by ROS.
bool counts(const std::string& library, const std::string& program) {
  if (library.rfind("libsrl_", 0) != 0) return false;
  if (library.rfind("libsrl_ros", 0) == 0) return program == "fit_model";
  return library.rfind("libsrl_study", 0) != 0 && library.rfind("libsrl_sweeps", 0) != 0;
}

std::vector<std::string> libraries_beside(const fs::path& program) {
  std::vector<std::string> files;
  std::error_code ignored;
  for (const fs::path& folder : {program.parent_path(), program.parent_path().parent_path()})
    for (const auto& file : fs::directory_iterator(folder, ignored))
      if (counts(file.path().filename().string(), program.filename().string())) files.push_back(file.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

void add_file(const fs::path& path, ContentHash& hash) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) hash.add(read_regular_file(path.string(), kLargestMesh_bytes));
}

// A text may name a mesh or a surface beside its file, or a material.
void add_named_files(const YamlNode& node, ContentHash& hash) {
  if (node.is_map())
    for (const std::string& key : node.keys()) add_named_files(node.child(key), hash);
  if (node.is_sequence())
    for (const YamlNode& item : node.items()) add_named_files(item, hash);
  if (!node.is_scalar() || node.as_text().empty()) return;
  add_file(fs::path(node.source()).parent_path() / node.as_text(), hash);
  add_file(fs::path(config_folder()) / "materials" / (node.as_text() + ".yaml"), hash);
}

bool has_random_numbers(const std::string& program) { return program == "optimise" || program == "rollouts"; }

}  // namespace

std::string name_of(TaskOutcome::State state) {
  if (state == TaskOutcome::State::good) return "good";
  return state == TaskOutcome::State::not_good ? "not_good" : "failed";
}

TaskOutcome::State state_named(const std::string& name) {
  for (const auto state : {TaskOutcome::State::good, TaskOutcome::State::not_good, TaskOutcome::State::failed})
    if (name_of(state) == name) return state;
  throw std::invalid_argument("'" + name + "' is no state of a task");
}

std::string program_version(const std::string& name) {
  const std::string program = find_program(name);
  if (program.empty()) throw std::runtime_error("the program " + name + " is neither beside this one nor on PATH");
  ContentHash hash;
  hash.add_large(read_regular_file(program, kLargestFile_bytes));
  for (const std::string& library : libraries_beside(program))
    hash.add_large(read_regular_file(library, kLargestFile_bytes));
  if (const std::string mesher = find_program("mesh_robot"); !mesher.empty())
    hash.add_large(read_regular_file(mesher, kLargestFile_bytes));
  return hash.hex();
}

std::string scene_hash(const std::string& scene, const std::vector<std::string>& arguments) {
  const YamlNode settings = load_settings(scene);
  ContentHash hash;
  hash.add(settings.dump());
  add_named_files(settings, hash);
  std::error_code ignored;
  for (const std::string& argument : arguments)
    if (fs::path(argument).is_absolute() && fs::is_regular_file(argument, ignored))
      hash.add_large(read_regular_file(argument, kLargestFile_bytes));
  return hash.hex();
}

Json task_request(const StudySettings& study, const StudyTask& task) {
  Json set = Json::array();
  for (std::size_t i = 0; i < study.parameters.size(); ++i) set.push_back({study.parameters[i].name, task.values[i]});
  return {{"program", study.program},     {"scene", study.scene}, {"set", set},
          {"arguments", study.arguments}, {"seed", task.seed},    {"time_limit_s", study.time_limit_s}};
}

std::string request_hash(const Json& request, const std::string& scene_hash, const std::string& version) {
  ContentHash hash;
  hash.add(version);
  hash.add(scene_hash);
  for (const std::string key : {"program", "set", "arguments", "seed"}) hash.add(request.at(key).dump());
  return hash.hex();
}

std::vector<StudyTask> make_tasks(const StudySettings& study, const std::string& version) {
  const std::string scene = scene_hash(study.scene, study.arguments);
  std::vector<StudyTask> tasks;
  for (std::vector<double>& values : sample(study)) {
    StudyTask task{"", std::move(values), has_random_numbers(study.program) ? study.seed : 0};
    task.hash = request_hash(task_request(study, task), scene, version);
    tasks.push_back(std::move(task));
  }
  return tasks;
}

}  // namespace soft_robot_lab
