// SPDX-License-Identifier: BSD-3-Clause
#include "control_socket.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t longest_line = limits::kCommandLine_bytes;

bool is_answered(const sockaddr_un& address) {
  const int file = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const bool answered = connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 ||
                        errno == EAGAIN;  // it has not yet taken others
  close(file);
  return answered;
}

// Of an emulator that was killed; nobody else's.
void remove_socket(const std::string& path, const sockaddr_un& address) {
  struct stat file {};
  if (lstat(path.c_str(), &file) != 0 && errno == ENOENT) return;
  if (!S_ISSOCK(file.st_mode)) throw std::runtime_error(path + ": is there already, and is not a socket");
  if (is_answered(address)) throw std::runtime_error(path + ": another emulator uses it");
  unlink(path.c_str());
}

}  // namespace

ControlSocket::ControlSocket(const std::string& path) : path_(path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) throw std::runtime_error(path + ": too long for a socket");
  std::memcpy(address.sun_path, path.c_str(), path.size());
  remove_socket(path, address);
  listener_ = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  // Linux gives the file the socket's mode less the umask.
  constexpr mode_t owner_alone = S_IRUSR | S_IWUSR;
  if (listener_ < 0 || fchmod(listener_, owner_alone) != 0 ||
      bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0 ||
      chmod(path.c_str(), owner_alone) != 0 || listen(listener_, 8) != 0) {
    throw std::runtime_error(path + ": " + std::strerror(errno));
  }
}

ControlSocket::~ControlSocket() {
  for (const auto& client : clients_) close(client.first);
  close(listener_);
  unlink(path_.c_str());
}

void ControlSocket::accept_all() {
  while (true) {
    const int client = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (client < 0) return;
    clients_[client];
  }
}

void ControlSocket::serve(const std::function<std::string(const std::string&)>& answer) {
  accept_all();
  for (auto client = clients_.begin(); client != clients_.end();) {
    if (serve(client->first, client->second, answer)) {
      ++client;
    } else {
      close(client->first);
      client = clients_.erase(client);
    }
  }
}

bool ControlSocket::serve(int client, std::string& text, const std::function<std::string(const std::string&)>& answer) {
  char bytes[512];
  const ssize_t count = recv(client, bytes, sizeof(bytes), 0);
  if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) return false;
  if (count > 0) text.append(bytes, static_cast<std::size_t>(count));
  for (auto end = text.find('\n'); end != std::string::npos; end = text.find('\n')) {
    const std::string reply = answer(text.substr(0, end)) + "\n";
    text.erase(0, end + 1);
    if (send(client, reply.data(), reply.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(reply.size())) return false;
  }
  if (text.size() <= longest_line) return true;
  const std::string reply = "error: a line has at most " + std::to_string(longest_line) + " characters\n";
  send(client, reply.data(), reply.size(), MSG_NOSIGNAL);
  return false;  // of who does not keep to it, nothing more is understood
}

}  // namespace soft_robot_lab
