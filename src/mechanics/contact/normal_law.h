// SPDX-License-Identifier: BSD-3-Clause
// Pressure l of a contact point against its gap g, nearly rigid:
//   l >= 0,  g + a l >= 0,  l (g + a l) = 0      a: compliance [m/Pa]
// The pressure is an unknown of its own, and an active set decides which points carry any (Hueber & Wohlmuth 2005).
#pragma once

#include <algorithm>

namespace soft_robot_lab {

struct NormalLaw {
  double compliance_m_pa = 0.0;  // a
  double soft_m_pa = 0.0;        // m > a, of the test for activity and of the merit function only

  // Skin of this element size: it sinks in by a thousandth of what the element itself gives way.
  static NormalLaw of_skin(double face_size_m, double youngs_modulus_pa) {
    return {0.002 * face_size_m / youngs_modulus_pa, 0.05 * face_size_m / youngs_modulus_pa};
  }

  // Of rigid things, with forces for pressures: the lighter sinks in by 10 nm under its own weight. The merit is so
  // soft that a step which turns a thing may leave the way that a straight one takes.
  static NormalLaw of_rigid(double lighter_kg) { return {1e-9 / lighter_kg, 2.5e-7 / lighter_kg}; }

  // Whether a Newton step takes the point for closed. So is one that just touches.
  bool closed(double gap_m, double pressure_pa) const {
    return pressure_pa * (soft_m_pa - compliance_m_pa) - gap_m > -1e-12;
  }

  // Pressure after a step by which the gap becomes this.
  double pressure_pa(double gap_m) const { return std::max(0.0, -gap_m / compliance_m_pa); }

  // How far the point is from its law; zero where it is open.
  double mismatch_m(double gap_m, double pressure_pa) const {
    return pressure_pa > 0.0 || gap_m < 0.0 ? gap_m + compliance_m_pa * pressure_pa : 0.0;
  }

  // Augmented Lagrangian per area, at the pressure where a step leads; and what it pushes with: -d merit / d gap.
  double merit_pa(double gap_m, double pressure_pa) const {
    return std::max(0.0, pressure_pa - (gap_m + compliance_m_pa * pressure_pa) / soft_m_pa);
  }
  double merit_j_m2(double gap_m, double pressure_pa) const {
    const double push_pa = merit_pa(gap_m, pressure_pa);
    return 0.5 * soft_m_pa * (push_pa * push_pa - pressure_pa * pressure_pa);
  }
};

}  // namespace soft_robot_lab
