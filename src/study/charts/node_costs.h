// SPDX-License-Identifier: BSD-3-Clause
// What finer meshes cost: CPU time over nodes, and the powers by which it grows.
#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "speed_measurement.h"

namespace soft_robot_lab {

// CPU time as a power of the nodes, by least squares over the meshes with `from_nodes` and more; none with fewer than
// three of them.
std::optional<double> exponent(const std::vector<SpeedRun>& runs, int from_nodes);

// Of a series until a run takes longer than the settings allow.
std::vector<SpeedRun> run_node_costs(const ExperimentContext& context, const NodeCosts& costs,
                                     const MeasuringTools& tools);

// In motion and at rest, with the exponents in the legend.
std::vector<Plot> plot_node_costs(const NodeCosts& costs, const std::vector<SpeedRun>& runs);
nlohmann::ordered_json node_costs_json(const NodeCosts& costs, const std::vector<SpeedRun>& runs);

}  // namespace soft_robot_lab
