// SPDX-License-Identifier: BSD-3-Clause
// What the runs of the chart prove: how cheap one per cent is, and who is beaten by how much.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "speed_measurement.h"

namespace soft_robot_lab {

struct SpeedClaims {
  nlohmann::ordered_json numbers;
  std::string words;  // the same in a paragraph
};

SpeedClaims check_claims(const SpeedLadder& ladder, const std::vector<SpeedRun>& runs);

}  // namespace soft_robot_lab
