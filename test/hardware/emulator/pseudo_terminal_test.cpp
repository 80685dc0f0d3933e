// SPDX-License-Identifier: BSD-3-Clause
// The emulated rig's serial device, as the driver finds it.
#include "hardware/emulator/pseudo_terminal.h"

#include <fstream>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace soft_robot_lab {
namespace {

bool is_exclusive(int file) {
  int exclusive = -1;
  EXPECT_EQ(ioctl(file, TIOCGEXCL, &exclusive), 0);
  return exclusive != 0;
}

// A driver that was killed takes nothing back; where it was not root's, the next one could not open the device.
TEST(PseudoTerminal, ForgetsTheExclusiveModeOfADriverThatIsGone) {
  const std::string device = testing::TempDir() + "soft_robot_lab_terminal_" + std::to_string(getpid());
  PseudoTerminal terminal(device);
  terminal.plug();
  const int driver = open(device.c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(driver, 0);
  ASSERT_EQ(ioctl(driver, TIOCEXCL), 0);
  ASSERT_TRUE(is_exclusive(driver));
  close(driver);

  terminal.read();
  const int next = open(device.c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(next, 0);
  EXPECT_FALSE(is_exclusive(next));
  close(next);
}

// As root, a device of the real rig would be gone.
TEST(PseudoTerminal, TakesTheNameOfALeftLinkButNotOfAFile) {
  const std::string device = testing::TempDir() + "soft_robot_lab_name_" + std::to_string(getpid());
  ASSERT_EQ(symlink("/dev/pts/no_such_terminal", device.c_str()), 0);
  {
    PseudoTerminal terminal(device);
    terminal.plug();
    EXPECT_EQ(access(device.c_str(), R_OK | W_OK), 0);
  }
  EXPECT_NE(access(device.c_str(), F_OK), 0);
  std::ofstream(device) << "a file";
  PseudoTerminal terminal(device);
  EXPECT_THROW(terminal.plug(), std::runtime_error);
  EXPECT_EQ(access(device.c_str(), F_OK), 0);
  unlink(device.c_str());
}

}  // namespace
}  // namespace soft_robot_lab
