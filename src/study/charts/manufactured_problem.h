// SPDX-License-Identifier: BSD-3-Clause
// A body whose exact deformation is known: it was chosen, smooth and far from every singularity, and the loads were
// computed from it (the method of manufactured solutions; Roache 2002).
#pragma once

namespace soft_robot_lab {

struct ManufacturedRun {
  double size_m = 0.0;  // edge of the cubes whose six parts are the elements
  double error = 0.0;   // of the displacements: their root mean square over that of the exact ones
  bool converged = true;
};

// A cube of 0.1 m with all its surface held, cut into six tetrahedra and these `subdivisions` times into eight parts
// each.
ManufacturedRun solve_manufactured(double poissons_ratio, bool quadratic, int subdivisions);

}  // namespace soft_robot_lab
