// SPDX-License-Identifier: BSD-3-Clause
#include "pseudo_terminal.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

namespace soft_robot_lab {
namespace {

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what + ": " + std::strerror(errno)); }

void close_file(int& file) {
  if (file >= 0) close(file);
  file = -1;
}

}  // namespace

void PseudoTerminal::plug() {
  unplug();
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0) fail("pseudo-terminal");
  const char* name = ptsname(master_);
  if (name == nullptr) fail("pseudo-terminal");
  slave_ = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios raw{};
  if (slave_ < 0 || tcgetattr(slave_, &raw) != 0) fail(name);
  cfmakeraw(&raw);
  if (tcsetattr(slave_, TCSANOW, &raw) != 0) fail(name);
  remove_link();
  if (symlink(name, link_.c_str()) != 0) fail(link_);
}

// Of an emulator that was killed. What is no link may be a real device.
void PseudoTerminal::remove_link() const {
  struct stat file {};
  if (lstat(link_.c_str(), &file) != 0 && errno == ENOENT) return;
  if (!S_ISLNK(file.st_mode)) throw std::runtime_error(link_ + ": is there already, and is not an emulator's link");
  unlink(link_.c_str());
}

void PseudoTerminal::unplug() {
  if (master_ < 0) return;
  unlink(link_.c_str());
  close_file(slave_);
  close_file(master_);
}

std::vector<std::uint8_t> PseudoTerminal::read() {
  // A real device forgets the exclusive mode when its last user is gone; this one never is without one.
  if (slave_ >= 0) ioctl(slave_, TIOCNXCL);
  std::vector<std::uint8_t> bytes(256);
  const ssize_t count = master_ < 0 ? 0 : ::read(master_, bytes.data(), bytes.size());
  bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return bytes;
}

void PseudoTerminal::write(const std::vector<std::uint8_t>& bytes) {
  if (master_ < 0 || bytes.empty()) return;
  if (::write(master_, bytes.data(), bytes.size()) < 0) return;
}

}  // namespace soft_robot_lab
