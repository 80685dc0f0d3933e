// SPDX-License-Identifier: BSD-3-Clause
#include "turn_watch.h"

#include <algorithm>
#include <utility>

namespace soft_robot_lab {

void TurnWatch::turn(double wall_s, double work_s) {
  if (last_) {
    longest_.wall_s = std::max(longest_.wall_s, wall_s - last_->wall_s);
    longest_.work_s = std::max(longest_.work_s, work_s - last_->work_s);
  }
  last_ = TurnGap{wall_s, work_s};
}

TurnGap TurnWatch::take() { return std::exchange(longest_, {}); }

}  // namespace soft_robot_lab
