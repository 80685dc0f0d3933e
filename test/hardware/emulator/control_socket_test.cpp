// SPDX-License-Identifier: BSD-3-Clause
// The socket by which an emulated rig is asked.
#include "hardware/emulator/control_socket.h"

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

namespace soft_robot_lab {
namespace {

TEST(ControlSocket, IsItsOwnersAloneWhateverTheUmask) {
  std::string folder = (std::filesystem::temp_directory_path() / "socket_test_XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  const std::string path = folder + "/control";
  const mode_t before = umask(0);
  for (const mode_t mask : {0, 022, 077, 0777}) {
    umask(mask);
    const ControlSocket control(path);
    struct stat status {};
    EXPECT_EQ(lstat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, 0600u) << std::oct << mask;
  }
  umask(before);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace soft_robot_lab
