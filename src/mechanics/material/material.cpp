// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/material.h"

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <tuple>

namespace soft_robot_lab {
namespace {

void require(bool ok, const char* field, double value, const std::string& range) {
  if (ok) return;
  std::ostringstream message;
  message << "material." << field << ": " << value << " is out of range " << range;
  throw std::invalid_argument(message.str());
}

bool is_modulus(double value) { return value > 0.0 && value < 1e15; }

// Y(phi) = c1 phi + c2 phi^2 + c3 phi^3 must grow with shear, Y' > 0 for all phi >= 0 (Baker & Ericksen 1954).
void require_growing(double c1_pa, double c2_pa, double c3_pa) {
  require(is_modulus(c1_pa), "c1_pa", c1_pa, "(0, 1e15)");
  require(c3_pa >= 0.0 && c3_pa < 1e15, "c3_pa", c3_pa,
          "[0, 1e15): with a negative one the energy falls at large stretch");
  const double least_pa = c3_pa > 0.0 ? -std::sqrt(3.0 * c1_pa * c3_pa) : 0.0;
  std::ostringstream range;
  range << (c3_pa > 0.0 ? "(" : "[") << least_pa << ", 1e15): beyond, stress falls while the stretch grows";
  require((c2_pa > least_pa || c2_pa == 0.0) && c2_pa < 1e15, "c2_pa", c2_pa, range.str());
}

}  // namespace

Material Material::mooney_rivlin(double c10_pa, double c01_pa, double poissons_ratio, double density_kg_m3) {
  Material material;
  material.model = MaterialModel::mooney_rivlin;
  material.youngs_modulus_pa = 4.0 * (c10_pa + c01_pa) * (1.0 + poissons_ratio);
  material.poissons_ratio = poissons_ratio;
  material.density_kg_m3 = density_kg_m3;
  material.c01_pa = c01_pa;
  return material;
}

Material Material::yeoh(double c1_pa, double c2_pa, double c3_pa, double poissons_ratio, double density_kg_m3) {
  Material material = mooney_rivlin(c1_pa, 0.0, poissons_ratio, density_kg_m3);
  material.model = MaterialModel::yeoh;
  material.c2_pa = c2_pa;
  material.c3_pa = c3_pa;
  return material;
}

void Material::validate() const {
  require(poissons_ratio >= 0.0 && poissons_ratio < 0.5, "poissons_ratio", poissons_ratio, "[0, 0.5)");
  require(density_kg_m3 > 0.0 && density_kg_m3 < 1e6, "density_kg_m3", density_kg_m3, "(0, 1e6)");
  switch (model) {
    case MaterialModel::neo_hookean:
      require(is_modulus(youngs_modulus_pa), "youngs_modulus_pa", youngs_modulus_pa, "(0, 1e15)");
      break;
    case MaterialModel::mooney_rivlin:
      require(c01_pa >= 0.0 && c01_pa < 1e15, "c01_pa", c01_pa,
              "[0, 1e15): with a negative one the energy falls at large stretch");
      require(is_modulus(lame_mu_pa()) && c10_pa() >= -1e-9 * c01_pa, "c10_pa", c10_pa(),
              "[0, 1e15), not zero with c01_pa");
      break;
    case MaterialModel::yeoh:
      require_growing(c10_pa(), c2_pa, c3_pa);
      break;
  }
}

bool operator==(const Material& a, const Material& b) {
  const auto numbers = [](const Material& m) {
    return std::make_tuple(m.model, m.youngs_modulus_pa, m.poissons_ratio, m.density_kg_m3, m.c01_pa, m.c2_pa, m.c3_pa);
  };
  return numbers(a) == numbers(b);
}

}  // namespace soft_robot_lab
