// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numeric>

#include "fidelity.h"
#include "mechanics/mesh/subdivide.h"
#include "mechanics/reduced/snapshots.h"

namespace soft_robot_lab {
namespace {

constexpr double kFirstOrder = 2.0;  // error over difference, where half the size halves the error
constexpr int kMostJudged = 4;       // of a scene's rest states, those that moved furthest
constexpr double kUsualShare = 0.2;  // of pull, or of more gas, in a robot that no run commands
// Newton iterations a stage on the finer mesh, which begins near its rest state: where it needs more, the coarse mesh
// says little about it, and a finer one costs less than insisting.
constexpr int kFineIterations = 8;

YamlNode with_little_effort(const YamlNode& settings) {
  return Overrides().set({"solver", "max_iterations"}, kFineIterations).over(settings);
}

std::vector<int> surface_nodes(const TetMesh& mesh) {
  std::vector<int> nodes(mesh.faces.data(), mesh.faces.data() + mesh.faces.size());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

double rms_distance(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b, const std::vector<int>& nodes) {
  double sum = 0.0;
  for (const int node : nodes) sum += (a.col(node) - b.col(node)).squaredNorm();
  return std::sqrt(sum / static_cast<double>(nodes.size()));
}

// Empty where one did not converge; `trouble` then says which.
std::vector<SimulationState> rest_states(Scene& scene, std::string& trouble) {
  std::vector<SimulationState> states;
  Simulation& simulation = *scene.simulation;
  for (const std::vector<double>& commands : judged_commands(simulation, scene.run)) {
    command(commands, simulation);
    const SolveReport report = simulation.solve_equilibrium();
    if (!report.converged) {
      trouble = "rest state " + std::to_string(states.size() + 1) + " was not found: " + report.message;
      return {};
    }
    states.push_back(simulation.state());
  }
  return states;
}

std::vector<SimulationState> furthest(std::vector<SimulationState> states, const TetMesh& mesh,
                                      const std::vector<int>& surface) {
  const auto moved = [&](const SimulationState& state) {
    return rms_distance(state.positions_m, mesh.nodes_m, surface);
  };
  std::stable_sort(states.begin(), states.end(), [&](const auto& a, const auto& b) { return moved(a) > moved(b); });
  if (states.size() > kMostJudged) states.resize(kMostJudged);
  return states;
}

// The coarse rest state as a start for the fine mesh, so that a buckled body stays on its side.
SimulationState carried(const SimulationState& coarse, const Subdivision& fine, SimulationState start) {
  start.positions_m = fine.carry(coarse.positions_m);
  start.take_commands(coarse);
  start.constraint_multipliers = coarse.constraint_multipliers;
  const Eigen::VectorXd& multipliers = coarse.element_multipliers_pa;
  if (start.element_multipliers_pa.size() == 8 * multipliers.size())
    for (Eigen::Index i = 0; i < start.element_multipliers_pa.size(); ++i)
      start.element_multipliers_pa[i] = multipliers[i / 8];
  return start;
}

double largest_marker_distance(const Simulation& a, const Eigen::Matrix3Xd& positions_a, const Simulation& b,
                               const Eigen::Matrix3Xd& positions_b) {
  double largest = 0.0;
  for (size_t i = 0; i < a.markers().size(); ++i)
    largest = std::max(largest, (a.markers()[i].position(positions_a) - b.markers()[i].position(positions_b)).norm());
  return largest;
}

}  // namespace

std::vector<std::vector<double>> judged_commands(const Simulation& simulation, const RunSettings& run) {
  std::vector<double> rest;
  for (const auto& actuator : simulation.actuators()) rest.push_back(actuator->limits().rest);
  std::vector<std::vector<double>> states;
  if (run.stated) {
    std::vector<double> now = rest;
    for (const TimedCommands& timed : run.commands) {
      for (const auto& [name, value] : timed.commands)
        now[static_cast<size_t>(simulation.actuator_index(name))] = value;
      states.push_back(now);
    }
    if (states.empty()) states.push_back(rest);
    return states;
  }
  for (size_t i = 0; i < rest.size(); ++i) {
    const CommandLimits& limits = simulation.actuators()[i]->limits();
    if (limits.unit != "1") continue;  // of forces, lengths and pressures nobody knows what is usual
    const bool cable = simulation.actuator_state(static_cast<int>(i)).rest_length_m.has_value();
    states.push_back(rest);
    states.back()[i] =
        std::clamp((cable ? 1.0 - kUsualShare : 1.0 + kUsualShare) * limits.rest, limits.min, limits.max);
  }
  if (states.empty()) states.push_back(rest);
  return states;
}

MeshError estimate_mesh_error(const YamlNode& settings, const TetMesh& mesh, const SceneOptions& options) {
  MeshError error;
  Scene coarse = build_scene(settings, mesh, options);
  if (options.on_warnings) options.on_warnings(coarse.warnings);
  const TetMesh& whole = coarse.simulation->body().mesh();
  const std::vector<int> surface = surface_nodes(whole);
  const std::vector<SimulationState> states = furthest(rest_states(coarse, error.trouble), whole, surface);
  if (states.empty()) return error;

  const Subdivision subdivision = subdivide(whole);
  const Scene fine = build_scene(with_little_effort(settings), subdivision.mesh, options);
  Simulation& simulation = *fine.simulation;
  const SimulationState start = simulation.state();
  double difference = 0.0;
  for (const SimulationState& state : states) {
    simulation.set_state(carried(state, subdivision, start));
    const SolveReport report = simulation.solve_equilibrium();
    if (!report.converged) {
      error.trouble = "no rest state on the finer mesh: " + report.message;
      return error;
    }
    const Eigen::Matrix3Xd& there = simulation.state().positions_m;
    difference = std::max({difference, rms_distance(state.positions_m, there, surface),
                           largest_marker_distance(*coarse.simulation, state.positions_m, simulation, there)});
  }
  error.expected_m = kFirstOrder * difference;
  return error;
}

}  // namespace soft_robot_lab
