// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

namespace soft_robot_lab {

// Whether a hand holds a target: from when it moves it until it lets go. A window that is gone never lets go; one that
// holds it says so several times a second. Times [s] are of a clock that never goes back.
class HeldTarget {
 public:
  static constexpr double kSilence_s = 2.0;

  void take(double now_s) { heard_s_ = now_s; }
  void keep(double now_s) {
    if (held(now_s)) heard_s_ = now_s;
  }
  void let_go() { heard_s_.reset(); }
  bool held(double now_s) const { return heard_s_ && now_s - *heard_s_ < kSilence_s; }

 private:
  std::optional<double> heard_s_;
};

}  // namespace soft_robot_lab
