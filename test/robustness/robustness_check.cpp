// SPDX-License-Identifier: BSD-3-Clause
// robustness_check SIMULATE FOLDER [PART [SEED]]: runs `simulate`, or `rollouts` and `mesh_robot` beside it, on bad and
// extreme scenes and files, of which PART takes every PART-th only, and counts how each ended. Another SEED makes and
// takes other ones. Status 1 where one ended as none may; its scene stays in FOLDER.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "bad_files.h"
#include "bad_scenes.h"
#include "run_program.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::json;

constexpr rlim_t kMemory_bytes = rlim_t(8) << 30;
constexpr rlim_t kCpu_s = 120;
constexpr double kWall_s = 900.0;  // of a process that waits for something; far beyond what a loaded machine needs
constexpr double kLargest_m = 1.0e3;

void limit(int resource, rlim_t most) {
  const rlimit both{most, most};
  setrlimit(resource, &both);
}

struct Ended {
  int status = 0;
  bool in_time = true;
};

Ended run(const std::string& simulate, const BadScene& bad, const std::string& folder) {
  const std::string result = folder + "/result.json", errors = folder + "/errors.txt";
  const std::filesystem::path programs = std::filesystem::path(simulate).parent_path();
  std::vector<std::string> words = {simulate, folder + "/scene.yaml", "--result", result};
  if (bad.request) words = {programs / "mesh_robot", folder + "/scene.yaml", result};
  if (!bad.commands.empty()) {
    words[0] = programs / "rollouts";
    for (const char* word : {"--commands", bad.commands.c_str(), "--duration", "0.1"}) words.emplace_back(word);
  }
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    limit(RLIMIT_AS, kMemory_bytes);
    limit(RLIMIT_CPU, kCpu_s);
    const int nothing = open("/dev/null", O_RDWR),
              error_file = open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(nothing, 0);
    dup2(nothing, 1);
    dup2(error_file, 2);
    if (chdir(folder.c_str()) == 0) execv(arguments[0], arguments.data());
    _exit(127);
  }
  const auto begin = std::chrono::steady_clock::now();
  Ended ended;
  while (waitpid(child, &ended.status, WNOHANG) == 0) {
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() > kWall_s && ended.in_time) {
      ended.in_time = false;
      kill(child, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return ended;
}

// Numbers a user could take for a result: JSON writes what is not finite as null.
bool has_nonsense(const Json& json) {
  if (json.is_null()) return true;
  if (json.is_number()) return !(std::abs(json.get<double>()) < 1e300);
  if (!json.is_structured()) return false;
  for (const Json& item : json)
    if (has_nonsense(item)) return true;
  return false;
}

bool is_nonsense(const std::string& text, const BadScene& bad) {
  if (bad.request) return text.rfind("$MeshFormat", 0) != 0 || text.find("nan") != std::string::npos;
  const Json result = Json::parse(text, nullptr, false);
  if (!bad.commands.empty()) return result.is_discarded() || has_nonsense(result);
  if (result.is_discarded() || !result.contains("solver")) return true;
  if (result["solver"].value("inverted", 0) > 0) return true;
  for (const char* part : {"markers", "cables", "chambers", "trajectory"})
    if (result.contains(part) && has_nonsense(result[part])) return true;
  if (result.contains("markers"))
    for (const Json& marker : result["markers"])
      for (const Json& x : marker["displacement_m"])
        if (!(std::abs(x.get<double>()) < kLargest_m)) return true;
  return false;
}

std::string outcome_of(const Ended& ended, const BadScene& bad, const std::string& folder) {
  if (std::filesystem::exists(folder + "/" + kTrace)) return "ran a script";
  const std::string errors = contents(folder + "/errors.txt");
  if (errors.find("bad_alloc") != std::string::npos) return "out of memory";
  if (!ended.in_time || (WIFSIGNALED(ended.status) && WTERMSIG(ended.status) == SIGXCPU)) return "hang";
  if (!WIFEXITED(ended.status)) return "crash";
  switch (WEXITSTATUS(ended.status)) {
    case 0:
      return is_nonsense(contents(folder + "/result.json"), bad) ? "silent nonsense" : "valid";
    case 1:
      return errors.empty() ? "status 1 without reason" : "status 1 with reason";
    case 2:
      return errors.empty() ? "error without message" : "clean error";
    default:
      return "crash";
  }
}

bool is_good(const std::string& outcome) {
  return outcome == "valid" || outcome == "clean error" || outcome == "status 1 with reason";
}

int check(const std::string& simulate, const std::string& folder, std::size_t part, unsigned seed) {
  std::map<std::string, int> counts;
  int bad = 0;
  std::vector<BadScene> scenes = bad_scenes(seed);
  for (BadScene& file : bad_files(seed)) scenes.push_back(std::move(file));
  for (std::size_t i = seed % part; i < scenes.size(); i += part) {
    const std::string here = folder + "/" + std::to_string(i);
    std::filesystem::remove_all(here);
    std::filesystem::create_directories(here);
    std::ofstream(here + "/scene.yaml", std::ios::binary) << scenes[i].text;
    for (const auto& [name, content] : scenes[i].files) std::ofstream(here + "/" + name, std::ios::binary) << content;
    const std::string outcome = outcome_of(run(simulate, scenes[i], here), scenes[i], here);
    ++counts[outcome];
    if (scenes[i].sound ? outcome == "valid" : is_good(outcome)) {
      std::filesystem::remove_all(here);
      continue;
    }
    ++bad;
    std::printf("%s: %s (%s)\n", outcome.c_str(), scenes[i].name.c_str(), here.c_str());
  }
  for (const auto& [outcome, count] : counts) std::printf("%6d %s\n", count, outcome.c_str());
  return bad == 0 ? 0 : 1;
}

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  const std::size_t part = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 1;
  const auto seed = static_cast<unsigned>(argc > 4 ? std::strtoul(argv[4], nullptr, 10) : 1);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  if (argc < 3 || part == 0) {
    std::fputs("usage: robustness_check SIMULATE FOLDER [PART [SEED]]\n", stderr);
    return 2;
  }
  return soft_robot_lab::check(argv[1], std::filesystem::absolute(argv[2]).string(), part, seed);
}
