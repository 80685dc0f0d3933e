// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "cable_experiments.h"
#include "marker_line.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

struct WorkspaceSettings {
  std::string robot;
  double step_m = 0.0;  // of the rig's motor
  std::vector<double> contractions;
  std::vector<std::string> shape;
};

using Pair = std::pair<double, double>;  // contractions of the first and the second cable
using Tips = std::map<Pair, Eigen::Vector3d>;

WorkspaceSettings read_workspace_settings(const ExperimentContext& context, const std::string& name) {
  const YamlNode node = YamlNode::load_file(context.settings_file(name));
  WorkspaceSettings settings;
  settings.robot = context.config_folder + "/" + node.text("robot");
  settings.step_m = node.number("step_m", AllowedRange::positive());
  for (const YamlNode& c : node.sequence("contractions"))
    settings.contractions.push_back(c.as_number(AllowedRange::positive()));
  for (const YamlNode& marker : node.sequence("shape")) settings.shape.push_back(marker.as_text());
  if (settings.contractions.empty()) node.fail("contractions is empty");
  node.require_all_read();
  return settings;
}

std::string label(const Pair& pair) {
  std::ostringstream text;
  text << pair.first << " / " << pair.second;
  return text.str();
}

double steps(const WorkspaceSettings& settings, const ActuatorReading& cable) {
  return std::round((1.0 - cable.command) * *cable.rest_length_m / settings.step_m);
}

void add_row(const WorkspaceSettings& settings, const Simulation& simulation, const Eigen::Vector3d& hanging_m,
             const Pair& pair, ExperimentResult& result) {
  const ActuatorReading left = simulation.actuator_state(0), right = simulation.actuator_state(1);
  const Eigen::Vector3d tip_m = simulation.marker_position(simulation.marker_index(kTip));
  const Eigen::Vector3d moved_m = tip_m - hanging_m;
  result.table.rows.push_back({pair.first, pair.second, steps(settings, left), steps(settings, right), 1e3 * tip_m.x(),
                               1e3 * tip_m.y(), 1e3 * tip_m.z(), 1e3 * moved_m.norm(), *left.tension_n,
                               *right.tension_n});
  result.numbers["tip_m"][label(pair)] = {tip_m.x(), tip_m.y(), tip_m.z()};
}

// How far tips of exchanged contractions are from mirror images in x, at worst.
double worst_mirror_m(const Tips& tips) {
  double worst_m = 0.0;
  for (const auto& [pair, tip_m] : tips) {
    const Eigen::Vector3d& other_m = tips.at({pair.second, pair.first});
    worst_m = std::max(worst_m, (tip_m - Eigen::Vector3d(-other_m.x(), other_m.y(), other_m.z())).norm());
  }
  return worst_m;
}

Plot shape_plot(const std::string& name, const std::string& robot, const std::vector<Series>& shapes) {
  Plot plot{name + "_shapes", robot + " seen from the front, by its markers", {}, {}, shapes};
  plot.x.label = "x [mm]";
  plot.y.label = "z [mm]";
  plot.height_px = plot.width_px;
  return plot;
}

Plot tip_plot(const std::string& name, const std::string& robot, const Tips& tips) {
  Plot plot{name + "_tips", robot + ": where the tip rests, contraction left / right", {}, {}, {}};
  plot.x.label = "tip x [mm]";
  plot.y.label = "tip z [mm]";
  Series series{"", {}, {}, SeriesStyle::points};
  for (const auto& [pair, tip_m] : tips) {
    series.x.push_back(1e3 * tip_m.x());
    series.y.push_back(1e3 * tip_m.z());
    const bool pulled = pair.first < 1.0 || pair.second < 1.0;  // the others lie on each other
    series.point_labels.push_back(pulled ? label(pair) : "");
  }
  const auto [least, most] = std::minmax_element(series.x.begin(), series.x.end());
  plot.x.min = *least - 0.1 * (*most - *least);
  plot.x.max = *most + 0.15 * (*most - *least);  // for the words there
  plot.series = {series};
  return plot;
}

std::string words(const Tips& tips, const Eigen::Vector3d& hanging_m) {
  const auto farthest = std::max_element(tips.begin(), tips.end(), [&](const auto& a, const auto& b) {
    return (a.second - hanging_m).norm() < (b.second - hanging_m).norm();
  });
  std::ostringstream text;
  text.precision(4);
  text << "From hanging, the tip moves farthest at " << label(farthest->first) << ": "
       << 1e3 * (farthest->second - hanging_m).norm() << " mm. Exchanging left and right mirrors it within "
       << 1e3 * worst_mirror_m(tips)
       << " mm; a robot that buckles under two pulled cables takes one of two sides, so that there the mirror image is "
          "another rest state.";
  return text.str();
}

ExperimentResult run_workspace(const ExperimentContext& context, const std::string& name, const std::string& robot) {
  const WorkspaceSettings settings = read_workspace_settings(context, name);
  const Scene scene = load_scene(settings.robot, context.scene_options());
  Simulation& simulation = *scene.simulation;
  simulation.solve_equilibrium();
  const SimulationState hanging = simulation.state();
  const Eigen::Vector3d hanging_m = simulation.marker_position(simulation.marker_index(kTip));
  ExperimentResult result;
  result.title = robot + ": contractions and where its tip rests";
  result.table.columns = {{"left"},        {"right"},         {"left [steps]"}, {"right [steps]"},
                          {"tip x [mm]"},  {"tip y [mm]", 2}, {"tip z [mm]"},   {"from hanging [mm]"},
                          {"left [N]", 3}, {"right [N]", 3}};
  Tips tips;
  std::vector<Series> shapes;
  const double count = std::pow(double(settings.contractions.size()), 2);
  for (const double left : settings.contractions) {
    for (const double right : settings.contractions) {
      const Pair pair{left, right};
      context.report(double(tips.size()) / count, label(pair));
      simulation.set_state(hanging);
      simulation.set_command(simulation.actuators().at(0)->name(), left);
      simulation.set_command(simulation.actuators().at(1)->name(), right);
      const SolveReport solve = simulation.solve_equilibrium();
      if (!solve.converged || solve.inverted_elements > 0) {
        result.converged = false;
        result.message = label(pair) + ": " + (solve.converged ? "inverted elements" : solve.message);
      }
      tips[pair] = simulation.marker_position(simulation.marker_index(kTip));
      add_row(settings, simulation, hanging_m, pair, result);
      if (left == 1.0 || left == right) shapes.push_back(marker_line(simulation, settings.shape, label(pair)));
    }
  }
  result.numbers["worst_mirror_m"] = worst_mirror_m(tips);
  result.plots = {tip_plot(name, robot, tips), shape_plot(name, robot, shapes)};
  result.we_find = words(tips, hanging_m);
  return result;
}

}  // namespace

ExperimentResult run_hammerbot_workspace_experiment(const ExperimentContext& context) {
  return run_workspace(context, "workspace_hammerbot", "Hammerbot");
}

ExperimentResult run_spinebot_workspace_experiment(const ExperimentContext& context) {
  return run_workspace(context, "workspace_spinebot", "Spinebot");
}

}  // namespace soft_robot_lab
