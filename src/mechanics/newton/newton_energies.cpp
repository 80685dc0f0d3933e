// SPDX-License-Identifier: BSD-3-Clause
#include "newton_energies.h"

namespace soft_robot_lab {

NewtonEnergies::NewtonEnergies(const NewtonTables& tables)
    : elements(tables.elements),
      springs(elements.batches(), elements.slots()),
      terms(tables.terms),
      contact(tables.contact),
      loads(tables.loads_n) {}

ElementSums NewtonEnergies::sums_at(const Eigen::Matrix3Xd& positions_m) const {
  Eigen::Matrix3Xd unused = Eigen::Matrix3Xd::Zero(3, positions_m.cols());
  return elements.add_gradient(positions_m, Eigen::VectorXd::Zero(elements.multiplier_count()), unused);
}

double NewtonEnergies::volumetric_energy_j(const ElementSums& sums) const {
  return 0.5 * elements.sum_of_squares(elements.lambda_pa(), sums.volumetric_strain);
}

double NewtonEnergies::elastic_energy_j(const Eigen::Matrix3Xd& positions_m) const {
  const ElementSums sums = sums_at(positions_m);
  return sums.elastic_energy + volumetric_energy_j(sums);
}

Eigen::Matrix3Xd NewtonEnergies::volume_damping_n(const StrainTarget& damping, const Eigen::VectorXd& volumetric_strain,
                                                  const Eigen::Matrix3Xd& positions_m) const {
  if (damping.volume_ratio == 0.0) return Eigen::Matrix3Xd::Zero(3, positions_m.cols());
  Eigen::VectorXd beyond = volumetric_strain - damping.volume_from;
  beyond.tail(elements.fibre_count()).setZero();
  return elements.pressure_forces_n(positions_m, damping.volume_ratio * elements.lambda_pa().cwiseProduct(beyond));
}

}  // namespace soft_robot_lab
