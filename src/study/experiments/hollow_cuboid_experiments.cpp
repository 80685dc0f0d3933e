// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "chamber_experiments.h"
#include "chamber_run.h"
#include "settings/reference_table.h"

namespace soft_robot_lab {
namespace {

struct Reference {
  double beta, growth, gauge_pressure_pa;  // growth: V / V0
};

// Reference R4 at the robot's Poisson's ratio.
std::vector<Reference> read_r4(const ExperimentContext& context, double poissons_ratio) {
  std::vector<Reference> found;
  for (const ReferenceRow& row : read_reference(context.config_folder + "/reference", "r4_chamber")) {
    if (row.text("law") != "iso" || std::abs(row.number("nu") - poissons_ratio) > 1e-9) continue;
    found.push_back({row.number("beta"), row.number("V_over_V0"), row.number("P_gauge_Pa")});
  }
  std::sort(found.begin(), found.end(), [](const Reference& a, const Reference& b) { return a.beta < b.beta; });
  return found;
}

std::optional<Reference> at(const std::vector<Reference>& references, double beta) {
  for (const Reference& reference : references)
    if (std::abs(reference.beta - beta) < 1e-9) return reference;
  return std::nullopt;
}

double growth(const ChamberState& state) { return *state.chamber.volume_m3 / *state.chamber.initial_volume_m3; }

void add_rows(const ChamberRun& run, const std::vector<Reference>& references, double source_beta, Table& table,
              double& worst_pressure) {
  for (const ChamberState& state : run.states) {
    const double pressure_pa = *state.chamber.gauge_pressure_pa;
    std::vector<TableCell> row = {state.beta,
                                  state.beta == source_beta ? "the source's" : "ours, further",
                                  run.mesh,
                                  double(run.simulation().body().mesh().node_count()),
                                  1e6 * *state.chamber.volume_m3,
                                  growth(state),
                                  1e2 * (growth(state) - 1.0) / (state.beta - 1.0),
                                  pressure_pa};
    const std::optional<Reference> reference = at(references, state.beta);
    const double error = reference ? pressure_pa / reference->gauge_pressure_pa - 1.0 : 0.0;
    row.emplace_back(reference ? TableCell(1e2 * (growth(state) / reference->growth - 1.0)) : "");
    row.emplace_back(reference ? TableCell(1e2 * error) : "");
    row.emplace_back(double(state.solve.inverted_elements));
    row.emplace_back(state.gas_residual);
    table.rows.push_back(row);
    worst_pressure = std::max(worst_pressure, std::abs(error));
  }
}

Plot volume_plot(const std::string& name, const std::vector<ChamberRun>& runs, const std::vector<Reference>& references,
                 double least, double most) {
  Plot plot{name + "_volume", "Hollow cuboid: volume over gas", {}, {}, {}};
  plot.x.label = "beta: amount of gas over the initial amount";
  plot.y.label = "V / V0";
  Series expected{"V = beta V0, as the source expects", {least, most}, {least, most}, SeriesStyle::dashes};
  Series reference{"reference R4", {}, {}, SeriesStyle::points};
  for (const Reference& r : references) {
    if (r.beta < least || r.beta > most) continue;
    reference.x.push_back(r.beta);
    reference.y.push_back(r.growth);
  }
  for (const ChamberRun& run : runs) {
    Series series{run.mesh + " mesh", {1.0}, {1.0}};
    for (const ChamberState& state : run.states) {
      series.x.push_back(state.beta);
      series.y.push_back(growth(state));
    }
    plot.series.push_back(series);
  }
  plot.series.push_back(expected);
  if (!reference.x.empty()) plot.series.push_back(reference);
  return plot;
}

Plot pressure_plot(const std::string& name, const std::vector<ChamberRun>& runs) {
  Plot plot{name + "_pressure", "Hollow cuboid: gauge pressure over gas", {}, {}, {}};
  plot.x.label = "beta: amount of gas over the initial amount";
  plot.y.label = "gauge pressure [kPa]";
  for (const ChamberRun& run : runs) {
    Series series{run.mesh + " mesh", {1.0}, {0.0}};
    for (const ChamberState& state : run.states) {
      series.x.push_back(state.beta);
      series.y.push_back(1e-3 * *state.chamber.gauge_pressure_pa);
    }
    plot.series.push_back(series);
  }
  return plot;
}

// What the source measures in its chamber, and wants to come to.
struct SourceVolumes {
  double initial_m3, wanted_m3;
};

Plot pump_plot(const std::string& name, const Pumping& pumping, double wanted_m3, bool volume) {
  Plot plot{name + (volume ? "_volume_in_time" : "_pressure_in_time"),
            std::string("Hollow cuboid pumped by 0.01 a step: ") + (volume ? "volume" : "pressure") + " in time",
            {},
            {},
            {}};
  plot.x.label = "time [s]";
  plot.x.max = pumping.time_s.back();
  plot.y.label = volume ? "volume [ml]" : "gauge pressure [Pa]";
  Series ours{"ours", pumping.time_s, {}, SeriesStyle::lines};
  for (const double value : volume ? pumping.volume_m3 : pumping.gauge_pressure_pa)
    ours.y.push_back(volume ? 1e6 * value : value);
  const double expected = volume ? 1e6 * wanted_m3 : 0.0;
  const Series source{"what the source expects at the end, and reports",
                      {pumping.time_s.front(), pumping.time_s.back()},
                      {expected, expected},
                      SeriesStyle::dashes};
  plot.series = {ours, source};
  return plot;
}

// How far two neighbouring walls of the chamber have moved outwards, in the middle.
Eigen::Vector2d walls_m(const ChamberRun& run, const ChamberState& state, const Eigen::Matrix3Xd& rest_markers_m) {
  const int x = run.simulation().marker_index("wall_x"), y = run.simulation().marker_index("wall_y");
  const Eigen::Matrix3Xd moved_m = state.markers_m - rest_markers_m;
  return {moved_m(0, x), moved_m(1, y)};
}

std::string words(const std::vector<ChamberRun>& runs, const Pumping& pumping, const SourceVolumes& source,
                  double worst_pressure, double residual) {
  std::ostringstream text;
  const ChamberState& pumped = pumping.run.states.back();
  const Eigen::Vector2d walls_mm = 1e3 * walls_m(pumping.run, pumped, pumping.run.states.front().markers_m);
  text.precision(6);
  text << "Pumped to beta " << pumped.beta << " the volume ends at " << *pumped.chamber.volume_m3 << " m^3, not at "
       << source.wanted_m3 << " m^3: the wall holds it back by a gauge pressure of ";
  text.precision(3);
  text << *pumped.chamber.gauge_pressure_pa << " Pa, and only " << 1e2 * (growth(pumped) - 1.0) / (pumped.beta - 1.0)
       << " % of the change come about. V = beta V0 at no pressure, which the source expects, forgets the wall. Two "
          "neighbouring walls move outwards by "
       << walls_mm.x() << " and " << walls_mm.y() << " mm: evenly. On the " << runs.back().mesh
       << " mesh the pressure lies within " << 1e2 * worst_pressure
       << " % of the reference R4 wherever there is one. p V = beta P0 V0 closes to " << residual << ".";
  return text.str();
}

void add_pumping(const std::string& name, const Pumping& pumping, const SourceVolumes& source,
                 ExperimentResult& result) {
  const ChamberState& end = pumping.run.states.back();
  const Eigen::Vector2d walls = walls_m(pumping.run, end, pumping.run.states.front().markers_m);
  result.numbers["pumped"] = {{"beta", end.beta},
                              {"initial_volume_m3", *end.chamber.initial_volume_m3},
                              {"volume_m3", *end.chamber.volume_m3},
                              {"source_initial_volume_m3", source.initial_m3},
                              {"source_volume_m3", source.wanted_m3},
                              {"gauge_pressure_pa", *end.chamber.gauge_pressure_pa},
                              {"walls_m", {walls.x(), walls.y()}},
                              {"time_s", pumping.time_s},
                              {"volumes_m3", pumping.volume_m3},
                              {"gauge_pressures_pa", pumping.gauge_pressure_pa}};
  for (const bool volume : {true, false}) result.plots.push_back(pump_plot(name, pumping, source.wanted_m3, volume));
}

ExperimentResult run_cuboid(const ExperimentContext& context, const std::string& name, const std::string& title,
                            const SourceVolumes& source) {
  ExperimentResult result;
  result.title = title;
  result.table.columns = {{"beta"},
                          {"whose"},
                          {"mesh"},
                          {"nodes", 6},
                          {"volume [ml]", 6},
                          {"V / V0"},
                          {"share of beta V0 - V0 [%]", 3},
                          {"pressure [Pa]"},
                          {"V off R4 [%]", 2},
                          {"p off R4 [%]", 2},
                          {"inverted"},
                          {"gas residual", 2}};
  const ChamberSettings settings = read_chamber_settings(context, name);
  if (!settings.pump) throw std::invalid_argument(context.settings_file(name) + ": pump is missing");
  const Pumping pumping = pump_chamber(context, settings, result);
  const std::vector<ChamberRun> runs = run_chambers(context, settings, result);
  const std::vector<Reference> references =
      read_r4(context, runs.front().simulation().body().material().poissons_ratio);
  double worst_pressure = 0.0;
  for (const ChamberRun& run : runs) {
    worst_pressure = 0.0;
    add_rows(run, references, settings.pump->beta, result.table, worst_pressure);
    result.numbers["worst_pressure_error"][run.mesh] = worst_pressure;
    result.numbers["volume_m3"][run.mesh] = *run.states.front().chamber.volume_m3;
  }
  add_pumping(name, pumping, source, result);
  double least = 1.0, most = 1.0;
  for (const ChamberMesh& mesh : settings.meshes) {
    for (const double beta : mesh.betas) {
      least = std::min(least, beta);
      most = std::max(most, beta);
    }
  }
  result.plots.push_back(volume_plot(name, runs, references, least, most));
  result.plots.push_back(pressure_plot(name, runs));
  result.numbers["gas_residual"] = worst_gas_residual(runs);
  result.we_differ =
      "The outside and the walls of 5 mm are ours, for the source gives the chamber's volume only; time steps of 1/60 "
      "s, "
      "which it does not give either; betas beyond its own, marked as ours, are rest states.";
  result.we_find = words(runs, pumping, source, worst_pressure, worst_gas_residual(runs));
  return result;
}

}  // namespace

ExperimentResult run_inflation_experiment(const ExperimentContext& context) {
  ExperimentResult result =
      run_cuboid(context, "5.3.1", "Inflation of the hollow cuboid, chamber of 23.6531 ml", {2.36531e-5, 2.60184e-5});
  result.source_reports =
      "Both ends held, no gravity, P0 101 kPa, beta raised to 1.10 by 0.01 a step: the volume of 2.36531e-5 m^3 is to "
      "become 2.60184e-5 m^3 and the pressure to be 0 again, and its curves are said to do so. The cuboid expands "
      "mainly in "
      "one direction, the other three sides hardly, for which elongated triangles of the chamber's mesh are blamed.";
  return result;
}

ExperimentResult run_deflation_experiment(const ExperimentContext& context) {
  ExperimentResult result =
      run_cuboid(context, "5.3.2", "Deflation of the hollow cuboid, chamber of 23.6531 ml", {2.36531e-5, 2.30618e-5});
  result.source_reports =
      "The same cuboid at beta 0.975: the volume of 2.36531e-5 m^3 is to become 2.30618e-5 m^3 and the pressure to be "
      "0 "
      "again, and its curves are said to do so. All walls are drawn evenly towards the centre.";
  return result;
}

}  // namespace soft_robot_lab
