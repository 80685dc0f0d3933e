// SPDX-License-Identifier: BSD-3-Clause
#include "recorder_process.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <thread>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace soft_robot_lab {
namespace {

[[noreturn]] void become(const std::vector<char*>& arguments, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGINT);
  if (getppid() != parent) _exit(127);  // it ended before
  setpgid(0, 0);                        // a Ctrl-C of the session comes through the session alone
  execvp(arguments[0], arguments.data());
  _exit(127);
}

}  // namespace

RecorderProcess::~RecorderProcess() { stop(10.0); }

void RecorderProcess::start(const std::vector<std::string>& command) {
  if (process()) throw std::runtime_error("it records already");
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(command.front() + " cannot be started: " + std::strerror(errno));
  if (child == 0) become(arguments, parent);
  process_ = child;
  wanted_ = true;
}

bool RecorderProcess::stop(double limit_s) {
  wanted_ = false;
  if (!process()) return true;
  constexpr int waits_per_signal = 50;
  const auto limit = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
  for (int waits = 0; process(); ++waits) {
    if (waits % waits_per_signal == 0) kill(process_, SIGINT);
    if (std::chrono::steady_clock::now() > limit) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

std::optional<pid_t> RecorderProcess::process() {
  look();
  return process_ > 0 ? std::optional(process_) : std::nullopt;
}

bool RecorderProcess::ended_by_itself() {
  look();
  return wanted_ && process_ < 0;
}

void RecorderProcess::look() {
  int status = 0;
  if (process_ > 0 && waitpid(process_, &status, WNOHANG) == process_) process_ = -1;
}

}  // namespace soft_robot_lab
