#include <algorithm>
#include <cmath>
#include <sstream>

#include "experiment/cable_experiments.h"
#include "soft_robot_lab/scene/scene.h"
#include "soft_robot_lab/settings/settings_node.h"

namespace soft_robot_lab {
namespace {

struct StiffnessSettings {
  std::string robot, cable_keys;
  double contraction = 1.0, time_step_s = 0.0, duration_s = 0.0, last_s = 0.0;
  double largest_error_m = 0.0;  // shorter than commanded: a run is given up
  int largest_iterations = 0;    // of a run, likewise
  std::vector<double> stiffnesses_n_m, sliding_stiffnesses_n_m;
};

enum class Model { sliding, implicit_springs, explicit_springs };
const char* const kModelNames[] = {"sliding", "implicit springs", "explicit springs"};

struct StiffnessRun {
  Model model = Model::sliding;
  double stiffness_n_m = 0.0;  // 0: rigid
  std::vector<double> time_s, length_m;
  ActuatorReading end;
  double overshoot_m = 0.0;  // shorter than at the end, at worst
  double swing_m = 0.0;      // half of longest less shortest in the last part
  std::string given_up;      // why; empty where the whole run was done
};

StiffnessSettings read_settings(const ExperimentContext& context) {
  const SettingsNode node = SettingsNode::load_file(context.settings_file("4.3.2"));
  StiffnessSettings settings;
  settings.robot = context.config_folder + "/" + node.text("robot");
  settings.cable_keys = node.text("cable");
  settings.contraction = node.number("contraction", AllowedRange::positive());
  settings.time_step_s = node.number("time_step_s", AllowedRange::positive());
  settings.duration_s = node.number("duration_s", AllowedRange::positive());
  settings.last_s = node.number("last_s", AllowedRange::positive());
  settings.largest_error_m = node.number("largest_error_m", AllowedRange::positive());
  settings.largest_iterations = static_cast<int>(node.number("largest_iterations", AllowedRange::positive()));
  for (const SettingsNode& k : node.sequence("stiffnesses_n_m"))
    settings.stiffnesses_n_m.push_back(k.as_number(AllowedRange::positive()));
  for (const SettingsNode& k : node.sequence("sliding_stiffnesses_n_m"))
    settings.sliding_stiffnesses_n_m.push_back(k.as_number(AllowedRange::positive()));
  if (settings.stiffnesses_n_m.empty()) node.fail("stiffnesses_n_m is empty");
  node.require_all_read();
  return settings;
}

// The robot's own cable, but for its model.
std::string cable_yaml(const StiffnessSettings& settings, const Simulation& robot, Model model, double stiffness_n_m) {
  std::ostringstream text;
  text.precision(12);
  const ActuatorReading cable = robot.actuator_state(0);
  text << "solver: {time_step_s: " << settings.time_step_s
       << (model == Model::explicit_springs ? ", max_iterations: 8" : "")  // a step that diverges is no use repeated
       << "}\ncables: [{name: " << cable.name << ", points_m: [";
  for (const Eigen::Vector3d& point : cable.path_m)
    text << (&point == &cable.path_m.front() ? "" : ", ") << "[" << point.x() << ", " << point.y() << ", " << point.z()
         << "]";
  text << "], " << settings.cable_keys;
  if (model == Model::sliding)
    text << ", compliance_m_n: " << (stiffness_n_m > 0.0 ? 1.0 / stiffness_n_m : 0.0);
  else
    text << ", model: springs, stiffness_n_m: " << stiffness_n_m
         << ", integration: " << (model == Model::explicit_springs ? "explicit" : "implicit");
  text << "}]\n";
  return text.str();
}

std::string label(const StiffnessRun& run) {
  if (run.stiffness_n_m == 0.0) return "rigid";
  std::ostringstream text;
  text << run.stiffness_n_m << " N/m";
  return text.str();
}

void measure(const StiffnessSettings& settings, StiffnessRun& run) {
  const double last_m = run.length_m.back();
  run.overshoot_m = last_m - *std::min_element(run.length_m.begin(), run.length_m.end());
  const auto from = std::lower_bound(run.time_s.begin(), run.time_s.end(), run.time_s.back() - settings.last_s);
  const auto [least, most] =
      std::minmax_element(run.length_m.begin() + (from - run.time_s.begin()), run.length_m.end());
  run.swing_m = 0.5 * (*most - *least);
}

StiffnessRun pull(const ExperimentContext& context, const StiffnessSettings& settings, Model model,
                  double stiffness_n_m) {
  const Scene robot = load_scene(settings.robot, context.scene_options());
  const Scene scene =
      load_scene(settings.robot, context.scene_options(cable_yaml(settings, *robot.simulation, model, stiffness_n_m)));
  Simulation& simulation = *scene.simulation;
  StiffnessRun run;
  run.model = model;
  run.stiffness_n_m = stiffness_n_m;
  run.time_s = {0.0};
  run.length_m = {*simulation.actuator_state(0).length_m};
  simulation.set_command(simulation.actuator_state(0).name, settings.contraction);
  const long steps = std::lround(settings.duration_s / settings.time_step_s);
  int iterations = 0;
  for (long i = 0; i < steps && run.given_up.empty(); ++i) {
    const SolveReport report = simulation.step();
    iterations += report.iterations;
    if (!report.converged) run.given_up = "a step found no solution";
    if (iterations > settings.largest_iterations) run.given_up = "too many iterations";
    const ActuatorReading cable = simulation.actuator_state(0);
    if (*cable.length_m < *cable.commanded_length_m - settings.largest_error_m) run.given_up = "crushes the bar";
    run.time_s.push_back(simulation.state().time_s);
    run.length_m.push_back(*cable.length_m);
  }
  run.end = simulation.actuator_state(0);
  measure(settings, run);
  return run;
}

std::vector<StiffnessRun> pull_all(const ExperimentContext& context, const StiffnessSettings& settings) {
  std::vector<std::pair<Model, double>> wanted;
  for (const Model model : {Model::sliding, Model::implicit_springs, Model::explicit_springs}) {
    for (const double k : settings.stiffnesses_n_m) wanted.emplace_back(model, k);
    if (model != Model::sliding) continue;
    for (const double k : settings.sliding_stiffnesses_n_m) wanted.emplace_back(model, k);
    wanted.emplace_back(model, 0.0);
  }
  std::vector<StiffnessRun> runs;
  for (const auto& [model, k] : wanted) {
    std::ostringstream what;
    what << kModelNames[static_cast<int>(model)] << ", " << k << " N/m";
    context.tell(double(runs.size()) / double(wanted.size()), what.str());
    runs.push_back(pull(context, settings, model, k));
  }
  return runs;
}

Plot length_plot(const std::vector<StiffnessRun>& runs, Model model) {
  const std::string name = kModelNames[static_cast<int>(model)];
  Plot plot{"4.3.2_" + name, "Hanging bar pulled to 95 %: length of the cable, " + name, {}, {}};
  std::replace(plot.name.begin(), plot.name.end(), ' ', '_');
  plot.x.label = "time [s]";
  plot.y.label = "length [mm]";
  for (const StiffnessRun& run : runs) {
    if (run.model != model) continue;
    Series series{label(run) + (run.given_up.empty() ? "" : ", given up"), run.time_s, {}, SeriesStyle::lines};
    for (const double length_m : run.length_m) series.y.push_back(1e3 * length_m);
    plot.series.push_back(series);
  }
  return plot;
}

void add_row(const StiffnessSettings& settings, const StiffnessRun& run, ExperimentResult& result) {
  const double rest_m = *run.end.rest_length_m, wanted_m = settings.contraction * rest_m;
  const double last_m = run.length_m.back(), off_m = last_m - wanted_m, stretch_m = run.end.stretch_m.value_or(0.0);
  result.table.rows.push_back({kModelNames[static_cast<int>(run.model)], label(run), run.time_s.back(), 1e3 * last_m,
                               1e3 * off_m, 1e3 * stretch_m, 1e3 * run.overshoot_m, 1e3 * run.swing_m,
                               run.end.tension_n.value_or(0.0), run.given_up});
  std::string model = kModelNames[static_cast<int>(run.model)];
  std::replace(model.begin(), model.end(), ' ', '_');
  result.numbers[model][label(run)] = {{"final_length_m", last_m},
                                       {"stretch_m", stretch_m},
                                       {"overshoot_m", run.overshoot_m},
                                       {"swing_m", run.swing_m},
                                       {"until_s", run.time_s.back()}};
}

std::string words(const StiffnessSettings& settings, const std::vector<StiffnessRun>& runs) {
  double sliding_swing_m = 0.0, implicit_swing_m = 0.0, rigid_off_m = 0.0, calm_n_m = 0.0;
  std::ostringstream trembling;
  for (const StiffnessRun& run : runs) {
    const double off_m = run.length_m.back() - settings.contraction * *run.end.rest_length_m;
    if (run.model == Model::sliding) {
      sliding_swing_m = std::max(sliding_swing_m, run.swing_m);
      if (run.stiffness_n_m == 0.0) rigid_off_m = off_m;
      if (run.stiffness_n_m > 0.0 && std::abs(off_m) > 5e-5) calm_n_m = std::max(calm_n_m, run.stiffness_n_m);
    } else if (run.model == Model::implicit_springs) {
      implicit_swing_m = std::max(implicit_swing_m, run.swing_m);
    } else {
      trembling << (trembling.tellp() > 0 ? ", " : "") << label(run) << ": " << 1e3 * run.swing_m << " mm";
      if (!run.given_up.empty()) trembling << " (" << run.given_up << " at " << run.time_s.back() << " s)";
    }
  }
  std::ostringstream text;
  text.precision(3);
  text << "A rigid sliding cable ends within " << 1e3 * std::abs(rigid_off_m)
       << " mm of where it is told, and none swings by more than " << 1e3 * sliding_swing_m << " mm in the last part. ";
  if (calm_n_m > 0.0)
    text << "Up to " << calm_n_m << " N/m its stretch (tension over stiffness) makes it more than 0.05 mm longer. ";
  text << "Implicit springs swing by " << 1e3 * implicit_swing_m
       << " mm at most. Explicit springs, as in the source, swing in the last part by " << trembling.str() << ".";
  return text.str();
}

}  // namespace

ExperimentResult run_cable_stiffness_experiment(const ExperimentContext& context) {
  const StiffnessSettings settings = read_settings(context);
  const std::vector<StiffnessRun> runs = pull_all(context, settings);
  ExperimentResult result;
  result.title = "Cable stiffness on the hanging bar";
  result.table.columns = {{"cable"},
                          {"stiffness"},
                          {"until [s]", 3},
                          {"length [mm]", 7},
                          {"off the command [mm]", 3},
                          {"stretch [mm]", 3},
                          {"overshoot [mm]", 3},
                          {"swing at the end [mm]", 3},
                          {"tension [N]", 3},
                          {"given up"}};
  for (const StiffnessRun& run : runs) {
    add_row(settings, run, result);
    // The source's own explicit springs are known to fail.
    if (run.model == Model::explicit_springs || run.given_up.empty()) continue;
    result.converged = false;
    result.message = kModelNames[static_cast<int>(run.model)] + (", " + label(run) + ": " + run.given_up);
  }
  for (const Model model : {Model::sliding, Model::implicit_springs, Model::explicit_springs})
    result.plots.push_back(length_plot(runs, model));
  result.source_reports =
      "The source pulls the bar to 95 % with explicit springs of 1000 to 25000 N/m: the stiffer they are, the more the "
      "cable oscillates. No number of it is known here.";
  result.we_find = words(settings, runs);
  return result;
}

}  // namespace soft_robot_lab
