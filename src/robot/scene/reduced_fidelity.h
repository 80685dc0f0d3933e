// SPDX-License-Identifier: BSD-3-Clause
// A reduced model as a choice of fidelity.
#pragma once

#include <optional>
#include <string>

#include "fidelity.h"

namespace soft_robot_lab {

// Counted as solve_cost.h does: of training, and of moving by so many modes for a simulated second.
double training_cost_s(double rest_state_s, double per_second_s);
double reduced_cost_per_second_s(int modes);

struct ReducedTrial {
  std::optional<ReducedFidelity> reduced;
  std::string ranges;   // of commands that it knows, for a reader
  std::string why_not;  // where there is none
};

// Trains it on this mesh to a tolerance, rms of the nodes, or finds it in the cache. `stated`: the scene as load_scene
// goes on with it, so that it finds the same.
ReducedTrial try_reduced(const YamlNode& stated, FidelityChoice choice, const TetMesh& mesh, double tolerance_m,
                         const Judgement& judgement);

}  // namespace soft_robot_lab
