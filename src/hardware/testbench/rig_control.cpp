// SPDX-License-Identifier: BSD-3-Clause
#include "rig_control.h"

#include <cerrno>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "answers.h"
#include "line_socket.h"
#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t kLongestCommand = limits::kCommandLine_bytes;

}  // namespace

std::string unwrap(const std::string& command, const std::string& answer) {
  if (answer.rfind("ok", 0) == 0) return answer.size() > 3 ? answer.substr(3) : "";
  throw std::invalid_argument("rig_emulator: " + command + ": " + answer);
}

std::vector<ShaftTruth> read_shafts(const std::string& text) {
  std::istringstream words(text);
  double time_us = 0.0;
  words >> time_us;
  std::vector<ShaftTruth> shafts;
  for (ShaftTruth shaft{}; words >> shaft.shaft_steps >> shaft.spool_steps >> shaft.moving;) shafts.push_back(shaft);
  return shafts;
}

std::vector<double> read_pressures(const std::string& text) {
  std::istringstream words(text);
  double time_us = 0.0;
  words >> time_us;
  std::vector<double> pressures_pa;
  for (double pressure_pa = 0.0; words >> pressure_pa;) pressures_pa.push_back(pressure_pa);
  return pressures_pa;
}

RigControl::RigControl(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) throw std::runtime_error(path + ": too long for a socket");
  std::memcpy(address.sun_path, path.c_str(), path.size());
  const int file = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  lines_ = std::make_unique<LineSocket>(file);
  if (file < 0 || connect(file, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0) {
    throw std::runtime_error(path + ": " + std::strerror(errno));
  }
}

RigControl::~RigControl() = default;

std::string RigControl::ask(const std::string& command) {
  if (command.size() > kLongestCommand)
    throw std::invalid_argument("a command of " + std::to_string(command.size()) + " characters is out of range [0, " +
                                std::to_string(kLongestCommand) + "]");
  return unwrap(command, lines_->ask(command));
}

std::vector<ShaftTruth> RigControl::shafts() { return read_shafts(ask("shafts")); }

std::vector<double> RigControl::pressures_pa() { return read_pressures(ask("pressures")); }

}  // namespace soft_robot_lab
