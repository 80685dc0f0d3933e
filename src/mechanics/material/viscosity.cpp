// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/viscosity.h"

#include "settings/require.h"

namespace soft_robot_lab {

void Viscosity::validate() const {
  const auto not_negative = [](const char* field, double value) {
    require(value >= 0.0 && value < 1e15, field, value, "[0, 1e15)");
  };
  not_negative("damping.rayleigh_mass_per_s", rayleigh_mass_per_s);
  not_negative("damping.rayleigh_stiffness_s", rayleigh_stiffness_s);
  not_negative("hysteresis.stiffness_ratio", hysteresis_ratio);
  require(relaxation_time_s > 0.0 && relaxation_time_s < 1e15, "hysteresis.relaxation_time_s", relaxation_time_s,
          "(0, 1e15)");
}

}  // namespace soft_robot_lab
