// SPDX-License-Identifier: BSD-3-Clause
#include "chamber_run.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include <Eigen/Geometry>

#include "control/identification/simulated_now.h"
#include "session/report/skin.h"
#include "soft_robot_lab/settings/yaml_node.h"

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
  state.markers_m = places(simulation);
  state.positions_m = simulation.state().positions_m;
  return state;
}

// Why a state does not count; empty where it does.
std::string trouble(const SolveReport& solve) {
  if (!solve.converged) return solve.message.empty() ? "did not converge" : solve.message;
  if (solve.inverted_elements > 0) return std::to_string(solve.inverted_elements) + " elements are inverted";
  return "";
}

constexpr double kSharp = 0.9;    // cosine of the angle between two faces' normals at which they meet in an edge
constexpr int kCutsOfAnEdge = 4;  // of a curved edge, where it is drawn

Eigen::Vector3d normal(const TetMesh& mesh, Eigen::Index face) {
  const Eigen::Vector3d a = mesh.nodes_m.col(mesh.faces(0, face)), b = mesh.nodes_m.col(mesh.faces(1, face)),
                        c = mesh.nodes_m.col(mesh.faces(2, face));
  return (b - a).cross(c - a).normalized();
}

struct Edge {
  int corners[2];
  int middle;  // node between them; -1 for none
};

// Edges of the outer skin along which the rest shape has a crease.
std::vector<Edge> sharp_edges(const TetMesh& mesh) {
  std::map<std::pair<int, int>, std::vector<std::pair<Eigen::Vector3d, int>>> sides;  // normals and middle nodes
  for (const int face : outer_faces(mesh)) {
    for (int k = 0; k < 3; ++k) {
      const std::pair<int, int> corners = std::minmax({mesh.faces(k, face), mesh.faces((k + 1) % 3, face)});
      const int middle = mesh.faces.rows() == 6 ? mesh.faces(3 + k, face) : -1;
      sides[corners].emplace_back(normal(mesh, face), middle);
    }
  }
  std::vector<Edge> edges;
  for (const auto& [corners, meeting] : sides) {
    if (meeting.size() == 2 && meeting[0].first.dot(meeting[1].first) > kSharp) continue;
    edges.push_back({{corners.first, corners.second}, meeting[0].second});
  }
  return edges;
}

// Draws edges that hang together as one line, which goes along each of them there and back.
class Pen {
 public:
  Pen(const std::vector<Edge>& edges, const Eigen::Matrix3Xd& positions_m, int x_axis, int y_axis)
      : edges_(edges), positions_m_(positions_m), x_axis_(x_axis), y_axis_(y_axis), drawn_(edges.size(), false) {
    for (std::size_t i = 0; i < edges.size(); ++i)
      for (const int corner : edges[i].corners) at_corner_[corner].push_back(i);
  }

  bool has_drawn(std::size_t edge) const { return drawn_[edge]; }

  void draw_from(int corner, Series& series) {
    for (const std::size_t i : at_corner_[corner]) {
      if (drawn_[i]) continue;
      drawn_[i] = true;
      const int other = edges_[i].corners[edges_[i].corners[0] == corner ? 1 : 0];
      go(corner, other, edges_[i].middle, series);
      draw_from(other, series);
      go(other, corner, edges_[i].middle, series);
    }
  }

 private:
  // As a quadratic curve through its three nodes, or a straight line.
  void go(int from, int to, int middle, Series& series) const {
    const int cuts = middle >= 0 ? kCutsOfAnEdge : 1;
    for (int i = 0; i <= cuts; ++i) {
      const double t = static_cast<double>(i) / cuts;
      const Eigen::Vector3d a_m = positions_m_.col(from), b_m = positions_m_.col(to);
      Eigen::Vector3d at_m = (1 - t) * a_m + t * b_m;
      if (middle >= 0) at_m += 4 * t * (1 - t) * (positions_m_.col(middle) - 0.5 * (a_m + b_m));
      series.x.push_back(1e3 * at_m[x_axis_]);
      series.y.push_back(1e3 * at_m[y_axis_]);
    }
  }

  const std::vector<Edge>& edges_;
  const Eigen::Matrix3Xd& positions_m_;
  int x_axis_, y_axis_;
  std::vector<bool> drawn_;
  std::map<int, std::vector<std::size_t>> at_corner_;
};

std::vector<double> read_betas(const YamlNode& node, const YamlNode& list) {
  std::vector<double> betas;
  for (const YamlNode& beta : list.items()) betas.push_back(beta.as_number(AllowedRange::positive()));
  if (betas.empty()) node.fail("betas is empty");
  return betas;
}

PumpSettings read_pump(const YamlNode& node, const ChamberSettings& settings) {
  PumpSettings pump;
  std::vector<std::string> names;
  for (const ChamberMesh& mesh : settings.meshes) names.push_back(mesh.name);
  pump.mesh = node.choice("mesh", names);
  pump.beta = node.number("beta", AllowedRange::positive());
  pump.beta_per_step = node.number("beta_per_step", AllowedRange::positive());
  pump.duration_s = node.number("duration_s", AllowedRange::positive());
  return pump;
}

int actuator_of(const ChamberSettings& settings, const Simulation& simulation) {
  return settings.chamber.empty() ? 0 : simulation.actuator_index(settings.chamber);
}

void report_trouble(const std::string& what, const std::string& why, ExperimentResult& result) {
  result.converged = false;
  result.message = what + ": " + why;
}

// A line for each part that hangs together, of which the first bears the label [mm].
std::vector<Series> outline(const ChamberRun& run, const ChamberState& state, int x_axis, int y_axis,
                            const std::string& label, int colour) {
  const std::vector<Edge> edges = sharp_edges(run.simulation().body().mesh());
  Pen pen(edges, state.positions_m, x_axis, y_axis);
  std::vector<Series> lines;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (pen.has_drawn(i)) continue;
    lines.push_back({lines.empty() ? label : "", {}, {}, SeriesStyle::lines, colour});
    pen.draw_from(edges[i].corners[0], lines.back());
  }
  return lines;
}

}  // namespace

Eigen::Vector3d ChamberRun::moved_m(const ChamberState& state, const std::string& marker) const {
  const int index = simulation().marker_index(marker);
  return state.markers_m.col(index) - states.front().markers_m.col(index);
}

ChamberSettings read_chamber_settings(const ExperimentContext& context, const std::string& name) {
  const YamlNode node = YamlNode::load_file(context.settings_file(name));
  ChamberSettings settings;
  settings.chamber = node.text_or("chamber", "");
  if (const auto set_up = node.optional_child("set_up")) settings.overrides = Overrides(*set_up);
  const YamlNode meshes = node.child("meshes"), betas = node.child("betas");
  for (const std::string& mesh : meshes.keys())
    settings.meshes.push_back({mesh, context.config_folder + "/" + meshes.text(mesh),
                               read_betas(node, betas.is_map() ? betas.child(mesh) : betas)});
  if (settings.meshes.empty()) node.fail("meshes is empty");
  if (const auto pump = node.optional_child("pump")) settings.pump = read_pump(*pump, settings);
  node.require_all_read();
  return settings;
}

std::vector<ChamberRun> run_chambers(const ExperimentContext& context, const ChamberSettings& settings,
                                     ExperimentResult& result) {
  std::vector<ChamberRun> runs;
  double count = 0.0, done = 0.0;
  for (const ChamberMesh& mesh : settings.meshes) count += static_cast<double>(mesh.betas.size());
  for (const ChamberMesh& mesh : settings.meshes) {
    context.report(done / count, mesh.name + " mesh");
    ChamberRun run{mesh.name, load_scene(mesh.file, context.scene_options(settings.overrides)), {}};
    Simulation& simulation = *run.scene.simulation;
    const int actuator = actuator_of(settings, simulation);
    for (const double beta : mesh.betas) {
      std::ostringstream what;
      what << mesh.name << " at beta " << beta;
      context.report(done++ / count, what.str());
      simulation.set_command(simulation.actuators().at(static_cast<size_t>(actuator))->name(), beta);
      const SolveReport solve = simulation.solve_equilibrium();
      run.states.push_back(observe(simulation, actuator, beta, solve));
      const std::string why = trouble(solve);
      if (why.empty()) continue;
      report_trouble(what.str(), why, result);
      break;
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

Pumping pump_chamber(const ExperimentContext& context, const ChamberSettings& settings, ExperimentResult& result) {
  const PumpSettings& pump = settings.pump.value();
  const auto mesh = std::find_if(settings.meshes.begin(), settings.meshes.end(),
                                 [&](const ChamberMesh& one) { return one.name == pump.mesh; });
  Pumping pumping{{pump.mesh, load_scene(mesh->file, context.scene_options(settings.overrides)), {}}, {}, {}, {}};
  Simulation& simulation = *pumping.run.scene.simulation;
  const int actuator = actuator_of(settings, simulation);
  SolveReport report = simulation.solve_equilibrium();
  const auto record = [&] {
    const ActuatorReading chamber = simulation.actuator_state(actuator);
    pumping.time_s.push_back(simulation.state().time_s);
    pumping.volume_m3.push_back(*chamber.volume_m3);
    pumping.gauge_pressure_pa.push_back(*chamber.gauge_pressure_pa);
  };
  pumping.run.states.push_back(observe(simulation, actuator, 1.0, report));
  record();
  const long steps = std::lround(pump.duration_s / simulation.options().time_step_s);
  for (long i = 1; i <= steps && trouble(report).empty(); ++i) {
    const double change = pump.beta - 1.0, so_far = pump.beta_per_step * static_cast<double>(i);
    const double beta = std::abs(change) <= so_far ? pump.beta : 1.0 + std::copysign(so_far, change);
    if (i % 10 == 0) context.report(static_cast<double>(i) / static_cast<double>(steps), pump.mesh + " in time");
    simulation.set_command(simulation.actuators().at(static_cast<size_t>(actuator))->name(), beta);
    report = simulation.step();
    record();
  }
  pumping.run.states.push_back(observe(simulation, actuator, pump.beta, report));
  if (!trouble(report).empty()) {
    std::ostringstream what;
    what << pump.mesh << " in time, after " << pumping.time_s.back() << " s";
    report_trouble(what.str(), trouble(report), result);
  }
  return pumping;
}

double worst_gas_residual(const std::vector<ChamberRun>& runs) {
  double worst = 0.0;
  for (const ChamberRun& run : runs)
    for (const ChamberState& state : run.states) worst = std::max(worst, state.gas_residual);
  return worst;
}

Plot outline_plot(const ChamberRun& run, const std::string& name, const std::string& title, int x_axis, int y_axis) {
  constexpr int kBefore = 5, kAfter = 1;  // colours
  const auto label_of = [](int axis) { return std::string(1, "xyz"[axis]) + " [mm]"; };
  Plot plot{name, title, {}, {}, {}};
  plot.x.label = label_of(x_axis);
  plot.y.label = label_of(y_axis);
  for (const ChamberState* state : {&run.states.front(), &run.states.back()}) {
    std::ostringstream label;
    label << "beta " << state->beta;
    const std::vector<Series> lines =
        outline(run, *state, x_axis, y_axis, label.str(), state == &run.states.front() ? kBefore : kAfter);
    plot.series.insert(plot.series.end(), lines.begin(), lines.end());
  }
  return plot;
}

}  // namespace soft_robot_lab
