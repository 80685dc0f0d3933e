// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

namespace soft_robot_lab {

// How often the state of a session is published: at most `rate_hz` times in each second of the session, and where the
// session is slower than real time, in each second of the machine.
class PublishLimit {
 public:
  explicit PublishLimit(double rate_hz) : period_s_((1.0 - rounding) / rate_hz) {}

  // Whether a state of this time is to be published; if so, the next has to keep its distance from it. The session's
  // clock may be set back.
  bool due(double session_s, double machine_s) {
    if (std::abs(session_s - session_s_) < period_s_ && machine_s - machine_s_ < period_s_) return false;
    session_s_ = session_s;
    machine_s_ = machine_s;
    return true;
  }

 private:
  static constexpr double rounding = 1.0e-6;  // of sums of time steps
  static constexpr double never = -std::numeric_limits<double>::infinity();
  double period_s_;
  double session_s_ = never, machine_s_ = never;
};

}  // namespace soft_robot_lab
