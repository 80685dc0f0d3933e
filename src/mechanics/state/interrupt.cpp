// SPDX-License-Identifier: BSD-3-Clause
#include "interrupt.h"

#include <cmath>
#include <sstream>

namespace soft_robot_lab {

Interrupt::Solve::Solve(Interrupt& interrupt, double limit_s) : interrupt_(interrupt) {
  interrupt.limit_s_ = limit_s;
  interrupt.begin_ = Clock::now();
  interrupt.runs_ = interrupt.ends || std::isfinite(limit_s);
}

void Interrupt::ask() const {
  if (ends && ends()) throw SolveInterrupted{"interrupted"};
  if (!std::isfinite(limit_s_) || std::chrono::duration<double>(Clock::now() - begin_).count() < limit_s_) return;
  std::ostringstream why;
  why << "interrupted: it was not solved within solver.time_limit_s = " << limit_s_ << " s";
  throw SolveInterrupted{why.str()};
}

}  // namespace soft_robot_lab
