// SPDX-License-Identifier: BSD-3-Clause
// Ctrl-C and SIGTERM, for programs that keep what they have done until then.
#pragma once

namespace soft_robot_lab {

// From now on the first of them makes interrupted() true, in every thread; one that comes more than 0.3 s later ends
// the program at once.
void heed_interrupts();
bool interrupted();

}  // namespace soft_robot_lab
