// SPDX-License-Identifier: BSD-3-Clause
// The energies that one thread's Newton method makes least, each with its scratch.
#pragma once

#include <Eigen/Core>

#include "mechanics/contact/contact_term.h"
#include "mechanics/elements/elements.h"
#include "mechanics/elements/strain_springs.h"
#include "newton_tables.h"

namespace soft_robot_lab {

// Dead loads of the nodes, 3 x nodes [N].
class NodalLoads {
 public:
  explicit NodalLoads(const Eigen::Matrix3Xd& own_n) : own_n_(own_n), pulled_n_(own_n), all_n_(own_n) {}

  const Eigen::Matrix3Xd& all_n() const { return all_n_; }
  // Besides the body's own loads, in place of what pulled and was added before.
  void pull(const Eigen::Matrix3Xd& forces_n) { all_n_ = pulled_n_ = own_n_ + forces_n; }
  // Besides what pulls, in place of what was added before.
  void add(const Eigen::Matrix3Xd& extra_n) { all_n_ = pulled_n_ + extra_n; }

 private:
  const Eigen::Matrix3Xd& own_n_;  // the tables'
  Eigen::Matrix3Xd pulled_n_, all_n_;
};

struct NewtonEnergies {
  explicit NewtonEnergies(const NewtonTables& tables);  // which outlive this

  Elements elements;
  StrainSprings springs;     // of viscosity
  const EnergyTerms& terms;  // of actuators
  ContactTerm contact;
  bool soft_contact = false;  // regularised, while an energy is descended
  NodalLoads loads;

  ElementSums sums_at(const Eigen::Matrix3Xd& positions_m) const;
  double volumetric_energy_j(const ElementSums& sums) const;
  double elastic_energy_j(const Eigen::Matrix3Xd& positions_m) const;  // with that of fibres
  // By the volume's damping, at Jbar - 1.
  Eigen::Matrix3Xd volume_damping_n(const StrainTarget& damping, const Eigen::VectorXd& volumetric_strain,
                                    const Eigen::Matrix3Xd& positions_m) const;
};

}  // namespace soft_robot_lab
