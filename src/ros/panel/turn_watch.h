// SPDX-License-Identifier: BSD-3-Clause
// How long a window leaves its user without an answer: the longest time between two turns of its event loop. Knows no
// window.
#pragma once

#include <optional>

namespace soft_robot_lab {

struct TurnGap {
  double wall_s = 0.0;
  double work_s = 0.0;  // of that, what the window's own thread computed; the rest it slept, or others had its core
};

class TurnWatch {
 public:
  // The clocks of machine and thread, at each turn.
  void turn(double wall_s, double work_s);
  // The longest gap, and the most work between two turns, since this was last asked.
  TurnGap take();

 private:
  std::optional<TurnGap> last_;
  TurnGap longest_;
};

}  // namespace soft_robot_lab
