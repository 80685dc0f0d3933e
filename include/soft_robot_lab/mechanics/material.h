// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace soft_robot_lab {

// Laws of elastic energy.
enum class MaterialModel { neo_hookean, mooney_rivlin, yeoh };

// Isotropic silicone: its moduli at small strain, and the constants with which its energy goes on from there (the
// energies stand in src/mechanics/material/material_law.h). Defaults: Ecoflex 00-50.
struct Material {
  double youngs_modulus_pa = 264200.0;  // > 0
  double poissons_ratio = 0.4999;       // [0, 0.5); near 0.5 is almost incompressible
  double density_kg_m3 = 1070.0;        // > 0
  MaterialModel model = MaterialModel::neo_hookean;
  double c01_pa = 0.0;              // of mooney_rivlin, >= 0
  double c2_pa = 0.0, c3_pa = 0.0;  // of yeoh

  // From the constants of the energy, as they are published: the shear modulus is 2 (c10 + c01), or 2 c1.
  static Material mooney_rivlin(double c10_pa, double c01_pa, double poissons_ratio, double density_kg_m3);
  static Material yeoh(double c1_pa, double c2_pa, double c3_pa, double poissons_ratio, double density_kg_m3);

  double lame_mu_pa() const { return youngs_modulus_pa / (2.0 * (1.0 + poissons_ratio)); }
  double lame_lambda_pa() const {
    return youngs_modulus_pa * poissons_ratio / ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio));
  }
  double c10_pa() const { return 0.5 * lame_mu_pa() - c01_pa; }  // c1 of yeoh

  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

bool operator==(const Material& a, const Material& b);

}  // namespace soft_robot_lab
