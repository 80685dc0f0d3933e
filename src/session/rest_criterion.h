// SPDX-License-Identifier: BSD-3-Clause
// What counts as rest, of simulated and of tracked markers, in a session and in its recording.
#pragma once

namespace soft_robot_lab {

struct RestCriterion {
  double window_s = 0.5;  // simulated markers that stay for so long rest; tracked ones are averaged over it
  double simulated_motion_m = 5.0e-5;  // within which a simulated marker stays
  double measured_motion_m = 5.0e-4;   // between two windows, beyond what a tracked marker's own noise makes of rest
  int observations = 3;                // at least, of a tracked marker that counts in a window
  double longest_s = 5.0;              // of a recorded rest no more is averaged
};

}  // namespace soft_robot_lab
