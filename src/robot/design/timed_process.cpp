// SPDX-License-Identifier: BSD-3-Clause
#include "timed_process.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "used_time.h"

extern char** environ;

namespace soft_robot_lab {
namespace {

// All that the child needs, made before the fork: after it, a child of a program with threads may not allocate.
struct Start {
  std::vector<char*> arguments;
  const char* error_file;
  rlimit cpu_s;
  pid_t parent;
  int failed;  // where the child says why it could not start
};

[[noreturn]] void fail(const Start& start) {
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(start.failed, &error, sizeof(error));
  _exit(127);
}

void redirect(const Start& start, const char* path, int flags, int to) {
  const int file = open(path, flags, 0600);
  if (file < 0 || dup2(file, to) < 0) fail(start);
  if (file != to) close(file);
}

// A process in a group of its own, so that the group can be killed; it dies with the thread that waits for it, however
// that ends, and takes no more processor time than it may where even that is missed.
[[noreturn]] void become(const Start& start) {
  if (setpgid(0, 0) != 0 || prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || setrlimit(RLIMIT_CPU, &start.cpu_s) != 0)
    fail(start);
  if (getppid() != start.parent) _exit(127);  // it died meanwhile
  redirect(start, "/dev/null", O_RDONLY, STDIN_FILENO);
  redirect(start, "/dev/null", O_WRONLY, STDOUT_FILENO);
  redirect(start, start.error_file, O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
  execve(start.arguments[0], start.arguments.data(), environ);
  fail(start);
}

// Processor time of as many threads as may run, within what the parent itself may take.
rlimit processor_limit(double limit_s) {
  rlimit limit{};
  getrlimit(RLIMIT_CPU, &limit);
  const double wanted_s = std::ceil(limit_s) * std::max(1U, std::thread::hardware_concurrency()) + 1.0;
  if (wanted_s < static_cast<double>(limit.rlim_max)) limit.rlim_cur = limit.rlim_max = static_cast<rlim_t>(wanted_s);
  return limit;
}

pid_t start(const std::vector<std::string>& command, const std::string& error_file, double limit_s) {
  int pipe_ends[2];
  if (pipe2(pipe_ends, O_CLOEXEC) != 0)
    throw std::runtime_error(command[0] + " cannot be started: " + std::strerror(errno));
  Start with{{}, error_file.c_str(), processor_limit(limit_s), getpid(), pipe_ends[1]};
  for (const std::string& argument : command) with.arguments.push_back(const_cast<char*>(argument.c_str()));
  with.arguments.push_back(nullptr);
  const pid_t process = fork();
  if (process == 0) become(with);
  int error = process < 0 ? errno : 0;
  close(pipe_ends[1]);
  if (process > 0 && read(pipe_ends[0], &error, sizeof(error)) > 0) waitpid(process, nullptr, 0);
  close(pipe_ends[0]);
  if (error != 0) throw std::runtime_error(command[0] + " cannot be started: " + std::strerror(error));
  return process;
}

}  // namespace

ProcessEnd run_with_limit(const std::vector<std::string>& command, const std::string& error_file, double limit_s,
                          const std::function<bool()>& ends) {
  constexpr int waits_per_look = 4;
  const pid_t process = start(command, error_file, limit_s);
  UsedTime used(process);
  int status = 0;
  std::optional<ProcessEnd::Kind> killed;
  for (int waits = 1;; ++waits) {
    const pid_t ended = waitpid(process, &status, killed ? 0 : WNOHANG);
    if (ended == process) break;
    if (ended < 0 && errno != EINTR) throw std::runtime_error(command[0] + ": " + std::strerror(errno));
    if (waits % waits_per_look == 0) used.look();
    if (killed) continue;
    if (used.seconds() > limit_s) killed = ProcessEnd::Kind::timed_out;
    if (ends && ends()) killed = ProcessEnd::Kind::interrupted;
    if (killed) {
      kill(-process, SIGKILL);
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  if (killed) return {*killed, 0};
  if (WIFSIGNALED(status)) return {ProcessEnd::Kind::signalled, WTERMSIG(status)};
  return {ProcessEnd::Kind::exited, WEXITSTATUS(status)};
}

}  // namespace soft_robot_lab
