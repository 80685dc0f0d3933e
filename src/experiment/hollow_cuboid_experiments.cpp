#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "experiment/chamber_experiments.h"
#include "experiment/chamber_run.h"
#include "soft_robot_lab/experiment/reference_table.h"

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

void add_rows(const ChamberRun& run, const std::vector<Reference>& references, Table& table, double& worst_pressure) {
  for (const ChamberState& state : run.states) {
    const double pressure_pa = *state.chamber.gauge_pressure_pa;
    std::vector<TableCell> row = {state.beta,
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

std::string words(const std::vector<ChamberRun>& runs, double worst_pressure, double residual) {
  std::ostringstream text;
  text.precision(3);
  const ChamberState& last = runs.back().states.back();
  text << "The walls resist: at beta " << last.beta << " the volume is " << growth(last) << " times the initial one, "
       << 1e2 * (growth(last) - 1.0) / (last.beta - 1.0)
       << " % of the change the source expects, and the rest of the gas shows as a gauge pressure of "
       << 1e-3 * *last.chamber.gauge_pressure_pa << " kPa. On the " << runs.back().mesh
       << " mesh the pressure lies within " << 1e2 * worst_pressure
       << " % of the reference wherever there is one. p V = beta P0 V0 closes to " << residual << ".";
  return text.str();
}

ExperimentResult run_cuboid(const ExperimentContext& context, const std::string& name, const std::string& title) {
  ExperimentResult result;
  result.title = title;
  result.table.columns = {{"beta"},
                          {"mesh"},
                          {"nodes", 6},
                          {"volume [ml]", 5},
                          {"V / V0"},
                          {"share of beta V0 - V0 [%]", 3},
                          {"pressure [Pa]"},
                          {"V off R4 [%]", 2},
                          {"p off R4 [%]", 2},
                          {"inverted"},
                          {"gas residual", 2}};
  const ChamberSettings settings = read_chamber_settings(context, name);
  const std::vector<ChamberRun> runs = run_chambers(context, settings, result);
  const std::vector<Reference> references =
      read_r4(context, runs.front().simulation().body().material().poissons_ratio);
  double worst_pressure = 0.0;
  for (const ChamberRun& run : runs) {
    worst_pressure = 0.0;
    add_rows(run, references, result.table, worst_pressure);
    result.numbers["worst_pressure_error"][run.mesh] = worst_pressure;
  }
  const auto [least, most] = std::minmax_element(settings.betas.begin(), settings.betas.end());
  result.plots = {volume_plot(name, runs, references, std::min(1.0, *least), std::max(1.0, *most)),
                  pressure_plot(name, runs)};
  result.numbers["gas_residual"] = worst_gas_residual(runs);
  result.source_reports =
      "The source expects the chamber's volume to become beta times the initial one; it is quoted here without "
      "numbers.";
  result.we_find = words(runs, worst_pressure, worst_gas_residual(runs));
  return result;
}

}  // namespace

ExperimentResult run_inflation_experiment(const ExperimentContext& context) {
  return run_cuboid(context, "5.3.1", "Inflation of the hollow cuboid, chamber of 23.6531 ml");
}

ExperimentResult run_deflation_experiment(const ExperimentContext& context) {
  return run_cuboid(context, "5.3.2", "Deflation of the hollow cuboid, chamber of 23.6531 ml");
}

}  // namespace soft_robot_lab
