#include "soft_robot_lab/sim/material.h"

#include <sstream>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

void require(bool ok, const char* field, double value, const char* range) {
  if (ok) return;
  std::ostringstream message;
  message << "material." << field << ": " << value << " is out of range " << range;
  throw std::invalid_argument(message.str());
}

}  // namespace

void Material::validate() const {
  require(youngs_modulus_pa > 0.0 && youngs_modulus_pa < 1e15, "youngs_modulus_pa", youngs_modulus_pa, "(0, 1e15)");
  require(poissons_ratio >= 0.0 && poissons_ratio < 0.5, "poissons_ratio", poissons_ratio, "[0, 0.5)");
  require(density_kg_m3 > 0.0 && density_kg_m3 < 1e6, "density_kg_m3", density_kg_m3, "(0, 1e6)");
}

}  // namespace soft_robot_lab
