// SPDX-License-Identifier: BSD-3-Clause
#include <sstream>
#include <utility>

#include <nlohmann/json.hpp>

#include "fidelity_json.h"
#include "reaction.h"
#include "reduction.h"
#include "settings/words.h"
#include "soft_robot_lab/robot/scene/run_scene.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

Json list(const Eigen::VectorXd& v) { return std::vector<double>(v.data(), v.data() + v.size()); }

Json markers_json(const Simulation& simulation) {
  Json json = Json::object();
  for (size_t i = 0; i < simulation.markers().size(); ++i) {
    const Marker& marker = simulation.markers()[i];
    const Eigen::Vector3d position_m = simulation.marker_position(static_cast<int>(i));
    json[marker.name()] = {{"position_m", list(position_m)},
                           {"displacement_m", list(position_m - marker.rest_position_m())}};
  }
  return json;
}

Json cable_json(const ActuatorReading& state) {
  Json json = {{"length_m", *state.length_m}};
  if (state.rest_length_m) json["rest_length_m"] = *state.rest_length_m;
  if (state.tension_n) json["tension_n"] = *state.tension_n;
  if (!state.span_tensions_n.empty()) json["span_tensions_n"] = state.span_tensions_n;
  if (state.stretch_m) json["stretch_m"] = *state.stretch_m;
  if (state.slack_m) json["slack_m"] = *state.slack_m;
  if (state.pretension_n) json["pretension_n"] = *state.pretension_n;
  for (const PathChange& change : state.path_changes)
    json["points_moved"].push_back(
        {{"point", change.point < 0 ? Json() : Json(change.point)}, {"moved_m", change.moved_m}});
  return json;
}

Json chamber_json(const ActuatorReading& state) {
  Json json = {{"volume_m3", *state.volume_m3}};
  if (state.initial_volume_m3) json["initial_volume_m3"] = *state.initial_volume_m3;
  if (state.gauge_pressure_pa) json["gauge_pressure_pa"] = *state.gauge_pressure_pa;
  if (state.gas_residual) json["gas_residual"] = *state.gas_residual;
  return json;
}

// An actuator counts by what it measures, so that a lab's own plugins show up too.
void add_actuators(const Simulation& simulation, Json& result) {
  Json cables = Json::object(), chambers = Json::object();
  for (size_t i = 0; i < simulation.actuators().size(); ++i) {
    const ActuatorReading state = simulation.actuator_state(static_cast<int>(i));
    if (state.length_m) cables[state.name] = cable_json(state);
    if (state.volume_m3) chambers[state.name] = chamber_json(state);
  }
  result["cables"] = std::move(cables);
  result["chambers"] = std::move(chambers);
}

// One entry for each pair that touches.
void add_contacts(const Simulation& simulation, Json& result) {
  if (simulation.body().obstacles().empty() && !simulation.body().touches_itself()) return;
  Json all = Json::array();
  for (const ContactReading& reading : simulation.contacts()) {
    if (reading.normal_force_n == 0.0) continue;
    all.push_back({{"between", {reading.on, reading.surface}},
                   {"force_n", list(reading.force_n)},
                   {"normal_force_n", reading.normal_force_n},
                   {"area_m2", reading.area_m2},
                   {"largest_penetration_m", reading.largest_penetration_m},
                   {"sticking_area_m2", reading.sticking_area_m2},
                   {"slipping_area_m2", reading.slipping_area_m2}});
  }
  result["contacts"] = std::move(all);
}

// How free obstacles stand: where their centre is, and their turn as axis times angle.
Json pose_json(const Eigen::Vector3d& center_m, const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return {{"center_m", list(center_m)}, {"rotation_rad", list(turn.angle() * turn.axis())}};
}

void add_free_obstacles(const Simulation& simulation, Json& result) {
  const std::vector<Eigen::Isometry3d> poses = simulation.obstacle_poses();
  Json all = Json::object();
  Eigen::Index free = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Obstacle& obstacle = simulation.body().obstacles()[i];
    if (!obstacle.is_free()) continue;
    const SimulationState& state = simulation.state();
    Json& json = all[obstacle.name] = pose_json(state.contact.free.centers_m.col(free), poses[i].linear());
    json["velocity_m_s"] = list(state.free_velocities.linear_m_s.col(free));
    json["angular_velocity_rad_s"] = list(state.free_velocities.angular_rad_s.col(free++));
  }
  if (!all.empty()) result["obstacles"] = std::move(all);
}

Json warnings_json(const std::vector<SolveWarning>& warnings) {
  Json all = Json::array();
  for (const SolveWarning& warning : warnings) {
    Json json = {{"kind", warning.kind}, {"size", warning.size}, {"unit", warning.unit}};
    if (!warning.actuator.empty()) json["actuator"] = warning.actuator;
    if (warning.commanded) json["commanded"] = *warning.commanded;
    if (warning.reached) json["reached"] = *warning.reached;
    if (warning.rest_position_m) json["rest_position_m"] = list(*warning.rest_position_m);
    json["text"] = warning.text;
    all.push_back(std::move(json));
  }
  return all;
}

Json path_json(const std::vector<SolvePathStage>& path) {
  Json all = Json::array();
  for (const SolvePathStage& stage : path) all.push_back({{"stage", name_of(stage.stage)}, {"count", stage.count}});
  return all;
}

// Of all holds together, about the origin of robot_base.
Json reaction_json(const Simulation& simulation, const Eigen::Matrix3Xd& forces_n) {
  const Reaction total = total_reaction(simulation, forces_n);
  return {{"force_n", list(total.force_n)}, {"moment_nm", list(total.moment_nm)}};
}

// Of each held region, by its name or its place in the list.
Json reactions_json(const Simulation& simulation, const Eigen::Matrix3Xd& forces_n) {
  Json all = Json::object();
  const std::vector<Hold>& holds = simulation.body().holds();
  for (std::size_t i = 0; i < holds.size(); ++i) {
    Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
    for (const int node : holds[i].nodes) force_n += holds[i].axes.select(forces_n.col(node), 0.0);
    all[holds[i].name.empty() ? std::to_string(i) : holds[i].name] = {{"force_n", list(force_n)}};
  }
  return all;
}

// Of each load, in the order of the scene; weights hang with their pull.
Json loads_json(const Body& body) {
  Json all = Json::array();
  for (const AppliedLoad& load : body.loads())
    all.push_back({{"area_m2", load.area_m2},
                   {"force_n", list(Eigen::Vector3d(load.force_n + load.mass_kg * body.gravity_m_s2()))}});
  return all;
}

Json energy_json(const EnergyLedger& ledger) {
  return {{"kinetic_j", ledger.kinetic_j},
          {"elastic_j", ledger.elastic_j},
          {"gravity_j", ledger.gravity_j},
          {"loads_j", ledger.loads_j},
          {"actuators_j", ledger.actuators_j},
          {"gas_j", ledger.gas_j},
          {"holds_j", ledger.holds_j},
          {"obstacles_j", ledger.obstacles_j},
          {"rescues_j", ledger.rescues_j},
          {"material_j", ledger.material_j},
          {"friction_j", ledger.friction_j},
          {"integrator_j", ledger.integrator_j},
          {"closure_error_j", ledger.closure_error_j},
          {"turned_over_j", ledger.turned_over_j}};
}

Json solver_json(const Simulation& simulation, const SolveReport& solve) {
  const TetMesh& mesh = simulation.body().mesh();
  return {{"converged", solve.converged},  {"iterations", solve.iterations},
          {"residual", solve.residual},    {"steps", solve.steps},
          {"wall_s", solve.wall_s},        {"nodes", mesh.node_count()},
          {"elements", mesh.tet_count()},  {"inverted", solve.inverted_elements},
          {"path", path_json(solve.path)}, {"warnings", warnings_json(solve.warnings)}};
}

Json sensitivity_json(const Simulation& simulation, const Eigen::MatrixXd& sensitivity) {
  Json json = Json::object();
  for (size_t m = 0; m < simulation.markers().size(); ++m) {
    Json& row = json[simulation.markers()[m].name()] = Json::object();
    for (size_t a = 0; a < simulation.actuators().size(); ++a) {
      row[simulation.actuators()[a]->name()] =
          list(sensitivity.block<3, 1>(static_cast<Eigen::Index>(3 * m), static_cast<Eigen::Index>(a)));
    }
  }
  return json;
}

Json trajectory_json(const Simulation& simulation, const Trajectory& trajectory) {
  Json markers = Json::object();
  for (size_t m = 0; m < simulation.markers().size(); ++m) {
    Json& path = markers[simulation.markers()[m].name()] = Json::array();
    for (const Eigen::Matrix3Xd& at : trajectory.markers_m) path.push_back(list(at.col(static_cast<Eigen::Index>(m))));
  }
  Json json = {{"time_s", trajectory.time_s}, {"markers", markers}};
  Eigen::Index free = 0;
  for (const Obstacle& obstacle : simulation.body().obstacles()) {
    if (!obstacle.is_free()) continue;
    Json& path = json["obstacles"][obstacle.name] = Json::array();
    for (const FreePoses& at : trajectory.free)
      path.push_back(
          pose_json(at.centers_m.col(free), Eigen::Quaterniond(Eigen::Vector4d(at.turns.col(free))).matrix()));
    ++free;
  }
  return json;
}

std::string millimetres(const Eigen::Vector3d& v) {
  std::ostringstream text;
  text.precision(3);
  text << std::fixed << "[" << 1e3 * v.x() << ", " << 1e3 * v.y() << ", " << 1e3 * v.z() << "] mm";
  return text.str();
}

// A reduced model balances forces within its modes alone: of the full model's reaction it knows nothing.
bool ends_reduced(const Scene& scene, const RunReport& report) { return scene.reduction && !report.left_reduced; }

// The given points one by one, those that the mesh set in one line.
std::string moved_text(const std::vector<PathChange>& changes) {
  std::ostringstream text;
  double farthest_m = 0.0;
  for (const PathChange& change : changes) {
    if (change.point < 0) {
      farthest_m = std::max(farthest_m, change.moved_m);
      continue;
    }
    text << "  its point " << change.point << " takes hold " << 1e3 * change.moved_m << " mm from where it was put\n";
  }
  if (farthest_m > 0.0)
    text << "  between its points it takes hold up to " << 1e3 * farthest_m << " mm beside its path\n";
  return text.str();
}

// Where free obstacles are, and what they touch.
std::string free_text(const Simulation& simulation) {
  std::ostringstream text;
  const SimulationState& state = simulation.state();
  Eigen::Index free = 0;
  for (const Obstacle& obstacle : simulation.body().obstacles()) {
    if (!obstacle.is_free()) continue;
    std::vector<std::string> touched;
    for (const ContactReading& contact : simulation.contacts()) {
      if (contact.normal_force_n == 0.0) continue;
      if (contact.on == obstacle.name) touched.push_back(contact.surface);
      if (contact.surface == obstacle.name) touched.push_back(contact.on);
    }
    text << "free " << obstacle.name << " at " << millimetres(state.contact.free.centers_m.col(free)) << ", "
         << 1e3 * state.free_velocities.linear_m_s.col(free).norm() << " mm/s, touches "
         << (touched.empty() ? "nothing" : join(touched)) << "\n";
    ++free;
  }
  return text.str();
}

}  // namespace

std::string result_json(const Scene& scene, const RunReport& report) {
  const Simulation& simulation = *scene.simulation;
  Json result;
  result["markers"] = markers_json(simulation);
  add_actuators(simulation, result);
  if (scene.run.mode != RunMode::modal && !ends_reduced(scene, report)) {
    const Eigen::Matrix3Xd forces_n = simulation.reaction_forces_n();
    result["reaction"] = reaction_json(simulation, forces_n);
    result["reactions"] = reactions_json(simulation, forces_n);
  }
  if (!simulation.body().loads().empty()) result["loads"] = loads_json(simulation.body());
  if (simulation.energy_ledger()) result["energy"] = energy_json(*simulation.energy_ledger());
  add_contacts(simulation, result);
  add_free_obstacles(simulation, result);
  result["solver"] = solver_json(simulation, report.solve);
  if (ends_reduced(scene, report)) result["solver"]["residual"] = nullptr;
  if (scene.reduction) result["reduced"] = reduction_json(*scene.reduction, report);
  if (scene.fidelity) result["fidelity"] = fidelity_json(*scene.fidelity);
  if (report.sensitivity.size() > 0) result["sensitivity"] = sensitivity_json(simulation, report.sensitivity);
  if (scene.run.mode == RunMode::dynamic) result["trajectory"] = trajectory_json(simulation, report.trajectory);
  if (scene.run.mode == RunMode::modal) result["frequencies_hz"] = list(report.frequencies_hz);
  return result.dump(2) + "\n";
}

std::string result_summary(const Scene& scene, const RunReport& report) {
  const Simulation& simulation = *scene.simulation;
  const SolveReport& solve = report.solve;
  const TetMesh& mesh = simulation.body().mesh();
  std::ostringstream text;
  text << (solve.converged ? "converged" : "did not converge") << ": " << solve.iterations << " iterations in "
       << solve.steps << " steps, ";
  if (!ends_reduced(scene, report)) text << "residual " << solve.residual << ", ";
  text << solve.wall_s << " s; " << mesh.node_count() << " nodes, " << mesh.tet_count() << " elements\n";
  if (scene.fidelity) text << summary(*scene.fidelity);
  if (scene.reduction) text << summary(*scene.reduction, report);
  for (Eigen::Index i = 0; i < report.frequencies_hz.size(); ++i) {
    text << "mode " << i + 1 << " at " << report.frequencies_hz[i] << " Hz\n";
  }
  if (scene.run.mode == RunMode::modal) return text.str();  // nothing moved
  for (size_t i = 0; i < simulation.markers().size(); ++i) {
    const Marker& marker = simulation.markers()[i];
    const Eigen::Vector3d position_m = simulation.marker_position(static_cast<int>(i));
    text << "marker " << marker.name() << " at " << millimetres(position_m) << ", moved "
         << millimetres(position_m - marker.rest_position_m()) << "\n";
  }
  text << free_text(simulation);
  for (const ContactReading& contact : simulation.contacts()) {
    if (contact.normal_force_n == 0.0) continue;
    text << contact.on << " touches " << contact.surface << " with " << contact.normal_force_n << " N";
    if (contact.area_m2 > 0.0) text << " on " << 1e6 * contact.area_m2 << " mm2";
    text << "\n";
  }
  for (size_t i = 0; i < simulation.actuators().size(); ++i) {
    const ActuatorReading state = simulation.actuator_state(static_cast<int>(i));
    text << "actuator " << state.name << " at command " << state.actuated_command;
    if (state.tension_n) text << ", tension " << *state.tension_n << " N";
    if (state.slack_m && *state.slack_m > 0.0) text << ", slack by " << 1e3 * *state.slack_m << " mm";
    if (state.gauge_pressure_pa) text << ", gauge pressure " << *state.gauge_pressure_pa << " Pa";
    text << "\n";
    text << moved_text(state.path_changes);
  }
  return text.str();
}

}  // namespace soft_robot_lab
