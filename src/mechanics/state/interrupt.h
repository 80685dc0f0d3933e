// SPDX-License-Identifier: BSD-3-Clause
// Ends a solve from within, because its caller asks for it or its limit of time has passed.
#pragma once

#include <chrono>
#include <functional>
#include <limits>
#include <string>

namespace soft_robot_lab {

// Thrown inside a solve, and caught where that began; never by what only reads a state.
struct SolveInterrupted {
  std::string why;
};

class Interrupt {
 public:
  std::function<bool()> ends;  // empty: never

  // Between its making and its end check() may throw. Without a limit of time, or anything to ask, it costs nothing.
  class Solve {
   public:
    Solve(Interrupt& interrupt, double limit_s);
    ~Solve() { interrupt_.runs_ = false; }
    Solve(const Solve&) = delete;
    Solve& operator=(const Solve&) = delete;

   private:
    Interrupt& interrupt_;
  };

  bool may_end() const { return runs_; }  // the solve that runs
  void check() const {
    if (runs_) ask();
  }

 private:
  using Clock = std::chrono::steady_clock;
  void ask() const;

  bool runs_ = false;
  double limit_s_ = std::numeric_limits<double>::infinity();
  Clock::time_point begin_;
};

}  // namespace soft_robot_lab
