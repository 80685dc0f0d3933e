// SPDX-License-Identifier: BSD-3-Clause
#include "line_socket.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <sys/socket.h>
#include <unistd.h>

namespace soft_robot_lab {

LineSocket::~LineSocket() { close(); }

void LineSocket::close() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

std::string LineSocket::ask(const std::string& line) {
  const auto is_control = [](unsigned char c) { return (c < ' ' && c != '\t') || c == 127; };
  if (std::any_of(line.begin(), line.end(), is_control))
    throw std::invalid_argument("a command must be one line of text; it holds a control character");
  const std::string text = line + "\n";
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t count = send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno != EINTR) throw std::runtime_error(std::string("rig_emulator: ") + std::strerror(errno));
    if (count > 0) sent += static_cast<std::size_t>(count);
  }
  return read_line();
}

std::string LineSocket::read_line() {
  while (true) {
    const auto end = received_.find('\n');
    if (end != std::string::npos) {
      const std::string line = received_.substr(0, end);
      received_.erase(0, end + 1);
      return line;
    }
    char bytes[4096];
    const ssize_t count = recv(socket_, bytes, sizeof(bytes), 0);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw std::runtime_error(std::string("rig_emulator: ") + std::strerror(errno));
    if (count == 0) throw std::runtime_error("rig_emulator: ended without an answer");
    received_.append(bytes, static_cast<std::size_t>(count));
  }
}

}  // namespace soft_robot_lab
