// SPDX-License-Identifier: BSD-3-Clause
// What config/experiments/6.4.*.yaml say.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "control/configuration_table.h"
#include "lab_settings.h"

namespace soft_robot_lab {

// Beside the lab's files (LabFiles):
// configurations: [{name: a, contractions: [1, 1]}, ...]   # or syringe_ml; in the source's order
// come_back: [a, f]                # configurations that ask for the same, to be compared with the first of them
// mirror_axis: y                   # optional: whether each rest, mirrored across it, is a rest too
// shape: [beam_upper, ..., tip]    # markers that are drawn as a line, the last one is the tip
// seen_along: y                    # optional, y: the axis that the picture does not show
// drawn: [b, c, d]                 # optional: configurations in the picture; absent: all
struct GapSettings {
  LabFiles files;
  bool pneumatic = false;  // commands are ml, not contractions
  std::vector<Configuration> configurations;
  std::vector<std::string> come_back, shape, drawn;
  std::optional<int> mirror_axis;
  int seen_along = 1;

  const std::string& tip() const { return shape.back(); }
};

GapSettings read_gap_settings(const ExperimentContext& context, const std::string& name);

}  // namespace soft_robot_lab
