// SPDX-License-Identifier: BSD-3-Clause
// rviz on the screen that DISPLAY names, for tests that press its keys by xdotool.
#pragma once

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <ros/ros.h>
#include <sys/wait.h>
#include <unistd.h>

namespace soft_robot_lab {

class HiddenRviz {
 public:
  // A copy of that file that draws seldom, and asks for few commands of a workspace: software draws on the cores that
  // the robot needs.
  explicit HiddenRviz(const std::string& config) : config_(copy_that_draws_seldom(config)), process_(fork()) {
    if (process_ == 0) {
      setenv("ROS_HOME", home().c_str(), 1);  // where the panel keeps poses
      setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
      setenv("MALLOC_PERTURB_", "165", 1);  // what uses memory that it gave back, crashes
      execlp("rosrun", "rosrun", "soft_robot_lab", "session_rviz", "false", "-d", config_.c_str(), "__name:=panel_rviz",
             nullptr);
      _exit(127);
    }
    const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(120.0);
    while (std::system("xdotool search --onlyvisible --name RViz windowfocus >/dev/null 2>&1") != 0) {
      if (ros::WallTime::now() > limit) throw std::runtime_error("rviz shows no window");
      ros::WallDuration(0.5).sleep();
    }
  }
  HiddenRviz(const HiddenRviz&) = delete;
  HiddenRviz& operator=(const HiddenRviz&) = delete;
  ~HiddenRviz() {
    end();
    std::filesystem::remove(config_);
    std::filesystem::remove_all(home());
  }

  std::string home() const { return config_ + "_home"; }

  // As Ctrl-C does; its status, as waitpid gives it. Takes 10 s at most.
  int end() {
    if (status_) return *status_;
    kill(process_, SIGINT);
    int status = 0;
    for (int i = 0; i < 100 && waitpid(process_, &status, WNOHANG) == 0; ++i) ros::WallDuration(0.1).sleep();
    if (kill(process_, 0) == 0) {
      kill(process_, SIGKILL);
      waitpid(process_, &status, 0);
    }
    return *(status_ = status);
  }

  // As xdotool names them: alt+1, Prior, Home.
  void press(const std::string& keys) const {
    const std::string command = "xdotool search --onlyvisible --name RViz windowfocus key --delay 50 " + keys;
    if (std::system((command + " >/dev/null 2>&1").c_str()) != 0) throw std::runtime_error("xdotool: " + command);
  }
  // With the left button, of its window; `while_held` runs before the button comes up.
  template <typename Action>
  void drag(int from_x, int from_y, int to_x, int to_y, const Action& while_held) const {
    const auto place = [](int x, int y) { return " mousemove " + std::to_string(x) + " " + std::to_string(y); };
    point(place(from_x, from_y) + " sleep 0.3 mousedown 1 sleep 0.3");
    for (int i = 1; i <= 5; ++i)
      point(place(from_x + i * (to_x - from_x) / 5, from_y + i * (to_y - from_y) / 5) + " sleep 0.3");
    while_held();
    point(" mouseup 1");
  }
  void point(const std::string& moves) const {
    if (std::system(("xdotool" + moves + " >/dev/null 2>&1").c_str()) != 0) throw std::runtime_error("xdotool" + moves);
  }
  void take_picture(const std::string& file) const { std::system(("import -window root " + file).c_str()); }
  bool runs() const { return waitpid(process_, nullptr, WNOHANG) == 0; }

 private:
  static std::string copy_that_draws_seldom(const std::string& config) {
    std::ifstream in(config);
    std::string text((std::istreambuf_iterator<char>(in)), {});
    for (const auto& [key, value] : {std::pair("Frame Rate: ", "2"), std::pair("Workspace Steps: ", "5")}) {
      const auto place = text.find(key);
      if (place == std::string::npos) throw std::runtime_error(config + ": no " + key);
      const auto start = place + std::string(key).size();
      text.replace(start, text.find('\n', start) - start, value);
    }
    const std::string copy = std::filesystem::temp_directory_path() / ("panel_" + std::to_string(getpid()) + ".rviz");
    std::ofstream(copy) << text;
    return copy;
  }

  std::string config_;
  pid_t process_;
  std::optional<int> status_;  // once it has ended
};

}  // namespace soft_robot_lab
