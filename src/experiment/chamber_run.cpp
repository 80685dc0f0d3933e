#include "experiment/chamber_run.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <utility>

#include "soft_robot_lab/settings/settings_node.h"

namespace soft_robot_lab {
namespace {

ChamberState observe(const Simulation& simulation, int actuator, double beta, const SolveReport& solve) {
  ChamberState state;
  state.beta = beta;
  state.solve = solve;
  state.chamber = simulation.actuator_state(actuator);
  for (size_t i = 0; i < simulation.actuators().size(); ++i) {
    const double residual = simulation.actuator_state(static_cast<int>(i)).gas_residual.value_or(0.0);
    state.gas_residual = std::max(state.gas_residual, std::abs(residual));
  }
  state.markers_m.resize(3, static_cast<Eigen::Index>(simulation.markers().size()));
  for (Eigen::Index i = 0; i < state.markers_m.cols(); ++i)
    state.markers_m.col(i) = simulation.marker_position(static_cast<int>(i));
  state.positions_m = simulation.state().positions_m;
  return state;
}

// Why a state does not count; empty where it does.
std::string trouble(const SolveReport& solve) {
  if (!solve.converged) return solve.message.empty() ? "did not converge" : solve.message;
  if (solve.inverted_elements > 0) return std::to_string(solve.inverted_elements) + " elements are inverted";
  return "";
}

}  // namespace

Eigen::Vector3d ChamberRun::moved_m(const ChamberState& state, const std::string& marker) const {
  const int index = simulation().marker_index(marker);
  return state.markers_m.col(index) - states.front().markers_m.col(index);
}

ChamberSettings read_chamber_settings(const ExperimentContext& context, const std::string& name) {
  const SettingsNode node = SettingsNode::load_file(context.settings_file(name));
  ChamberSettings settings;
  settings.chamber = node.text_or("chamber", "");
  if (const auto scene = node.optional_child("scene")) settings.changes = scene->dump();
  const SettingsNode meshes = node.child("meshes");
  for (const std::string& mesh : meshes.keys())
    settings.meshes.emplace_back(mesh, context.config_folder + "/" + meshes.text(mesh));
  for (const SettingsNode& beta : node.sequence("betas")) settings.betas.push_back(beta.as_number());
  if (settings.meshes.empty()) node.fail("meshes is empty");
  if (settings.betas.empty()) node.fail("betas is empty");
  node.require_all_read();
  return settings;
}

std::vector<ChamberRun> run_chambers(const ExperimentContext& context, const ChamberSettings& settings,
                                     ExperimentResult& result) {
  std::vector<ChamberRun> runs;
  const double count = static_cast<double>(settings.meshes.size() * settings.betas.size());
  double done = 0.0;
  for (const auto& [mesh, file] : settings.meshes) {
    context.tell(done / count, mesh + " mesh");
    ChamberRun run{mesh, load_scene(file, context.scene_options(settings.changes)), {}};
    Simulation& simulation = *run.scene.simulation;
    const int actuator = settings.chamber.empty() ? 0 : simulation.actuator_index(settings.chamber);
    for (const double beta : settings.betas) {
      std::ostringstream what;
      what << mesh << " at beta " << beta;
      context.tell(done++ / count, what.str());
      simulation.set_command(simulation.actuators().at(static_cast<size_t>(actuator))->name(), beta);
      const SolveReport solve = simulation.solve_equilibrium();
      run.states.push_back(observe(simulation, actuator, beta, solve));
      const std::string why = trouble(solve);
      if (why.empty()) continue;
      result.converged = false;
      result.message = what.str() + ": " + why;
      break;
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

double worst_gas_residual(const std::vector<ChamberRun>& runs) {
  double worst = 0.0;
  for (const ChamberRun& run : runs)
    for (const ChamberState& state : run.states) worst = std::max(worst, state.gas_residual);
  return worst;
}

Series skin(const ChamberRun& run, const ChamberState& state, int x_axis, int y_axis, const std::string& label) {
  const TetMesh& mesh = run.simulation().body().mesh();
  std::set<int> nodes;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    if (mesh.face_surface[static_cast<size_t>(face)] >= 0) continue;  // a chamber's
    nodes.insert(mesh.faces.col(face).begin(), mesh.faces.col(face).end());
  }
  Series series{label, {}, {}, SeriesStyle::points};
  for (const int node : nodes) {
    series.x.push_back(1e3 * state.positions_m(x_axis, node));
    series.y.push_back(1e3 * state.positions_m(y_axis, node));
  }
  return series;
}

}  // namespace soft_robot_lab
