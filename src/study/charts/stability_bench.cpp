// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stability.h"
#include "control/identification/simulated_now.h"
#include "settings/cpu_time.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

constexpr int kFewestSteps = 10;                      // in time, however long a time step is
constexpr double kRightPlace = 0.01;                  // of the body's size: how far a marker may be off
constexpr int kCarefulStages = 20;                    // of the reference's command change
constexpr double kClosure = 0.01;                     // of the energy turned over: what a ledger may leave open
constexpr const char* kLocking = "locking_elements";  // the warning that foretells a wrong place (locking.h)

bool all_finite(const Simulation& simulation, const SolveReport& report) {
  const SimulationState& state = simulation.state();
  bool finite = std::isfinite(report.residual) && std::isfinite(state.time_s) && state.positions_m.allFinite() &&
                state.velocities_m_s.allFinite() && state.element_multipliers_pa.allFinite() &&
                state.constraint_multipliers.allFinite() && state.element_forces_n.allFinite() &&
                places(simulation).allFinite();
  for (int i = 0; i < static_cast<int>(simulation.actuators().size()); ++i) {
    const ActuatorReading reading = simulation.actuator_state(i);
    for (const auto& number : {reading.length_m, reading.rest_length_m, reading.tension_n, reading.volume_m3,
                               reading.initial_volume_m3, reading.gauge_pressure_pa})
      finite = finite && std::isfinite(number.value_or(0.0));
  }
  return finite;
}

void give_commands(Simulation& simulation, const std::vector<double>& commands, double fraction) {
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const Actuator& actuator = *simulation.actuators().at(i);
    const double rest = actuator.limits().rest;
    simulation.set_command(actuator.name(), rest + fraction * (commands[i] - rest));
  }
}

// Each of the scene's cables or chambers with the changes.
Overrides changed_drives(const std::string& file, const std::string& kind, Overrides changes) {
  Overrides overrides;
  for (const YamlNode& drive : YamlNode::load_file(file).sequence(kind))
    overrides.set({kind, drive.text("name")}, changes);
  return overrides;
}

// Where the body comes to rest by the default solver. Empty, or why it does not.
std::string settle(Simulation& simulation) {
  const SolveReport report = simulation.solve_equilibrium();
  if (!report.converged || report.inverted_elements > 0) return report.message;
  try {
    simulation.marker_sensitivities();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

// A method for comparison that has not solved a single step by then is not going to.
double timeout_s(const StabilityMethod& method, const StabilityCell& cell) {
  constexpr double kShare = 0.3;
  return !method.ours && cell.failed_solves == cell.solves ? kShare * method.cpu_limit_s : method.cpu_limit_s;
}

void read_ledger(const Simulation& simulation, StabilityCell& cell) {
  const EnergyLedger* ledger = simulation.energy_ledger();
  if (!ledger || ledger->turned_over_j <= 0.0) return;
  cell.closure = ledger->closure_error_j / ledger->turned_over_j;
  cell.integrator = ledger->integrator_j / ledger->turned_over_j;
}

// Empty, or what is wrong with its energy.
std::string ledger_fault(const StabilityCell& cell) {
  if (!cell.closure || std::abs(*cell.closure) <= kClosure) return "";
  return "the ledger is " + std::to_string(100.0 * *cell.closure) + " % of the energy turned over off";
}

// Empty, or how a marker swings further about where it rests in the last quarter of the time than in the one before.
std::string swing_fault(const std::vector<Eigen::Matrix3Xd>& track, const Eigen::Matrix3Xd& rest_m, double little_m) {
  const auto largest_m = [&](std::size_t from, std::size_t to) {
    double largest = 0.0;
    for (std::size_t i = from; i < to; ++i)
      largest = std::max(largest, (track[i] - rest_m).colwise().norm().maxCoeff());
    return largest;
  };
  const std::size_t half = track.size() / 2, last = half + track.size() / 4;
  const double before_m = largest_m(half, last), after_m = largest_m(last, track.size());
  if (after_m <= before_m + little_m) return "";
  return "the swing grows: from " + std::to_string(1e3 * before_m) + " to " + std::to_string(1e3 * after_m) + " mm";
}

}  // namespace

const char* name_of(Outcome outcome) {
  constexpr const char* kNames[kOutcomes] = {"survived", "recovered",       "failed and said so",
                                             "too slow", "failed silently", "not finite"};
  return kNames[static_cast<int>(outcome)];
}

bool fits(const StabilityBody& body, const StabilityMethod& method, const HardCase& hard_case) {
  if (hard_case.commands(body).empty()) return false;
  if (hard_case.touches && !method.ours && !method.meets_obstacles) return false;
  return (method.cable_changes.empty() && method.chamber_changes.empty()) || !method.drive_changes(body).empty();
}

StabilityBench::StabilityBench(SceneOptions options, std::string config_folder)
    : options_(std::move(options)), config_folder_(std::move(config_folder)) {}

Scene StabilityBench::load(const StabilityBody& body, const StabilityMethod& method, const HardCase& hard_case) const {
  const std::string file = config_folder_ + "/" + body.scene;
  SceneOptions options = options_;
  options.overrides = changed_drives(file, body.chamber ? "chambers" : "cables",
                                     Overrides(method.drive_changes(body)).lay(hard_case.drive_changes));
  const Overrides touching = hard_case.touches ? hard_case.touches(body) : Overrides();
  for (const Overrides& more :
       {body.overrides, hard_case.overrides, touching, method.body_overrides, method.solver_overrides})
    options.overrides.lay(more);
  options.change_mesh = hard_case.change_mesh;
  return load_scene(file, options);
}

// The default solver from the rest shape, by small changes of the commands.
const StabilityBench::Reference& StabilityBench::reference(const StabilityBody& body, const HardCase& hard_case) {
  const std::string key = body.name + ": " + hard_case.name;
  for (const Reference& known : references_)
    if (known.key == key) return known;
  const Scene scene = load(body, {}, hard_case);
  Simulation& simulation = *scene.simulation;
  settle(simulation);
  Reference found{key, false, {}};
  for (int stage = 1; stage <= kCarefulStages; ++stage) {
    give_commands(simulation, hard_case.commands(body), static_cast<double>(stage) / kCarefulStages);
    found.found = settle(simulation).empty();
  }
  found.markers_m = places(simulation);
  references_.push_back(std::move(found));
  return references_.back();
}

std::string StabilityBench::judge_place(const StabilityBody& body, const HardCase& hard_case, const Simulation& resting,
                                        StabilityCell& cell) {
  const Reference& place = reference(body, hard_case);
  if (place.found) cell.off_m = (places(resting) - place.markers_m).colwise().norm().maxCoeff();
  const bool wrong = !place.found || cell.off_m > kRightPlace * resting.body().size_m();
  if (!wrong) return "";
  if (hard_case.unique)
    return place.found ? "the markers are in the wrong place" : "the careful path found no rest state";
  cell.message = "another stable rest state";
  return "";
}

// A body that still swings, as it does with short time steps, is in the right place where it swings about that: so the
// default solver lets it come to rest from where it is.
void StabilityBench::judge(const StabilityBody& body, const StabilityMethod& method, const HardCase& hard_case,
                           const Simulation& end, const Track& track, StabilityCell& cell) {
  StabilityMethod still;
  still.body_overrides = method.body_overrides;
  const Scene scene = load(body, still, hard_case);
  SimulationState state = scene.simulation->state();
  state.positions_m = end.state().positions_m;
  state.element_multipliers_pa = end.state().element_multipliers_pa;
  state.constraint_multipliers = end.state().constraint_multipliers;
  state.take_commands(end.state());
  scene.simulation->set_state(state);
  cell.outcome = Outcome::silent;
  cell.message = settle(*scene.simulation);
  if (!cell.message.empty()) {
    cell.message = "no stable rest state where it ends: " + cell.message;
    return;
  }
  std::string wrong = judge_place(body, hard_case, *scene.simulation, cell);
  if (wrong.empty() && end.energy_ledger()) wrong = ledger_fault(cell);
  if (wrong.empty() && end.energy_ledger())
    wrong = swing_fault(track, places(*scene.simulation), kRightPlace * end.body().size_m());
  if (!wrong.empty()) {
    cell.message = wrong;
    return;
  }
  cell.outcome = cell.failed_solves == 0 && !hard_case.start_from ? Outcome::survived : Outcome::recovered;
}

// Steps, or solves; false where it gave up, or a number is not finite.
bool StabilityBench::go_through(const StabilityMethod& method, Simulation& simulation, Track& track,
                                StabilityCell& cell, SolveReport& last) {
  const double start_s = cpu_time_s();
  const int in_time =
      std::max(kFewestSteps, static_cast<int>(std::ceil(method.duration_s / simulation.options().time_step_s - 1e-6)));
  const int solves = method.equilibrium ? 1 : in_time;
  while (cell.solves < solves) {
    last = method.equilibrium ? simulation.solve_equilibrium() : simulation.step();
    track.push_back(places(simulation));
    ++cell.solves;
    if (!last.converged) ++cell.failed_solves;
    if (!last.converged || last.inverted_elements > 0) cell.message = last.message;
    cell.cpu_s = cpu_time_s() - start_s;
    if (!all_finite(simulation, last)) {
      cell.outcome = Outcome::not_finite;
      return false;
    }
    if (cell.cpu_s > timeout_s(method, cell) && cell.solves < solves) {
      cell.outcome = last.converged ? Outcome::too_slow : Outcome::reported;
      cell.message += (cell.message.empty() ? "" : "; ") + std::string("given up after ") +
                      std::to_string(static_cast<int>(cell.cpu_s)) + " s of CPU time, " + std::to_string(cell.solves) +
                      " of " + std::to_string(solves) + " steps";
      return false;
    }
  }
  return true;
}

StabilityCell StabilityBench::run(const StabilityBody& body, const StabilityMethod& method, const HardCase& hard_case) {
  StabilityCell cell;
  cell.body = body.name;
  cell.method = method.name;
  cell.hard_case = hard_case.name;
  cell.ours = method.ours;
  const Scene scene = load(body, method, hard_case);
  Simulation& simulation = *scene.simulation;
  if (hard_case.start_from) {
    SimulationState state = simulation.state();
    hard_case.start_from(simulation.body(), state.positions_m);
    simulation.set_state(state);
  }
  if (!method.equilibrium && simulation.options().method == SolverOptions::Method::newton)
    simulation.keep_energy_ledger();
  give_commands(simulation, hard_case.commands(body), 1.0);
  SolveReport last;
  Track track;
  const bool done = go_through(method, simulation, track, cell, last);
  read_ledger(simulation, cell);
  if (!done || !last.converged) return cell;
  if (last.inverted_elements > 0) {
    cell.outcome = Outcome::silent;
    return cell;
  }
  judge(body, method, hard_case, simulation, track, cell);
  const bool locks = std::any_of(scene.warnings.begin(), scene.warnings.end(),
                                 [](const SolveWarning& warning) { return warning.kind == kLocking; });
  if (cell.outcome == Outcome::silent && locks) {
    cell.outcome = Outcome::reported;
    cell.message += std::string("; the scene was warned of: ") + kLocking;
  }
  return cell;
}

}  // namespace soft_robot_lab
