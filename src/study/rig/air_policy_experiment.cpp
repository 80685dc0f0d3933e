// SPDX-License-Identifier: BSD-3-Clause
#include "air_policy_experiment.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "lab_settings.h"
#include "soft_robot_lab/control/find_policy.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

struct AirTarget {
  std::string name;
  Eigen::Vector3d position_m;
};

struct AirSettings {
  LabFiles files;
  std::string marker;
  OptimiserOptions optimiser;
  std::vector<AirTarget> targets;
};

AirSettings read_air_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("air_policy"));
  AirSettings settings{read_lab_files(node, context), node.text("marker"), {}, {}};
  settings.optimiser.method = node.choice("method", optimiser_methods());
  for (const YamlNode& target : node.sequence("targets"))
    settings.targets.push_back({target.text("name"), target.vector3("position_m")});
  if (settings.targets.empty()) node.fail("targets is empty");
  node.require_all_read();
  return settings;
}

PolicyTask task_of(const AirSettings& settings, const Eigen::Vector3d& target_m) {
  PolicyTask task;
  task.poses = {{{{settings.marker, target_m, 1.0}}}};
  for (const MotorSettings& motor : settings.files.lab.rig.motors)
    task.bounds.push_back({motor.name, motor.min_value, motor.max_value});
  return task;
}

// Distances of the marker from its target.
struct AirReach {
  AirTarget target;
  CommandPolicy policy;
  OptimisationSummary summary;
  double before_m, model_m, true_m, measured_m;
};

double distance_m(const MarkerPlaces& places, const std::string& marker, const Eigen::Vector3d& target_m) {
  const auto place = places.find(marker);
  return place == places.end() ? std::nan("") : (place->second - target_m).norm();
}

// From where the target before has left model and robot.
AirReach reach(const AirSettings& settings, const AirTarget& target, EmulatedLab& lab, Simulation& model) {
  const double before_m = distance_m(lab.plant().markers_m(), settings.marker, target.position_m);
  const PolicyAnswer answer = find_policy(model, task_of(settings, target.position_m), settings.optimiser);
  if (!answer.success)
    throw std::runtime_error(target.name +
                             ": no policy: " + (answer.summaries.empty() ? "" : answer.summaries.back().stop_reason));
  lab.go(answer.policy.names, answer.policy.steps.back().values);
  const MarkerPlaces expected_m = marker_places(model);
  return {target,
          answer.policy,
          answer.summaries.back(),
          before_m,
          distance_m(expected_m, settings.marker, target.position_m),
          distance_m(lab.plant().markers_m(), settings.marker, target.position_m),
          distance_m(lab.measure(expected_m), settings.marker, target.position_m)};
}

std::vector<AirReach> reach_all(const AirSettings& settings, const ExperimentContext& context, int& failed_steps) {
  const Scene model = load_scene(settings.files.robot, context.scene_options());
  model.simulation->solve_equilibrium();
  context.report(0, "calibrating the cameras");
  EmulatedLab lab(settings.files.lab, context.scene_options());
  lab.calibrate(settings.files.balls);
  std::vector<AirReach> reached;
  for (const AirTarget& target : settings.targets) {
    context.report(double(reached.size()) / double(settings.targets.size()), target.name);
    reached.push_back(reach(settings, target, lab, *model.simulation));
  }
  failed_steps = lab.plant().failed_steps();
  return reached;
}

Table table_of(const std::vector<AirReach>& all) {
  Table table;
  table.columns = {{"target"}};
  for (const std::string& name : all.front().policy.names) table.columns.push_back({name + " [ml]"});
  for (const char* column : {"before [mm]", "on the model [mm]", "on the robot [mm]", "measured [mm]"})
    table.columns.push_back({column, 3});
  table.columns.insert(table.columns.end(), {{"equilibria"}, {"CPU [s]", 2}});
  for (const AirReach& one : all) {
    std::vector<TableCell> row = {one.target.name};
    const std::vector<double>& values = one.policy.steps.back().values;
    row.insert(row.end(), values.begin(), values.end());
    for (const double value_m : {one.before_m, one.model_m, one.true_m, one.measured_m})
      row.emplace_back(std::isfinite(value_m) ? TableCell(1e3 * value_m) : TableCell(""));
    row.emplace_back(double(one.summary.evaluations));
    row.emplace_back(one.summary.cpu_s);
    table.rows.push_back(std::move(row));
  }
  return table;
}

Plot draw(const std::vector<AirReach>& all) {
  Plot plot{"air_policy", "Distance of Bubblebot's tip from its targets", {}, {}};
  plot.x.label = "target";
  plot.y.label = "distance [mm]";
  plot.y.min = 0;
  Series before{"before", {}, {}, SeriesStyle::bars}, model{"on the model", {}, {}, SeriesStyle::bars},
      robot{"on the emulated robot", {}, {}, SeriesStyle::bars};
  for (std::size_t i = 0; i < all.size(); ++i) {
    plot.x.ticks.emplace_back(double(i), all[i].target.name);
    for (Series* series : {&before, &model, &robot}) series->x.push_back(double(i));
    before.y.push_back(1e3 * all[i].before_m);
    model.y.push_back(1e3 * all[i].model_m);
    robot.y.push_back(1e3 * all[i].true_m);
  }
  plot.series = {before, model, robot};
  return plot;
}

std::string words(const std::vector<AirReach>& all) {
  std::ostringstream text;
  text.precision(3);
  for (const AirReach& one : all)
    text << "Of the target " << one.target.name << " the tip is " << 1e3 * one.before_m << " mm away before, "
         << 1e3 * one.model_m << " mm on the model and " << 1e3 * one.true_m
         << " mm on the emulated robot after its policy. ";
  text << "That robot is stiffer than the model, creeps, and has longer tubes; distances on it are those of its own "
          "marker.";
  return text.str();
}

}  // namespace

ExperimentResult run_air_policy_experiment(const ExperimentContext& context) {
  const AirSettings settings = read_air_settings(context);
  int failed_steps = 0;
  const std::vector<AirReach> all = reach_all(settings, context, failed_steps);
  ExperimentResult result;
  result.title = "Policies for Bubblebot's three syringes, played on the emulated rig";
  result.table = table_of(all);
  for (const AirReach& one : all)
    result.numbers["targets"].push_back({{"name", one.target.name},
                                         {"syringe_ml", one.policy.steps.back().values},
                                         {"before_m", one.before_m},
                                         {"model_m", one.model_m},
                                         {"robot_m", one.true_m},
                                         {"measured_m", one.measured_m},
                                         {"stopped", one.summary.stop_reason}});
  result.plots = {draw(all)};
  result.source_reports =
      "The source finds policies for cables alone; for air it names a pump driven by motors as what a policy's "
      "transfer "
      "would need.";
  result.we_find = words(all);
  result.converged = failed_steps == 0;
  if (!result.converged) result.message = std::to_string(failed_steps) + " time steps of plant did not converge";
  return result;
}

}  // namespace soft_robot_lab
