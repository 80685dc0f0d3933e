// SPDX-License-Identifier: BSD-3-Clause
// Who asks the emulator, against its own socket.
#include "hardware/testbench/rig_control.h"

#include <atomic>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "hardware/emulator/control_socket.h"

namespace soft_robot_lab {
namespace {

// Answers each line with itself.
class Emulator : public testing::Test {
 protected:
  Emulator()
      : path_((std::filesystem::temp_directory_path() / ("rig_control_test_" + std::to_string(getpid()))).string()),
        socket_(path_),
        server_([this] {
          while (!done_) {
            socket_.serve([](const std::string& line) { return "ok " + line; });
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
          }
        }) {}
  ~Emulator() override {
    done_ = true;
    server_.join();
  }

  std::string path_;
  std::atomic<bool> done_{false};
  ControlSocket socket_;
  std::thread server_;
};

TEST_F(Emulator, IsAskedOneShortLineAtATime) {
  RigControl control(path_);
  EXPECT_EQ(control.ask("shafts"), "shafts");
  for (const std::string& text :
       {std::string("counts\nunplug"), std::string("counts\r"), std::string("a\0b", 3), std::string(100000, 'x')})
    EXPECT_THROW(control.ask(text), std::invalid_argument);
  EXPECT_EQ(control.ask("counts"), "counts");  // no answer is another's
}

TEST_F(Emulator, KeepsItsSocketFromASecondOne) {
  EXPECT_THROW(ControlSocket second(path_), std::runtime_error);
  EXPECT_EQ(RigControl(path_).ask("counts"), "counts");
}

// A socket that nobody listens on is what a killed emulator leaves.
TEST(ControlSocket, TakesTheNameOfALeftSocketButNotOfAFile) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("left_socket_" + std::to_string(getpid()))).string();
  const pid_t killed = fork();
  if (killed == 0) {
    const ControlSocket socket(path);
    _exit(0);  // without its destructor
  }
  waitpid(killed, nullptr, 0);
  ASSERT_TRUE(std::filesystem::exists(path));
  EXPECT_NO_THROW(ControlSocket socket(path));
  EXPECT_FALSE(std::filesystem::exists(path));
  std::ofstream(path) << "a file";
  EXPECT_THROW(ControlSocket socket(path), std::runtime_error);
  EXPECT_TRUE(std::filesystem::remove(path));
}

}  // namespace
}  // namespace soft_robot_lab
