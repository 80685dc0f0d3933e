// SPDX-License-Identifier: BSD-3-Clause
#include "file_guard.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace soft_robot_lab {
namespace {

struct Made {
  std::size_t i;
  struct stat file;
};

std::optional<struct stat> look_at(const std::string& path) {
  struct stat file {};
  if (lstat(path.c_str(), &file) != 0) return std::nullopt;
  return file;
}

bool same(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino && a.st_ctim.tv_sec == b.st_ctim.tv_sec &&
         a.st_ctim.tv_nsec == b.st_ctim.tv_nsec;
}

// Holds nothing of its parent's open but the line to it, and outlives the signals that end a session.
void stand_apart(int line) {
  setsid();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, SIG_IGN);
  if (dup2(line, STDIN_FILENO) < 0) _exit(1);
  close_range(STDIN_FILENO + 1, ~0U, 0);
}

[[noreturn]] void guard(const std::vector<std::string>& paths, int line) {
  stand_apart(line);
  std::vector<std::optional<struct stat>> made(paths.size());
  Made one{};
  while (read(STDIN_FILENO, &one, sizeof one) == sizeof one) made[one.i] = one.file;
  for (std::size_t j = 0; j < paths.size(); ++j) {
    const auto present = look_at(paths[j]);
    if (made[j] && present && same(*made[j], *present)) unlink(paths[j].c_str());
  }
  _exit(0);
}

}  // namespace

FileGuard::FileGuard(std::vector<std::string> paths) : paths_(std::move(paths)) {
  int ends[2] = {-1, -1};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error(std::string("socketpair: ") + std::strerror(errno));
  guard_ = fork();
  if (guard_ == 0) {
    close(ends[1]);
    guard(paths_, ends[0]);
  }
  close(ends[0]);
  line_ = ends[1];
  if (guard_ < 0) {
    close(line_);
    throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  }
}

FileGuard::~FileGuard() {
  close(line_);
  waitpid(guard_, nullptr, 0);
}

void FileGuard::made(std::size_t i) {
  const auto file = look_at(paths_.at(i));
  if (!file) return;
  const Made one{i, *file};
  send(line_, &one, sizeof one, MSG_NOSIGNAL);  // where the guard is gone, this program still removes its files itself
}

}  // namespace soft_robot_lab
