// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "soft_robot_lab/mechanics/actuators/chamber.h"

namespace soft_robot_lab {
namespace {

constexpr double kThinnest = 0.01;  // of the outside pressure: below this absolute pressure the law goes on straight

}  // namespace

double ChamberVolume::value(const Eigen::Matrix3Xd& positions_m) const {
  if (!load_) return volume_m3(positions_m);
  return load_volume_m3_ + load_gradient_m2_.cwiseProduct(positions_m - load_positions_m_).sum();
}

void ChamberVolume::add_gradient(const Eigen::Matrix3Xd& positions_m, double scale, Eigen::Matrix3Xd& gradient) const {
  if (load_) {
    gradient += scale * load_gradient_m2_;
  } else {
    surface_.add_gradient(positions_m, scale, gradient);
  }
}

void ChamberVolume::add_hessian(const Eigen::Matrix3Xd& positions_m, double scale, CliqueSink& hessian) const {
  if (!load_) surface_.add_hessian(positions_m, scale, hessian);
}

// The law is taken at the multiplier's pressure P, not at the volume's: V = amount / P - dead volume is all but
// straight where p is small against P0, stands for any volume (also a collapsed chamber's, which is negative), and a
// body far softer than gas lets its volume follow at once.
ConstraintLaw ChamberVolume::gas_law(const IsothermalGas& gas, double volume_m3, double multiplier) const {
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

ConstraintLaw ChamberVolume::law(double volume_m3, double multiplier) const {
  if (!load_ && !regulated_) return gas_law(gas_, volume_m3, multiplier);
  const double pressure_pa = prescribed_pressure_pa_ + gas_.outside_pressure_pa;
  const double least_m3 = gas_.amount_j / pressure_pa, most_m3 = most_gas_.amount_j / pressure_pa;
  // Where even the most gas is too little for this volume, the pressure lies below what is asked for, and vice versa.
  if (regulated_ && volume_m3 > most_m3) {
    ConstraintLaw law = gas_law(most_gas_, volume_m3, multiplier);
    law.min_multiplier = -prescribed_pressure_pa_;
    return law;
  }
  if (regulated_ && volume_m3 < least_m3) {
    ConstraintLaw law = gas_law(gas_, volume_m3, multiplier);
    law.max_multiplier = -prescribed_pressure_pa_;
    return law;
  }
  ConstraintLaw law;
  law.min_multiplier = law.max_multiplier = -prescribed_pressure_pa_;
  law.multiplier_per_command = regulated_ ? -1.0 : 0.0;
  return law;
}

void ChamberVolume::fill(const IsothermalGas& gas) {
  gas_ = gas;
  regulated_ = load_ = false;
}

void ChamberVolume::regulate(double gauge_pressure_pa, const IsothermalGas& least, const IsothermalGas& most) {
  gas_ = least;
  most_gas_ = most;
  prescribed_pressure_pa_ = gauge_pressure_pa;
  regulated_ = true;
  load_ = false;
}

void ChamberVolume::load(double gauge_pressure_pa, const Eigen::Matrix3Xd& positions_m) {
  prescribed_pressure_pa_ = gauge_pressure_pa;
  load_ = true;
  load_positions_m_ = positions_m;
  load_volume_m3_ = volume_m3(positions_m);
  load_gradient_m2_.setZero(3, positions_m.cols());
  surface_.add_gradient(positions_m, 1.0, load_gradient_m2_);
}

}  // namespace soft_robot_lab
