#pragma once

namespace soft_robot_lab {

// Isotropic silicone at small strain. Defaults: Ecoflex 00-50.
struct Material {
  double youngs_modulus_pa = 264200.0;  // > 0
  double poissons_ratio = 0.4999;       // [0, 0.5); near 0.5 is almost incompressible
  double density_kg_m3 = 1070.0;        // > 0

  double lame_mu_pa() const { return youngs_modulus_pa / (2.0 * (1.0 + poissons_ratio)); }
  double lame_lambda_pa() const {
    return youngs_modulus_pa * poissons_ratio / ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio));
  }
  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

}  // namespace soft_robot_lab
