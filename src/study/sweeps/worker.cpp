// SPDX-License-Identifier: BSD-3-Clause
#include "worker.h"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <set>
#include <sstream>
#include <thread>
#include <vector>

#include <unistd.h>

#include "line_queue.h"
#include "robot/design/content_cache.h"
#include "robot/design/timed_process.h"
#include "settings/find_program.h"
#include "settings/limits.h"
#include "settings/read_file.h"
#include "settings/words.h"
#include "task.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kLargestResult_bytes = limits::kResult_bytes;

std::string text_of(const std::string& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) ? read_regular_file(file, kLargestResult_bytes) : std::string();
}

std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text.substr(text.rfind('\n') + 1);  // npos + 1 is 0
}

// The last line that the program begins with its name: after it stands at most how it is used.
std::string last_complaint(const std::string& program, const std::string& text) {
  std::istringstream lines(text);
  std::string found;
  for (std::string line; std::getline(lines, line);)
    if (line.rfind(program + ": ", 0) == 0) found = line;
  return found.empty() ? last_line(text) : found;
}

std::vector<std::string> command_of(const Json& task, const std::string& result, const WorkFolder& folder) {
  const std::string program = task.at("program"), scene = task.at("scene");
  std::vector<std::string> command = {find_program(program)};
  if (program == "fit_model")
    command.insert(command.end(), {"--scene", scene, "--output", folder.file("fitted.yaml")});
  else
    command.push_back(scene);
  for (const Json& argument : task.at("arguments")) command.push_back(argument.get<std::string>());
  if (program == "rollouts") command.insert(command.end(), {"--threads", "1"});
  command.insert(command.end(), {"--result", result});
  for (const Json& set : task.at("set")) {
    command.emplace_back("--set");
    command.push_back(set.at(0).get<std::string>() + "=" + set.at(1).dump());
  }
  if (const int seed = task.at("seed"); seed > 0) {
    command.emplace_back("--seed");
    command.push_back(std::to_string(seed));
  }
  return command;
}

// Ended from outside: that says nothing about the task.
bool was_killed(const ProcessEnd& end) {
  static const std::set<int> outside = {SIGKILL, SIGTERM, SIGHUP, SIGINT};
  return end.kind == ProcessEnd::Kind::signalled && outside.count(end.value) > 0;
}

Json failed(Json answer, const std::string& reason) {
  answer["state"] = name_of(TaskOutcome::State::failed);
  answer["reason"] = reason;
  return answer;
}

// What the program itself says in its result: the first test that failed, or the first pose that is of no use.
std::string reason_in(const Json& result) {
  if (const auto tests = result.find("tests"); tests != result.end())
    for (const auto& [name, test] : tests->items())
      if (test.is_object() && !test.value("passed", true)) return name + ": " + test.value("why", "not passed");
  if (const auto poses = result.find("poses"); poses != result.end())
    for (std::size_t i = 0; i < poses->size(); ++i)
      if (const Json& pose = (*poses)[i]; pose.is_object() && !pose.value("usable", true))
        return "pose " + std::to_string(i) + ": " + pose.value("stop_reason", "not usable");
  return "";
}

Json judge(Json answer, const Json& task, const ProcessEnd& end, const std::string& result, const std::string& errors) {
  if (was_killed(end)) {
    answer["lost"] = "its program was killed by signal " + std::to_string(end.value);
    return answer;
  }
  if (end.kind == ProcessEnd::Kind::timed_out)
    return failed(std::move(answer),
                  "did not end within time_limit_s = " + format_number(task.at("time_limit_s").get<double>()) + " s");
  if (end.kind == ProcessEnd::Kind::signalled)
    return failed(std::move(answer), "ended by signal " + std::to_string(end.value));
  Json found = Json::parse(result, nullptr, false);
  if (end.value > 1 || !found.is_object())
    return failed(std::move(answer),
                  errors.empty() ? "ended with status " + std::to_string(end.value) + " and no result" : errors);
  answer["state"] = name_of(end.value == 0 ? TaskOutcome::State::good : TaskOutcome::State::not_good);
  answer["reason"] = end.value == 0 ? "" : errors.empty() ? reason_in(found) : errors;
  answer["result"] = std::move(found);
  return answer;
}

Json run_task(const Json& task, const std::string& version, const WorkFolder& folder) {
  Json answer = {{"hash", task.at("hash")}};
  if (request_hash(task, scene_hash(task.at("scene"), task.at("arguments")), version) != task.at("hash")) {
    answer["refused"] =
        task.at("scene").get<std::string>() + ", or a file that it names, is not what the study began with";
    return answer;
  }
  const std::string result = folder.file("result.json"), errors = folder.file("errors");
  fs::remove(result);
  const auto begin = std::chrono::steady_clock::now();
  const ProcessEnd end = run_with_limit(command_of(task, result, folder), errors, task.at("time_limit_s"));
  answer["wall_s"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return judge(std::move(answer), task, end, text_of(result), last_complaint(task.at("program"), text_of(errors)));
}

}  // namespace

void run_worker(const std::string& program, int slot, const WorkerLink& link) {
  for (const char* threads : {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"}) setenv(threads, "1", 1);  // workers are many
  const std::string version = program_version(program);
  link.send(Json{{"slot", slot}, {"version", version}}.dump());
  const WorkFolder folder((fs::temp_directory_path() / ("soft_robot_lab_study_" + std::to_string(getuid()))).string());
  while (const std::optional<std::string> line = link.receive()) {
    const Json task = Json::parse(*line);
    Json answer;
    try {
      answer = run_task(task, version, folder);
    } catch (const std::exception& error) {
      answer = {{"hash", task.at("hash")}, {"refused", error.what()}};
    }
    answer["slot"] = slot;
    link.send(answer.dump(-1, ' ', false, Json::error_handler_t::replace));
  }
}

void run_worker_on_pipes(const std::string& program) {
  auto* input = new LineQueue;  // its threads run until the process ends
  std::thread([input] {
    for (std::string line; std::getline(std::cin, line);) input->push(line);
    _exit(0);  // what it runs dies with it
  }).detach();
  run_worker(program, 0, {[&] { return input->wait(); }, print_line});
}

void print_line(const std::string& line) {
  if (std::fputs((line + "\n").c_str(), stdout) < 0 || std::fflush(stdout) != 0) _exit(1);
}

}  // namespace soft_robot_lab
