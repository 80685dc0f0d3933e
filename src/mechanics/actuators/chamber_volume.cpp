// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "soft_robot_lab/mechanics/actuators/chamber.h"

namespace soft_robot_lab {
namespace {

constexpr double kThinnest = 0.01;  // of the outside pressure: below this absolute pressure the law goes on straight

// The law is taken at the multiplier's pressure P, not at the volume's: V = amount / P - dead volume is all but
// straight where p is small against P0, stands for any volume (also a collapsed chamber's, which is negative), and a
// body far softer than gas lets its volume follow at once.
ConstraintLaw gas_law(const IsothermalGas& gas, double volume_m3, double multiplier) {
  const double thinnest_pa = kThinnest * gas.outside_pressure_pa;
  const double wanted_pa = gas.outside_pressure_pa - multiplier;
  const double pressure_pa = std::max(wanted_pa, thinnest_pa);
  ConstraintLaw law;
  law.compliance = gas.amount_j / (pressure_pa * pressure_pa);
  const double gas_volume_m3 =
      gas.amount_j / pressure_pa - gas.dead_volume_m3 + law.compliance * (pressure_pa - wanted_pa);
  law.offset = volume_m3 - gas_volume_m3 + law.compliance * multiplier;
  law.offset_per_command = gas.dead_volume_per_command - gas.amount_per_command / pressure_pa;
  return law;
}

Eigen::Matrix3Xd gradient_m2(const EnclosedVolume& surface, const Eigen::Matrix3Xd& positions_m) {
  Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, positions_m.cols());
  surface.add_gradient(positions_m, 1.0, gradient);
  return gradient;
}

}  // namespace

double ChamberVolume::value(const Eigen::Matrix3Xd& positions_m, const DriveState& drive) const {
  const std::optional<Eigen::Matrix3Xd> before_m = supply_.load_positions_m(drive);
  if (!before_m) return volume_m3(positions_m);
  return volume_m3(*before_m) + gradient_m2(surface_, *before_m).cwiseProduct(positions_m - *before_m).sum();
}

void ChamberVolume::add_gradient(const Eigen::Matrix3Xd& positions_m, const DriveState& drive, double scale,
                                 Eigen::Matrix3Xd& gradient) const {
  if (const std::optional<Eigen::Matrix3Xd> before_m = supply_.load_positions_m(drive)) {
    gradient += scale * gradient_m2(surface_, *before_m);
  } else {
    surface_.add_gradient(positions_m, scale, gradient);
  }
}

void ChamberVolume::add_hessian(const Eigen::Matrix3Xd& positions_m, const DriveState& drive, double scale,
                                CliqueSink& hessian) const {
  if (!supply_.load_positions_m(drive)) surface_.add_hessian(positions_m, scale, hessian);
}

ConstraintLaw ChamberVolume::law(double volume_m3, double multiplier, const DriveState& drive) const {
  const GasSupply supply = supply_.supply(drive);
  if (!supply.load && !supply.regulated) return gas_law(supply.gas, volume_m3, multiplier);
  const double pressure_pa = supply.prescribed_pressure_pa + supply.gas.outside_pressure_pa;
  const double least_m3 = supply.gas.amount_j / pressure_pa, most_m3 = supply.most_gas.amount_j / pressure_pa;
  // Where even the most gas is too little for this volume, the pressure lies below what is asked for, and vice versa.
  if (supply.regulated && volume_m3 > most_m3) {
    ConstraintLaw law = gas_law(supply.most_gas, volume_m3, multiplier);
    law.min_multiplier = -supply.prescribed_pressure_pa;
    return law;
  }
  if (supply.regulated && volume_m3 < least_m3) {
    ConstraintLaw law = gas_law(supply.gas, volume_m3, multiplier);
    law.max_multiplier = -supply.prescribed_pressure_pa;
    return law;
  }
  ConstraintLaw law;
  law.min_multiplier = law.max_multiplier = -supply.prescribed_pressure_pa;
  law.multiplier_per_command = supply.regulated ? -1.0 : 0.0;
  return law;
}

}  // namespace soft_robot_lab
