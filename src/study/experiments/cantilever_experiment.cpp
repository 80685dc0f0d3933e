// SPDX-License-Identifier: BSD-3-Clause
#include "cantilever_experiment.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "settings/reference_table.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

struct CantileverSettings {
  std::string scene;
  double element_size_m;
  std::vector<std::string> elements;
};

CantileverSettings read_cantilever_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("cantilever"));
  CantileverSettings settings;
  settings.scene = context.config_folder + "/" + node.text("scene");
  settings.element_size_m = node.number("element_size_m", AllowedRange::positive());
  for (const YamlNode& element : node.sequence("elements")) settings.elements.push_back(element.as_text());
  node.require_all_read();
  return settings;
}

struct Sag {
  double sag_m = 0.0;
  int elements = 0;
  SolveReport solve;
};

Sag find_sag(const ExperimentContext& context, const CantileverSettings& settings, const std::string& element,
             const std::string& poissons_ratio) {
  const Overrides overrides = Overrides()
                                  .set({"body", "element"}, element)
                                  .set({"body", "element_size_m"}, settings.element_size_m)
                                  .set({"body", "material", "poissons_ratio"}, std::stod(poissons_ratio));
  Scene scene = load_scene(settings.scene, context.scene_options(overrides));
  const RunReport report = run_scene(scene);
  const Simulation& simulation = *scene.simulation;
  const double sag_m = (simulation.markers().at(0).rest_position_m() - simulation.marker_position(0)).y();
  return {sag_m, simulation.body().mesh().tet_count(), report.solve};
}

// Nearer and nearer to incompressible: 1/2 - nu, so that the last decades can be distinguished.
Axis incompressibility_axis(const std::vector<ReferenceRow>& rows) {
  Axis axis;
  axis.label = "Poisson's ratio";
  axis.logarithmic = true;
  for (const ReferenceRow& row : rows) axis.ticks.emplace_back(0.5 - row.number("nu"), row.text("nu"));
  axis.min = 2.0 * axis.ticks.front().first;
  axis.max = 0.5 * axis.ticks.back().first;
  return axis;
}

std::vector<ReferenceRow> reference_rows(const ExperimentContext& context) {
  std::vector<ReferenceRow> rows;
  for (const ReferenceRow& row : read_reference(context.config_folder + "/reference", "r1_cantilever")) {
    if (row.text("law") == "iso") rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.number("nu") < b.number("nu"); });
  return rows;
}

}  // namespace

ExperimentResult run_cantilever_experiment(const ExperimentContext& context) {
  const CantileverSettings settings = read_cantilever_settings(context);
  const std::vector<ReferenceRow> rows = reference_rows(context);
  ExperimentResult result;
  result.title = "Sag of a 100 x 20 x 20 mm silicone bar under its own weight";
  result.table.columns = {{"Poisson's ratio"}, {"element"},      {"elements"},         {"sag [mm]"},
                          {"reference [mm]"},  {"error [%]", 2}, {"Newton iterations"}};
  Plot plot{"cantilever", result.title, incompressibility_axis(rows), {}, {}};
  plot.y = {"tip sag [mm]"};
  plot.y.min = 0.0;
  Series reference{"reference", {}, {}, SeriesStyle::dashes};
  for (const ReferenceRow& row : rows) {
    reference.x.push_back(0.5 - row.number("nu"));
    reference.y.push_back(-1e3 * row.number("tip_uy_m"));
  }
  plot.series.push_back(reference);

  double done = 0.0, worst = 0.0;
  for (const std::string& element : settings.elements) {
    Series series{element, {}, {}};
    for (const ReferenceRow& row : rows) {
      context.report(done++ / static_cast<double>(settings.elements.size() * rows.size()),
                     element + " at " + row.text("nu"));
      const Sag found = find_sag(context, settings, element, row.text("nu"));
      const double reference_m = -row.number("tip_uy_m"), error = found.sag_m / reference_m - 1.0;
      result.table.rows.push_back({row.text("nu"), element, double(found.elements), 1e3 * found.sag_m,
                                   1e3 * reference_m, 1e2 * error, double(found.solve.iterations)});
      series.x.push_back(0.5 - row.number("nu"));
      series.y.push_back(1e3 * found.sag_m);
      if (element == "quadratic") worst = std::max(worst, std::abs(error));
      if (found.solve.converged) continue;
      result.converged = false;
      result.message = element + " at " + row.text("nu") + ": " + found.solve.message;
    }
    plot.series.push_back(series);
  }
  result.plots.push_back(plot);
  result.numbers["worst_quadratic_error"] = worst;
  std::ostringstream found;
  found.precision(2);
  found << "quadratic elements stay within " << 1e2 * worst
        << " % of the reference at every Poisson's ratio; plain linear ones stiffen the more the nearer the material "
           "comes to incompressible, though the mesh is the same.";
  result.we_find = found.str();
  return result;
}

}  // namespace soft_robot_lab
