// SPDX-License-Identifier: BSD-3-Clause
// The serial port on a pseudo-terminal in place of the device.
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include "hardware/motor/serial_port.h"

namespace soft_robot_lab {
namespace {

class SerialPort : public testing::Test {
 protected:
  void SetUp() override {
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    ASSERT_GE(master_, 0);
    ASSERT_EQ(grantpt(master_), 0);
    ASSERT_EQ(unlockpt(master_), 0);
    device_ = ptsname(master_);
  }
  void TearDown() override { unplug(); }
  void unplug() {
    if (master_ >= 0) close(master_);
    master_ = -1;
  }
  int master_ = -1;
  std::string device_;
};

using Bytes = std::vector<std::uint8_t>;

TEST_F(SerialPort, PassesEveryByteUnchanged) {
  const auto port = open_serial_port(device_);
  EXPECT_TRUE(port->read().empty());
  Bytes all;
  for (int i = 0; i < 256; ++i) all.push_back(static_cast<std::uint8_t>(i));
  port->write(all);
  Bytes heard(512);
  ASSERT_EQ(read(master_, heard.data(), heard.size()), 256);
  heard.resize(256);
  EXPECT_EQ(heard, all);
  ASSERT_EQ(write(master_, all.data(), all.size()), 256);
  EXPECT_EQ(port->read(), all);
}

TEST_F(SerialPort, SaysWhenTheDeviceIsGone) {
  const auto port = open_serial_port(device_);
  unplug();
  EXPECT_THROW(port->read(), PortError);
}

TEST_F(SerialPort, IsForOneProgramOnly) {
  const int other = open(device_.c_str(), O_RDWR | O_NOCTTY);
  ASSERT_EQ(flock(other, LOCK_EX | LOCK_NB), 0);
  EXPECT_THROW(open_serial_port(device_), PortError);
  close(other);
  const auto port = open_serial_port(device_);
  try {
    open_serial_port(device_);
    ADD_FAILURE() << "opened twice";
  } catch (const PortError& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, device_.size()), device_);
  }
}

TEST_F(SerialPort, RefusesWhatIsNoSerialDevice) {
  EXPECT_THROW(open_serial_port("/nowhere/at/all"), PortError);
  EXPECT_THROW(open_serial_port("/dev/null"), PortError);
}

}  // namespace
}  // namespace soft_robot_lab
