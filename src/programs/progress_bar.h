// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

namespace soft_robot_lab {

// On a terminal a bar that is drawn over itself; elsewhere a line whenever something new begins. Both on the standard
// error.
class ProgressBar {
 public:
  explicit ProgressBar(std::string name) : name_(std::move(name)), terminal_(isatty(STDERR_FILENO) == 1) {}
  ~ProgressBar() {
    if (terminal_) std::fputs("\r\033[K", stderr);
  }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(double fraction, const std::string& what) {
    const int percent = static_cast<int>(100.0 * std::clamp(fraction, 0.0, 1.0));
    if (terminal_) {
      const int full = percent * kWidth / 100;
      std::fprintf(stderr, "\r\033[K%s [%s%s] %3d %% %s", name_.c_str(), std::string(full, '#').c_str(),
                   std::string(kWidth - full, '.').c_str(), percent, what.c_str());
      std::fflush(stderr);
    } else if (what != last_) {
      std::fprintf(stderr, "%s: %d %%: %s\n", name_.c_str(), percent, what.c_str());
    }
    last_ = what;
  }

 private:
  static constexpr int kWidth = 30;
  std::string name_;
  bool terminal_;
  std::string last_;
};

}  // namespace soft_robot_lab
