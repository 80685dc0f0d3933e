#include "soft_robot_lab/design/timed_process.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

extern char** environ;

namespace soft_robot_lab {
namespace {

// A process in a group of its own, so that the group can be killed.
pid_t start(const std::vector<std::string>& command, const std::string& error_file) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, 2, error_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  pid_t process = 0;
  const int error = posix_spawn(&process, arguments[0], &files, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) throw std::runtime_error(command[0] + " cannot be started: " + std::strerror(error));
  return process;
}

}  // namespace

ProcessEnd run_with_limit(const std::vector<std::string>& command, const std::string& error_file, double limit_s) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  const pid_t process = start(command, error_file);
  int status = 0;
  bool timed_out = false;
  for (;;) {
    const pid_t ended = waitpid(process, &status, timed_out ? 0 : WNOHANG);
    if (ended == process) break;
    if (ended < 0 && errno != EINTR) throw std::runtime_error(command[0] + ": " + std::strerror(errno));
    if (!timed_out && std::chrono::duration<double>(Clock::now() - begin).count() > limit_s) {
      timed_out = true;
      kill(-process, SIGKILL);
    }
    if (!timed_out) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (timed_out) return {ProcessEnd::Kind::timed_out, 0};
  if (WIFSIGNALED(status)) return {ProcessEnd::Kind::signalled, WTERMSIG(status)};
  return {ProcessEnd::Kind::exited, WEXITSTATUS(status)};
}

}  // namespace soft_robot_lab
