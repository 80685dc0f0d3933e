// SPDX-License-Identifier: BSD-3-Clause
#include "worker_channel.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace soft_robot_lab {
namespace {

struct Pipe {
  int read_end = -1, write_end = -1;
  Pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
    read_end = ends[0];
    write_end = ends[1];
  }
};

// In a process group of its own, so that Ctrl-C reaches the master alone.
pid_t start(const std::vector<std::string>& command, int input, int output) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t process = -1;
  const int error = posix_spawnp(&process, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) throw std::runtime_error(command[0] + " cannot be started: " + std::strerror(error));
  return process;
}

}  // namespace

WorkerChannel::WorkerChannel(const WorkerCommand& command) {
  const Pipe to, from;
  input_ = to.write_end;
  output_ = from.read_end;
  std::string trouble;
  try {
    process_ = start(command.command, to.read_end, from.write_end);
  } catch (const std::runtime_error& error) {
    trouble = error.what();
  }
  close(to.read_end);
  close(from.write_end);
  if (trouble.empty()) return;
  close(input_);
  close(output_);
  throw std::runtime_error(trouble);
}

// Without its input a worker ends by itself, and a launcher with it, as long as its output has a reader; what does not
// is killed.
WorkerChannel::~WorkerChannel() {
  close(input_);
  bool ended = false;
  for (int i = 0; i < 200 && !ended; ++i) {
    ended = waitpid(process_, nullptr, WNOHANG) != 0;
    if (i == 150) kill(-process_, SIGTERM);
    if (!ended) usleep(10000);
  }
  close(output_);
  if (ended) return;
  kill(-process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

bool WorkerChannel::send(const std::string& line) {
  const std::string text = line + "\n";
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = write(input_, text.data() + done, text.size() - done);
    if (count < 0 && errno != EINTR) return false;
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  return true;
}

std::vector<std::string> WorkerChannel::receive() {
  char buffer[65536];
  const ssize_t count = read(output_, buffer, sizeof(buffer));
  if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN)) ended_ = true;
  std::vector<std::string> lines;
  if (count <= 0) return lines;
  rest_.append(buffer, static_cast<std::size_t>(count));
  std::size_t begin = 0;
  for (std::size_t end; (end = rest_.find('\n', begin)) != std::string::npos; begin = end + 1)
    lines.push_back(rest_.substr(begin, end - begin));
  rest_.erase(0, begin);
  return lines;
}

}  // namespace soft_robot_lab
