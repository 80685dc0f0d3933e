// SPDX-License-Identifier: BSD-3-Clause
// The limits of limits.h for a number whose unit its name ends with.
#pragma once

#include <string>

#include <Eigen/Core>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// Of the last key of a path: "obstacles[0].velocity_m_s" is in m/s, "stiffness_n_m" in N/m. Any where limits.h has no
// limit for the unit.
AllowedRange range_of_unit(const std::string& path);

// For values that come by services and topics; without a unit they are within limits::kNumber. Throws
// std::invalid_argument: "target_m: 1e+19 is not in [-1000, 1000]".
void require_in_unit(const std::string& name, double value);
void require_in_unit(const std::string& name, const Eigen::Ref<const Eigen::VectorXd>& values);

}  // namespace soft_robot_lab
