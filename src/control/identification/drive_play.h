// SPDX-License-Identifier: BSD-3-Clause
// Where drives with backlash leave their cables: pulling, a cable follows at once; paying out, the drive turns through
// its play first, and the cable stays shorter by it than commanded.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

struct DriveEnds {
  std::vector<double> commands;  // behind the play, by actuator
  std::vector<double> slopes;    // d length of cable / d backlash there: 0 or -1
};

class DrivePlay {
 public:
  // `backlash_m` by cable, >= 0; at the start no play is used up. Throws std::invalid_argument for an unknown actuator,
  // and for one whose command is no length.
  DrivePlay(const Simulation& simulation, const std::map<std::string, double>& backlash_m);

  // The drives turn there, straight on.
  DriveEnds go(const std::vector<double>& commands);

 private:
  std::vector<double> plays_, least_, slopes_;  // plays and least commands in units of the command
  std::vector<double> ends_;                    // empty before the first way
};

}  // namespace soft_robot_lab
