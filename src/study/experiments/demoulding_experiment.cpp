// SPDX-License-Identifier: BSD-3-Clause
#include "demoulding_experiment.h"

#include <algorithm>
#include <sstream>

#include "demoulding.h"
#include "robot/casting/surface.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

struct DemouldingRun {
  std::string name, scene;
  Eigen::Vector3d direction;
  DemouldingCurve curve;
};

struct DemouldingSettings {
  double elongation_at_break = 0.0;  // above a length of 1
  std::vector<DemouldingRun> runs;
};

DemouldingSettings read_demoulding_settings(const ExperimentContext& context) {
  const std::string file = context.settings_file("demoulding");
  const YamlNode node = YamlNode::load_file(file);
  DemouldingSettings settings;
  settings.elongation_at_break = node.number("elongation_at_break", AllowedRange::positive());
  for (const YamlNode& item : node.sequence("runs")) {
    const Eigen::Vector3d direction = item.vector3("direction");
    if (direction.norm() == 0.0) item.child("direction").fail("has no length");
    settings.runs.push_back(
        {item.text("name"), context.config_folder + "/" + item.text("scene"), direction.normalized(), {}});
  }
  if (settings.runs.empty()) node.child("runs").fail("is empty");
  node.require_all_read();
  return settings;
}

std::vector<double> scaled(const std::vector<double>& values, double factor) {
  std::vector<double> result;
  for (const double value : values) result.push_back(factor * value);
  return result;
}

Plot plot_of(const DemouldingSettings& settings, const std::string& name, const std::string& label,
             std::vector<double> DemouldingCurve::*values) {
  Plot plot{"demoulding_" + name, "Pulled out of the mould", {"travel [mm]"}, {label}};
  for (const DemouldingRun& run : settings.runs)
    plot.series.push_back({run.name, scaled(run.curve.travel_m, 1e3), run.curve.*values, SeriesStyle::lines});
  return plot;
}

bool tears(const DemouldingSettings& settings, const DemouldingCurve& curve) {
  return curve.largest.ratio - 1.0 > settings.elongation_at_break;
}

Table table_of(const DemouldingSettings& settings) {
  Table table{{{"robot"},
               {"largest force [N]", 3},
               {"largest stretch", 3},
               {"after [mm]", 3},
               {"place"},
               {"of the elongation at break [%]", 2},
               {"verdict"}},
              {}};
  for (const DemouldingRun& run : settings.runs) {
    const DemouldingCurve& curve = run.curve;
    table.rows.push_back({run.name, curve.peak_force_n, curve.largest.ratio, 1e3 * curve.largest_at_m,
                          place_text(curve.largest.at_m),
                          100.0 * (curve.largest.ratio - 1.0) / settings.elongation_at_break,
                          std::string(!curve.converged         ? "not solved"
                                      : tears(settings, curve) ? "tears"
                                                               : "whole")});
  }
  return table;
}

nlohmann::ordered_json numbers_of(const DemouldingSettings& settings) {
  nlohmann::ordered_json runs = nlohmann::ordered_json::array();
  for (const DemouldingRun& run : settings.runs) {
    const DemouldingCurve& curve = run.curve;
    const Eigen::Vector3d at = curve.largest.at_m;
    runs.push_back({{"name", run.name},
                    {"converged", curve.converged},
                    {"peak_force_n", curve.peak_force_n},
                    {"largest_stretch", curve.largest.ratio},
                    {"at_m", {at.x(), at.y(), at.z()}},
                    {"at_travel_m", curve.largest_at_m},
                    {"tears", tears(settings, curve)},
                    {"travel_m", curve.travel_m},
                    {"force_n", curve.force_n},
                    {"stretch", curve.stretch}});
  }
  return {{"runs", runs}};
}

std::string words_for(const DemouldingSettings& settings) {
  std::ostringstream words;
  words.precision(3);
  for (const DemouldingRun& run : settings.runs)
    words << run.name << ": up to " << run.curve.peak_force_n << " N, and a stretch of " << run.curve.largest.ratio
          << " at " << place_text(run.curve.largest.at_m) << ". ";
  return words.str();
}

}  // namespace

ExperimentResult run_demoulding_experiment(const ExperimentContext& context) {
  DemouldingSettings settings = read_demoulding_settings(context);
  ExperimentResult result;
  for (std::size_t i = 0; i < settings.runs.size(); ++i) {
    DemouldingRun& run = settings.runs[i];
    context.report(static_cast<double>(i) / static_cast<double>(settings.runs.size()), run.name);
    Scene scene = load_scene(run.scene, context.scene_options());
    run.curve = pull_out(*scene.simulation, run.direction, scene.run.duration_s);
    if (run.curve.converged) continue;
    result.converged = false;
    result.message = run.name + ": " + run.curve.message;
  }
  result.title = "Robots pulled out of their moulds";
  result.table = table_of(settings);
  result.plots = {plot_of(settings, "force", "force [N]", &DemouldingCurve::force_n),
                  plot_of(settings, "stretch", "largest principal stretch", &DemouldingCurve::stretch)};
  result.numbers = numbers_of(settings);
  result.source_reports =
      "Hammerbot and Spinebot left their moulds repeatedly. Bubblebot took much more force: all three cores were torn "
      "off, and it was chipped around the top facet. The source names a vacuum as the cause, and simulates none of it.";
  result.we_differ =
      "The walls beside the cores have no suction of their own, and what air leaks in before the silicone is out does "
      "not count.";
  result.we_find = words_for(settings);
  return result;
}

}  // namespace soft_robot_lab
