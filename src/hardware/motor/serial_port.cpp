// SPDX-License-Identifier: BSD-3-Clause
#include "serial_port.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

namespace soft_robot_lab {
namespace {

class SerialPort : public Port {
 public:
  explicit SerialPort(const std::string& device)
      : device_(device), file_(open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    if (file_ < 0) fail();
    try {
      take_alone();
      set_raw();
    } catch (const PortError&) {
      close(file_);
      throw;
    }
  }
  ~SerialPort() override { close(file_); }
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  std::vector<std::uint8_t> read() override {
    std::vector<std::uint8_t> bytes(512);
    const ssize_t count = ::read(file_, bytes.data(), bytes.size());
    if (count < 0 && errno != EAGAIN && errno != EINTR) fail();
    if (count == 0) throw PortError(device_ + ": the device is gone");
    bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return bytes;
  }

  // Frames are small: what a full buffer does not take is lost, and the frame is sent again.
  void write(const std::vector<std::uint8_t>& bytes) override {
    if (::write(file_, bytes.data(), bytes.size()) < 0 && errno != EAGAIN && errno != EINTR) fail();
  }

 private:
  [[noreturn]] void fail() const { throw PortError(device_ + ": " + std::strerror(errno)); }

  // The lock keeps out who asks for it, the exclusive mode everyone else but root.
  void take_alone() {
    if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
      throw PortError(device_ + (errno == EWOULDBLOCK ? ": in use by another program" : ": cannot be locked"));
    }
    if (ioctl(file_, TIOCEXCL) != 0) fail();
  }

  void set_raw() {
    termios raw{};
    if (tcgetattr(file_, &raw) != 0) fail();
    cfmakeraw(&raw);
    cfsetspeed(&raw, B115200);
    raw.c_cflag |= CLOCAL | CREAD;
    raw.c_cflag &= ~static_cast<tcflag_t>(HUPCL | CRTSCTS | CSTOPB);  // hanging up would reset the board
    raw.c_cc[VMIN] = 1;  // with O_NONBLOCK: reading nothing is an error EAGAIN, reading the end is 0
    raw.c_cc[VTIME] = 0;
    if (tcsetattr(file_, TCSANOW, &raw) != 0 || tcflush(file_, TCIOFLUSH) != 0) fail();
  }

  std::string device_;
  int file_;
};

}  // namespace

std::unique_ptr<Port> open_serial_port(const std::string& device) { return std::make_unique<SerialPort>(device); }

}  // namespace soft_robot_lab
