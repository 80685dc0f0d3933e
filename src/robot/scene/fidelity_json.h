// SPDX-License-Identifier: BSD-3-Clause
// `fidelity` of result.json, and what the cache keeps: the same, and the choice as numbers.
#pragma once

#include <nlohmann/json.hpp>

#include "soft_robot_lab/robot/scene/fidelity.h"

namespace soft_robot_lab {

nlohmann::ordered_json fidelity_json(const FidelityReport& report);
nlohmann::ordered_json kept_json(const FidelityReport& report);
FidelityReport fidelity_from_json(const nlohmann::ordered_json& kept);  // throws nlohmann::json::exception

}  // namespace soft_robot_lab
