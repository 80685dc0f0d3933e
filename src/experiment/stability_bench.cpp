#include <algorithm>
#include <cmath>
#include <ctime>
#include <sstream>

#include "soft_robot_lab/experiment/stability.h"
#include "soft_robot_lab/settings/settings_node.h"

namespace soft_robot_lab {
namespace {

constexpr double kDuration_s = 2.0;    // in which a body must have recovered in time
constexpr int kFewestSteps = 10;       // however long a time step is
constexpr double kRightPlace = 0.01;   // of the body's size: how far a marker may be off
constexpr double kCpuLimit_s = 300.0;  // of a cell
constexpr int kCarefulStages = 20;     // of the reference's command change

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Eigen::Matrix3Xd markers_of(const Simulation& simulation) {
  const int count = static_cast<int>(simulation.markers().size());
  Eigen::Matrix3Xd positions(3, count);
  for (int i = 0; i < count; ++i) positions.col(i) = simulation.marker_position(i);
  return positions;
}

bool all_finite(const Simulation& simulation, const SolveReport& report) {
  const SimulationState& state = simulation.state();
  bool finite = std::isfinite(report.residual) && std::isfinite(state.time_s) && state.positions_m.allFinite() &&
                state.velocities_m_s.allFinite() && state.element_multipliers_pa.allFinite() &&
                state.constraint_multipliers.allFinite() && state.element_forces_n.allFinite() &&
                markers_of(simulation).allFinite();
  for (int i = 0; i < static_cast<int>(simulation.actuators().size()); ++i) {
    const ActuatorReading reading = simulation.actuator_state(i);
    for (const auto& number : {reading.length_m, reading.rest_length_m, reading.tension_n, reading.volume_m3,
                               reading.initial_volume_m3, reading.gauge_pressure_pa})
      finite = finite && std::isfinite(number.value_or(0.0));
  }
  return finite;
}

void give_commands(Simulation& simulation, const HardCase& hard_case, double share) {
  for (std::size_t i = 0; i < hard_case.pulls.size(); ++i) {
    const Actuator& actuator = *simulation.actuators().at(i);
    const double rest = actuator.limits().rest;
    simulation.set_command(actuator.name(), rest + share * (hard_case.pulls[i] - rest));
  }
}

// The scene's cables, each with the changes: a list in a scene replaces another, it does not merge.
std::string changed_cables(const std::string& file, const std::string& changes) {
  if (changes.empty()) return "";
  std::string text = "cables:\n";
  for (const SettingsNode& cable : SettingsNode::load_file(file).sequence("cables"))
    text += "  - " + merge_settings(cable, SettingsNode::parse(changes, "changes")).dump() + "\n";
  return text;
}

std::string merged(const std::vector<std::string>& all) {
  SettingsNode sum = SettingsNode::parse("{}", "changes");
  for (const std::string& changes : all)
    if (!changes.empty()) sum = merge_settings(sum, SettingsNode::parse(changes, "changes"));
  return sum.dump();
}

}  // namespace

const char* name_of(Outcome outcome) {
  constexpr const char* kNames[kOutcomes] = {"survived", "recovered", "failed and said so", "failed silently",
                                             "not finite"};
  return kNames[static_cast<int>(outcome)];
}

StabilityBench::StabilityBench(SceneOptions options, std::string config_folder)
    : options_(std::move(options)), config_folder_(std::move(config_folder)) {}

Scene StabilityBench::load(const StabilityBody& body, const StabilityMethod& method, const HardCase& hard_case) const {
  const std::string file = config_folder_ + "/" + body.scene;
  SceneOptions options = options_;
  options.changes = merged({changed_cables(file, hard_case.cable_changes), hard_case.changes, method.changes});
  options.change_mesh = hard_case.change_mesh;
  return load_scene(file, options);
}

// The default solver from the rest shape, by small changes of the commands.
const StabilityBench::Reference& StabilityBench::reference(const StabilityBody& body, const HardCase& hard_case) {
  const std::string key = body.name + ": " + hard_case.name;
  for (const Reference& known : references_)
    if (known.key == key) return known;
  Scene scene = load(body, {}, hard_case);
  Simulation& simulation = *scene.simulation;
  Reference found{key, simulation.solve_equilibrium().converged, {}};
  for (int stage = 1; stage <= kCarefulStages && found.found; ++stage) {
    give_commands(simulation, hard_case, static_cast<double>(stage) / kCarefulStages);
    const SolveReport report = simulation.solve_equilibrium();
    found.found = report.converged && report.inverted_elements == 0;
  }
  found.markers_m = markers_of(simulation);
  references_.push_back(std::move(found));
  return references_.back();
}

namespace {

// Where the body comes to rest from where it is now, by the default solver: a body that still swings about its place is
// in it.
bool find_rest(Simulation& simulation, std::string& why) {
  const SolveReport report = simulation.solve_equilibrium();
  why = report.message;
  if (!report.converged || report.inverted_elements > 0) return false;
  try {
    simulation.marker_sensitivities();
  } catch (const std::runtime_error& error) {
    why = error.what();
    return false;
  }
  return true;
}

}  // namespace

StabilityCell StabilityBench::run(const StabilityBody& body, const StabilityMethod& method, const HardCase& hard_case) {
  StabilityCell cell;
  cell.body = body.name;
  cell.method = method.name;
  cell.hard_case = hard_case.name;
  cell.ours = method.ours;
  Scene scene = load(body, method, hard_case);
  Simulation& simulation = *scene.simulation;
  if (hard_case.start_from) {
    SimulationState state = simulation.state();
    hard_case.start_from(simulation.body(), state.positions_m);
    simulation.set_state(state);
  }
  give_commands(simulation, hard_case, 1.0);

  const double start_s = cpu_seconds();
  const double step_s = simulation.options().time_step_s;
  const int steps = method.equilibrium ? 1 : std::max(kFewestSteps, static_cast<int>(std::ceil(kDuration_s / step_s - 1e-6)));
  SolveReport last;
  for (int i = 0; i < steps; ++i) {
    last = method.equilibrium ? simulation.solve_equilibrium() : simulation.step();
    ++cell.solves;
    if (!last.converged) ++cell.failed_solves;
    if (!last.converged) cell.message = last.message;
    if (!all_finite(simulation, last)) {
      cell.outcome = Outcome::not_finite;
      return cell;
    }
    if (cpu_seconds() - start_s > kCpuLimit_s) {
      last.converged = false;
      cell.message = "given up after " + std::to_string(static_cast<int>(kCpuLimit_s)) + " s of CPU time";
      break;
    }
  }
  cell.cpu_s = cpu_seconds() - start_s;
  if (!last.converged) return cell;
  cell.outcome = Outcome::silent;
  if (last.inverted_elements > 0) {
    cell.message = last.message;
    return cell;
  }
  // The rest state by the default solver on the same elements.
  StabilityMethod same = method;
  same.changes = merged({method.changes, "solver: {method: global, integrator: implicit_euler}"});
  HardCase settle = hard_case;
  if (method.changes.find("gauss_seidel") != std::string::npos) same.changes = method.changes.find("linear") != std::string::npos ? "body: {element: linear}" : "";
  Scene still = load(body, same, settle);
  SimulationState state = still.simulation->state();
  state.positions_m = simulation.state().positions_m;
  state.commands = simulation.state().commands;
  state.actuated_commands = simulation.state().actuated_commands;
  state.element_multipliers_pa = simulation.state().element_multipliers_pa;
  state.constraint_multipliers = simulation.state().constraint_multipliers;
  still.simulation->set_state(state);
  std::string why;
  if (!find_rest(*still.simulation, why)) {
    cell.message = "no stable rest state near the end: " + why;
    return cell;
  }
  const Reference& place = reference(body, hard_case);
  if (!place.found && hard_case.unique) {
    cell.message = "no reference";
    return cell;
  }
  if (hard_case.unique) cell.off_m = (markers_of(*still.simulation) - place.markers_m).colwise().norm().maxCoeff();
  if (cell.off_m > kRightPlace * simulation.body().size_m()) {
    std::ostringstream text;
    text << "a marker is " << 1e3 * cell.off_m << " mm off its place";
    cell.message = text.str();
    return cell;
  }
  cell.outcome = cell.failed_solves == 0 && !hard_case.start_from ? Outcome::survived : Outcome::recovered;
  return cell;
}

}  // namespace soft_robot_lab
