// SPDX-License-Identifier: BSD-3-Clause
// What the source's coupling of a cable to the mesh, the pseudo-inverse of the interpolation, does to the force.
#include <cmath>
#include <sstream>

#include "cable_experiments.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/embedding.h"

namespace soft_robot_lab {
namespace {

struct CouplingSettings {
  std::string robot;
  Eigen::Vector3d start_m, end_near_m;
  double stiffness_n_m = 0.0, contraction = 1.0, plug_radius_m = 0.0, duration_s = 0.0;
};

// An end of the cable: at an element's corner, in the middle of an edge, of a face or of the element, or over a plug.
struct End {
  std::string name;
  Eigen::Vector3d position_m;
  double plug_radius_m = 0.0;
};

struct CouplingRun {
  std::string element, end;
  double tension_n = 0.0;          // of the spring, in the first step
  double force_n[2] = {0.0, 0.0};  // on the silicone at the cable's end: transpose, pseudo-inverse
  double tip_m[2] = {0.0, 0.0};    // how far the tip goes
  double ratio() const { return force_n[1] / force_n[0]; }
};
const char* const kCouplings[] = {"transpose", "pseudo_inverse"};

CouplingSettings read_coupling_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("pseudo_inverse"));
  CouplingSettings settings;
  settings.robot = context.config_folder + "/" + node.text("robot");
  settings.start_m = node.vector3("start_m");
  settings.end_near_m = node.vector3("end_near_m");
  settings.stiffness_n_m = node.number("stiffness_n_m", AllowedRange::positive());
  settings.contraction = node.number("contraction", AllowedRange::positive());
  settings.plug_radius_m = node.number("plug_radius_m", AllowedRange::positive());
  settings.duration_s = node.number("duration_s", AllowedRange::positive());
  node.require_all_read();
  return settings;
}

std::vector<End> ends(const CouplingSettings& settings, const TetMesh& mesh) {
  const MeshLocator locator(mesh);
  const int tet = locator.locate(settings.end_near_m).tet;
  const auto corner = [&](int i) -> Eigen::Vector3d { return mesh.nodes_m.col(mesh.tets(i, tet)); };
  const Eigen::Vector3d middle = 0.25 * (corner(0) + corner(1) + corner(2) + corner(3));
  return {{"corner", corner(0), 0.0},
          {"edge", 0.5 * (corner(0) + corner(1)), 0.0},
          {"face", (corner(0) + corner(1) + corner(2)) / 3.0, 0.0},
          {"inside", middle, 0.0},
          {"plug", settings.end_near_m, settings.plug_radius_m}};
}

Overrides with_element(const std::string& element) { return Overrides().set({"body", "element"}, element); }

Overrides overrides(const CouplingSettings& settings, const std::string& element, const End& end,
                    const std::string& coupling) {
  const Overrides cable = Overrides()
                              .set({"name"}, "cable")
                              .set({"points_m"}, std::vector<Eigen::Vector3d>{settings.start_m, end.position_m})
                              .set({"sheath_radius_m"}, 0)
                              .set({"plug_radius_m"}, end.plug_radius_m)
                              .set({"model"}, "springs")
                              .set({"stiffness_n_m"}, settings.stiffness_n_m)
                              .set({"integration"}, "explicit")
                              .set({"coupling"}, coupling);
  return with_element(element).set({"cables"}, std::vector<OverrideValue>{cable});
}

// Of the cable on the nodes that are free to move, in the step that was just made.
Eigen::Vector3d force_on_silicone_n(const Simulation& simulation) {
  const Eigen::Matrix3Xd& positions_m = simulation.state().positions_m;
  Eigen::Matrix3Xd forces_n = Eigen::Matrix3Xd::Zero(3, positions_m.cols());
  simulation.actuators()[0]->constraints().back()->add_gradient(positions_m, simulation.state().drives[0], -1.0,
                                                                forces_n);  // its held forces
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < forces_n.cols(); ++i)
    if (!simulation.body().fixed().col(i).all()) sum += forces_n.col(i);
  return sum;
}

void run_coupling(const ExperimentContext& context, const CouplingSettings& settings, const End& end, int coupling,
                  CouplingRun& run, ExperimentResult& result) {
  const Scene scene =
      load_scene(settings.robot, context.scene_options(overrides(settings, run.element, end, kCouplings[coupling])));
  Simulation& simulation = *scene.simulation;
  const int tip = simulation.marker_index("tip");
  const Eigen::Vector3d start_m = simulation.marker_position(tip);
  simulation.set_command("cable", settings.contraction);
  const long steps = std::lround(settings.duration_s / simulation.options().time_step_s);
  for (long i = 0; i < steps; ++i) {
    const SolveReport report = simulation.step();
    if (i == 0) {
      run.tension_n = simulation.actuator_state(0).tension_n.value_or(0.0);
      run.force_n[coupling] = force_on_silicone_n(simulation).norm();
    }
    if (report.converged) continue;
    result.converged = false;
    result.message = run.element + ", " + end.name + ", " + kCouplings[coupling] + ": " + report.message;
  }
  run.tip_m[coupling] = (simulation.marker_position(tip) - start_m).norm();
}

Plot ratio_plot(const std::vector<CouplingRun>& runs) {
  Plot plot{
      "pseudo_inverse_force", "Force on the silicone by the pseudo-inverse over that by the transpose", {}, {}, {}};
  plot.x.label = "where the cable ends in an element, or spread over a plug";
  plot.y.label = "ratio of total forces";
  plot.y.min = 0.0;
  for (const CouplingRun& run : runs) {
    if (plot.series.empty() || plot.series.back().label != run.element + " elements")
      plot.series.push_back({run.element + " elements", {}, {}, SeriesStyle::bars});
    Series& series = plot.series.back();
    if (plot.series.size() == 1) plot.x.ticks.emplace_back(double(series.x.size()), run.end);
    series.x.push_back(double(series.x.size()));
    series.y.push_back(run.ratio());
  }
  return plot;
}

std::string words(const std::vector<CouplingRun>& runs) {
  std::ostringstream text;
  text.precision(3);
  text << "The transpose hands the spring's tension on as it is. The pseudo-inverse multiplies it by one over the sum "
          "of the "
          "squared weights: ";
  for (const CouplingRun& run : runs) text << run.element << " element, " << run.end << ": " << run.ratio() << "; ";
  text << "so the same cable pulls the harder the more evenly the nodes share its end, and a cable's force depends on "
          "where "
          "in an element it happens to end. That is why it is no default.";
  return text.str();
}

}  // namespace

ExperimentResult run_pseudo_inverse_experiment(const ExperimentContext& context) {
  const CouplingSettings settings = read_coupling_settings(context);
  ExperimentResult result;
  result.title = "Coupling a cable by the pseudo-inverse";
  result.table.columns = {{"element"},
                          {"end"},
                          {"tension [N]"},
                          {"force by transpose [N]"},
                          {"force by pseudo-inverse [N]"},
                          {"ratio", 5},
                          {"tip goes, transpose [mm]", 3},
                          {"tip goes, pseudo-inverse [mm]", 3}};
  std::vector<CouplingRun> runs;
  for (const std::string element : {"linear", "quadratic"}) {
    const Scene scene = load_scene(settings.robot, context.scene_options(with_element(element)));
    for (const End& end : ends(settings, scene.simulation->body().mesh())) {
      context.report(double(runs.size()) / 10.0, element + ", " + end.name);
      CouplingRun run;
      run.element = element;
      run.end = end.name;
      for (const int coupling : {0, 1}) run_coupling(context, settings, end, coupling, run, result);
      result.table.rows.push_back({run.element, run.end, run.tension_n, run.force_n[0], run.force_n[1], run.ratio(),
                                   1e3 * run.tip_m[0], 1e3 * run.tip_m[1]});
      result.numbers["force_ratio"][run.element][run.end] = run.ratio();
      runs.push_back(run);
    }
  }
  result.plots = {ratio_plot(runs)};
  result.source_reports =
      "Nodal forces are N = W^+ F with W^+ = W^T (W W^T)^-1, W the barycentric weights of the cable's points (4.9): of "
      "all "
      "nodal forces that interpolate to F the least. That their sum is not F is not mentioned.";
  result.we_differ =
      "One spring from the clamp to one point, where the source has whole cables; quadratic elements beside its linear "
      "ones.";
  result.we_find = words(runs);
  return result;
}

}  // namespace soft_robot_lab
