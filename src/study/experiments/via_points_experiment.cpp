// SPDX-License-Identifier: BSD-3-Clause
// The source's figure 4.4: a cable in a body held at both ends is as long as its via points let it be.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "cable_experiments.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "robot/scene/scene_cables.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/embedding.h"

namespace soft_robot_lab {
namespace {

constexpr int kPathPoints = 400;  // of the silicone's own line, whose length counts as true

struct ViaSettings {
  std::string scene;
  std::vector<double> contractions;
  std::vector<int> counts;
  int reference_count = 0;
};

struct ViaRun {
  double contraction = 1.0;
  int count = 0;             // of via points
  bool per_element = false;  // set by the cable itself
  double length_m = 0.0, true_length_m = 0.0, tension_n = 0.0;
  double sag_m = 0.0;  // of the middle
  std::string trouble;
};

ViaSettings read_via_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("via_points"));
  ViaSettings settings;
  settings.scene = context.config_folder + "/" + node.text("scene");
  for (const YamlNode& c : node.sequence("contractions"))
    settings.contractions.push_back(c.as_number(AllowedRange::positive()));
  for (const YamlNode& count : node.sequence("counts"))
    settings.counts.push_back(static_cast<int>(count.as_number({0.0, 1000.0})));
  settings.reference_count = node.integer("reference_count", 1, 1000);
  if (settings.contractions.empty()) node.fail("contractions is empty");
  if (settings.counts.empty()) node.fail("counts is empty");
  node.require_all_read();
  return settings;
}

// The scene's cable with so many via points evenly between its ends; with those that it sets itself where `count` < 0.
Overrides with_via_points(const Simulation& simulation, int count) {
  const ActuatorReading cable = simulation.actuator_state(0);
  const Eigen::Vector3d from = cable.path_m.front(), to = cable.path_m.back();
  std::vector<Eigen::Vector3d> points_m;
  for (int i = 0; i <= std::max(count, 0) + 1; ++i)
    points_m.emplace_back(from + (to - from) * i / (std::max(count, 0) + 1));
  return Overrides()
      .set({"cables", cable.name, "via_points"}, count < 0 ? "per_element" : "given")
      .set({"cables", cable.name, "points_m"}, points_m);
}

// Of the silicone along the cable's rest line, as it lies now.
double true_length_m(const Simulation& simulation, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const MeshLocator locator(simulation.body().mesh());
  double length = 0.0;
  Eigen::Vector3d last = from;
  for (int i = 0; i <= kPathPoints; ++i) {
    const Eigen::Vector3d rest = from + (to - from) * i / kPathPoints;
    const Eigen::Vector3d at = locator.embed(rest).at(simulation.state().positions_m);
    if (i > 0) length += (at - last).norm();
    last = at;
  }
  return length;
}

ViaRun pull(const ExperimentContext& context, const ViaSettings& settings, double contraction, int count) {
  const Scene plain = load_scene(settings.scene, context.scene_options());
  const Scene scene = load_scene(settings.scene, context.scene_options(with_via_points(*plain.simulation, count)));
  Simulation& simulation = *scene.simulation;
  const std::vector<Eigen::Vector3d> rest_path = simulation.actuator_state(0).path_m;
  simulation.set_command(simulation.actuator_state(0).name, contraction);
  const SolveReport solve = simulation.solve_equilibrium();
  const ActuatorReading cable = simulation.actuator_state(0);
  ViaRun run;
  run.contraction = contraction;
  run.count = static_cast<int>(cable.path_m.size()) - 2;
  run.per_element = count < 0;
  run.length_m = *cable.length_m;
  run.true_length_m = true_length_m(simulation, rest_path.front(), rest_path.back());
  run.tension_n = *cable.tension_n;
  run.sag_m = -simulation.marker_position(0).y() + simulation.markers()[0].rest_position_m().y();
  run.trouble = solve.converged ? "" : solve.message;
  return run;
}

std::string label(const ViaRun& run) {
  return std::to_string(run.count) + (run.per_element ? ", one in every element" : "");
}

void add_row(const ViaRun& run, const ViaRun& reference, ExperimentResult& result) {
  result.table.rows.push_back({run.contraction, label(run), 1e3 * run.length_m, 1e3 * run.true_length_m,
                               1e3 * (run.length_m - run.true_length_m), run.tension_n,
                               1e2 * (run.tension_n / reference.tension_n - 1.0), 1e3 * run.sag_m,
                               1e3 * (run.sag_m - reference.sag_m)});
  result.numbers["runs"].push_back({{"contraction", run.contraction},
                                    {"via_points", run.count},
                                    {"per_element", run.per_element},
                                    {"length_m", run.length_m},
                                    {"true_length_m", run.true_length_m},
                                    {"tension_n", run.tension_n},
                                    {"sag_m", run.sag_m}});
  if (run.trouble.empty()) return;
  result.converged = false;
  result.message = label(run) + " via points: " + run.trouble;
}

// One curve a contraction; the runs of evenly spaced points only.
template <typename Value>
Plot plot_over_count(const std::string& name, const std::string& title, const std::string& axis,
                     const std::vector<ViaRun>& runs, const Value& value) {
  Plot plot{"via_points_" + name, title, {}, {}, {}};
  plot.x.label = "via points, evenly spaced";
  plot.y.label = axis;
  for (const ViaRun& run : runs) {
    std::ostringstream contraction;
    contraction << "contraction " << run.contraction;
    if (plot.series.empty() || plot.series.back().label != contraction.str())
      plot.series.push_back({contraction.str(), {}, {}});
    if (run.per_element) continue;
    plot.series.back().x.push_back(run.count);
    plot.series.back().y.push_back(value(run));
  }
  return plot;
}

std::string words(const std::vector<ViaRun>& runs, const ViaRun& reference) {
  std::ostringstream text;
  text.precision(3);
  for (const ViaRun& run : runs) {
    if (run.contraction != reference.contraction) continue;
    if (run.count == 0)
      text << "Without via points the cable stays " << 1e3 * run.length_m
           << " mm long, whatever the body does, while its "
           << "line in the silicone is " << 1e3 * (run.true_length_m - run.length_m)
           << " mm longer; its tension is off by " << 1e2 * (run.tension_n / reference.tension_n - 1.0) << " %. ";
    if (run.per_element)
      text << "With one in every element that it crosses, " << run.count << " in all, its length is off by "
           << 1e3 * std::abs(run.length_m - run.true_length_m) << " mm and its tension by "
           << 1e2 * std::abs(run.tension_n / reference.tension_n - 1.0) << " % of that with " << reference.count
           << " points. ";
  }
  for (const ViaRun& run : runs) {
    if (run.contraction != reference.contraction || run.per_element) continue;
    if (std::abs(run.tension_n / reference.tension_n - 1.0) > 0.01) continue;
    text << "Of those evenly spaced " << run.count << " are enough for 1 % of tension at contraction "
         << run.contraction << ".";
    break;
  }
  return text.str();
}

}  // namespace

ExperimentResult run_via_points_experiment(const ExperimentContext& context) {
  const ViaSettings settings = read_via_settings(context);
  ExperimentResult result;
  result.title = "Via points of a cable in a bar held at both ends";
  result.table.columns = {{"contraction"},
                          {"via points"},
                          {"length [mm]", 6},
                          {"of its line in the silicone [mm]", 6},
                          {"off [mm]", 3},
                          {"tension [N]"},
                          {"off the reference [%]", 3},
                          {"sag [mm]"},
                          {"off the reference [mm]", 3}};
  std::vector<ViaRun> runs, references;
  std::vector<int> counts = settings.counts;
  counts.push_back(settings.reference_count);
  counts.push_back(-1);
  for (const double contraction : settings.contractions) {
    const std::size_t first = runs.size();
    for (const int count : counts) {
      context.report(double(runs.size()) / double(settings.contractions.size() * counts.size()),
                     std::to_string(count) + " via points");
      runs.push_back(pull(context, settings, contraction, count));
    }
    references.push_back(runs[runs.size() - 2]);
    for (std::size_t i = first; i < runs.size(); ++i) add_row(runs[i], references.back(), result);
  }
  result.plots = {plot_over_count("length", "Cable in a held bar: its length less that of its line", "length off [mm]",
                                  runs, [](const ViaRun& run) { return 1e3 * (run.length_m - run.true_length_m); }),
                  plot_over_count("tension", "Cable in a held bar: its tension", "tension [N]", runs,
                                  [](const ViaRun& run) { return run.tension_n; })};
  result.source_reports =
      "Figure 4.4 shows a body held at both ends with a cable from end to end, at a low and a high number of via "
      "points: at "
      "the low one the cable's length never changes. About one point in every tetrahedron is taken over as a rule of "
      "thumb "
      "that needs more investigation; its simulator allows points on the surface only. No numbers are given.";
  result.we_differ = "The bar, its load and the cable's stiffness are ours, for the figure has no numbers.";
  for (const ViaRun& reference : references) result.we_find += words(runs, reference) + " ";
  return result;
}

}  // namespace soft_robot_lab
