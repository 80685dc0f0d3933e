// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "fidelity.h"
#include "mechanics/reduced/snapshots.h"

namespace soft_robot_lab {
namespace {

constexpr double kUsualShare = 0.2;     // of pull, or of more gas, in a robot that no run commands
constexpr int kSearchedStates = 3;      // within the ranges, beside those of a run
constexpr double kSearchedShare = 0.5;  // of the way from rest to the end of each range
constexpr std::size_t kProbes = 40;
constexpr double kSamePlace = 1e-3;  // of the body's size

// Those of a run, in its order, which is the way that it takes.
std::vector<std::vector<double>> commands_of(const RunSettings& run, std::vector<double> now,
                                             const Simulation& simulation) {
  std::vector<std::vector<double>> states;
  for (const TimedCommands& timed : run.commands) {
    for (const auto& [name, value] : timed.commands) now[static_cast<size_t>(simulation.actuator_index(name))] = value;
    states.push_back(now);
  }
  return states;
}

std::vector<std::vector<double>> usual_commands(const Simulation& simulation, const std::vector<double>& rest) {
  std::vector<std::vector<double>> states;
  for (size_t i = 0; i < rest.size(); ++i) {
    const CommandLimits& limits = simulation.actuators()[i]->limits();
    if (limits.unit != "1") continue;  // of forces, lengths and pressures nobody knows what is usual
    const bool cable = simulation.actuator_state(static_cast<int>(i)).rest_length_m.has_value();
    states.push_back(rest);
    states.back()[i] =
        std::clamp((cable ? 1.0 - kUsualShare : 1.0 + kUsualShare) * limits.rest, limits.min, limits.max);
  }
  return states;
}

// Spread over what a search or a hand may command: half of the way to each end, and no further than is usual.
std::vector<std::vector<double>> searched_commands(const Simulation& simulation, const std::vector<double>& rest) {
  CommandBox box;
  for (size_t i = 0; i < rest.size(); ++i) {
    const CommandLimits& limits = simulation.actuators()[i]->limits();
    const double most = rest[i] != 0.0 ? kUsualShare * std::abs(rest[i]) : std::numeric_limits<double>::infinity();
    const auto end = [&](double limit) {
      const double way = kSearchedShare * (limit - rest[i]);
      const double bounded = std::clamp(way, -most, most);
      return std::isfinite(bounded) ? rest[i] + bounded : rest[i];
    };
    box.min.push_back(end(limits.min));
    box.max.push_back(end(limits.max));
  }
  std::vector<std::vector<double>> states;
  for (std::size_t i = 0; !rest.empty() && i < kSearchedStates; ++i) states.push_back(commands_in(box, i));
  return states;
}

bool overlaps(const std::vector<SolveWarning>& warnings) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [](const SolveWarning& warning) { return warning.kind == "skin_in_silicone"; });
}

void add_state(const Simulation& simulation, int number, const std::vector<Marker>& probes, JudgedRests& all) {
  const SimulationState& state = simulation.state();
  all.numbers.push_back(number);
  all.states.push_back(state);
  all.markers_m.push_back(positions_of(simulation.markers(), state.positions_m));
  all.probes_m.push_back(positions_of(probes, state.positions_m));
}

// By how much a node moved where the way to the present state, which is the latest of `all`, became unstable. 0 where
// the way from the rest shape leads there too and stays stable: what lies between two states says nothing of either.
double snap_on_the_way(const SolveReport& report, const JudgedRests& all, Simulation& simulation,
                       Judgement& judgement) {
  const double moved_m = snapped_m(report.warnings);
  if (moved_m == 0.0 || all.states.size() < 2) return moved_m;
  const SimulationState here = simulation.state();
  simulation.reset();
  command(here.commands(), simulation);
  const SolveReport direct = simulation.solve_equilibrium();
  judgement.count(all.solve, direct);
  const double apart_m = (simulation.state().positions_m - here.positions_m).colwise().norm().maxCoeff();
  const bool same = direct.converged && apart_m < kSamePlace * simulation.body().size_m();
  simulation.set_state(here);
  return same ? snapped_m(direct.warnings) : moved_m;
}

}  // namespace

std::string unseen_obstacle(const std::vector<SolveWarning>& warnings) {
  for (const SolveWarning& warning : warnings)
    if (warning.kind == "coarse_contact" && warning.unit == "m") return warning.text;
  return "";
}

std::vector<std::vector<double>> judged_commands(const Simulation& simulation, const RunSettings& run,
                                                 FidelityUse use) {
  std::vector<double> rest;
  for (const auto& actuator : simulation.actuators()) rest.push_back(actuator->limits().rest);
  std::vector<std::vector<double>> states =
      run.stated ? commands_of(run, rest, simulation) : usual_commands(simulation, rest);
  if (use == FidelityUse::search || use == FidelityUse::live)
    for (std::vector<double>& commands : searched_commands(simulation, rest)) states.push_back(std::move(commands));
  if (states.empty()) states.push_back(rest);
  return states;
}

std::vector<Eigen::Vector3d> probes_of(const TetMesh& mesh) {
  std::vector<int> nodes(mesh.faces.data(), mesh.faces.data() + mesh.faces.size());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::vector<Eigen::Vector3d> probes;
  const std::size_t count = std::min(kProbes, nodes.size());
  for (std::size_t i = 0; i < count; ++i) probes.emplace_back(mesh.nodes_m.col(nodes[i * nodes.size() / count]));
  return probes;
}

std::vector<Marker> markers_at(const std::vector<Eigen::Vector3d>& places_m, const TetMesh& mesh) {
  const MeshLocator locator(mesh);
  std::vector<Marker> markers;
  for (std::size_t i = 0; i < places_m.size(); ++i)
    markers.emplace_back("probe_" + std::to_string(i), places_m[i], mesh, locator);
  return markers;
}

Eigen::Matrix3Xd positions_of(const std::vector<Marker>& markers, const Eigen::Matrix3Xd& nodes_m) {
  Eigen::Matrix3Xd at(3, static_cast<Eigen::Index>(markers.size()));
  for (std::size_t i = 0; i < markers.size(); ++i) at.col(static_cast<Eigen::Index>(i)) = markers[i].position(nodes_m);
  return at;
}

JudgedRests judged_rests(Scene& scene, const std::vector<Eigen::Vector3d>& probes, Judgement& judgement) {
  JudgedRests all;
  Simulation& simulation = *scene.simulation;
  const std::vector<Marker> probe_markers = markers_at(probes, simulation.body().mesh());
  const bool all_needed = judgement.use == FidelityUse::rest || judgement.use == FidelityUse::motion;
  const SolveCost cost = all.solve = solve_cost(*simulation.model());
  double spent_s = 0.0;
  int number = 0;
  for (const std::vector<double>& commands : judged_commands(simulation, scene.run, judgement.use)) {
    command(commands, simulation);
    const SolveReport report = simulation.solve_equilibrium();
    spent_s += judgement.count(cost, report);
    ++number;
    if (report.converged) {
      add_state(simulation, number, probe_markers, all);
      all.skin_overlaps.push_back(overlaps(report.warnings));
      all.snapped_m.push_back(snap_on_the_way(report, all, simulation, judgement));
      if (all.unseen.empty()) all.unseen = unseen_obstacle(report.warnings);
      continue;
    }
    all.trouble = "rest state " + std::to_string(number) + " was not found: " + report.message;
    if (all_needed || report.interrupted) return all;
  }
  if (!all.states.empty()) all.trouble.clear();
  all.cost_s = spent_s / number;
  return all;
}

}  // namespace soft_robot_lab
