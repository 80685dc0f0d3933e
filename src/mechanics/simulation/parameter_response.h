// SPDX-License-Identifier: BSD-3-Clause
// How an equilibrium answers to numbers of the scene.
#pragma once

#include "simulation_parts.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// As Simulation::parameter_sensitivities, of all nodes: 3*node + axis.
Eigen::MatrixXd parameter_motions(SimulationParts& parts, const std::vector<ModelParameter>& parameters,
                                  Eigen::MatrixXd& slipped_m);

// d node / d force at a marker at the present equilibrium, as Simulation::marker_compliances.
Eigen::MatrixXd marker_load_motions(SimulationParts& parts);

}  // namespace soft_robot_lab
