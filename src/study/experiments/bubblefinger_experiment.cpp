// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <sstream>

#include "chamber_experiments.h"
#include "chamber_run.h"

namespace soft_robot_lab {
namespace {

void add_rows(const ChamberRun& run, Table& table) {
  for (const ChamberState& state : run.states) {
    const Eigen::Vector3d tip_mm = 1e3 * run.moved_m(state, kTip);
    table.rows.push_back({state.beta, run.mesh, double(run.simulation().body().mesh().node_count()),
                          *state.chamber.volume_m3 / *state.chamber.initial_volume_m3, *state.chamber.gauge_pressure_pa,
                          tip_mm.x(), tip_mm.y(), double(state.solve.inverted_elements), state.gas_residual});
  }
}

Plot path_plot(const std::vector<ChamberRun>& runs) {
  Plot plot{"6.3.4_tip", "Bubblefinger, without gravity: way of the tip", {}, {}, {}};
  plot.x.label = "along the finger [mm]";
  plot.y.label = "up, where the wedges open [mm]";
  for (const ChamberRun& run : runs) {
    Series series{run.mesh + " mesh", {}, {}};
    for (const ChamberState& state : run.states) {
      series.x.push_back(1e3 * run.moved_m(state, kTip).x());
      series.y.push_back(1e3 * run.moved_m(state, kTip).y());
    }
    plot.series.push_back(series);
  }
  return plot;
}

std::string direction(const ChamberRun& run) {
  return run.moved_m(run.states.back(), kTip).y() < 0.0 ? "away from the wedges' opening"
                                                        : "towards the wedges' opening";
}

std::string words(const std::vector<ChamberRun>& runs, double difference, double residual) {
  std::ostringstream text;
  text.precision(3);
  for (const ChamberRun& run : runs)
    text << "On the " << run.mesh << " mesh, at beta " << run.states.back().beta << ", the finger bends "
         << direction(run) << ", its tip by " << 1e3 * run.moved_m(run.states.back(), kTip).norm() << " mm, and "
         << run.states.back().solve.inverted_elements << " elements are inverted. ";
  text << "At the largest beta that both have the meshes differ by " << 1e2 * difference
       << " % of the tip's travel. The wedges leave the top of the chamber thin and folded, so it stretches under "
          "pressure, while the strip below is straight and keeps its length: the longer top bends the finger down. "
          "Elements that do not lock, and gas that is solved with the body, find the same side on every mesh. "
          "p V = beta P0 V0 closes to "
       << residual << ".";
  return text.str();
}

// The tips' distance over their travel, at the last beta that both runs have.
double tip_difference(const ChamberRun& one, const ChamberRun& other) {
  double difference = 0.0;
  for (const ChamberState& state : one.states) {
    for (const ChamberState& same : other.states) {
      if (state.beta != same.beta || state.beta == one.states.front().beta) continue;
      const Eigen::Vector3d there_m = other.moved_m(same, kTip);
      difference = (one.moved_m(state, kTip) - there_m).norm() / there_m.norm();
    }
  }
  return difference;
}

}  // namespace

ExperimentResult run_bubblefinger_experiment(const ExperimentContext& context) {
  ExperimentResult result;
  result.title = "Bubblefinger inflated, wedges up, without gravity";
  result.table.columns = {{"beta"},       {"mesh"},       {"nodes", 6}, {"V / V0"},         {"pressure [Pa]"},
                          {"tip x [mm]"}, {"tip y [mm]"}, {"inverted"}, {"gas residual", 2}};
  const std::vector<ChamberRun> runs = run_chambers(context, read_chamber_settings(context, "6.3.4"), result);
  result.plots = {path_plot(runs)};
  for (const ChamberRun& run : runs) {
    add_rows(run, result.table);
    result.numbers["bends_down_m"][run.mesh] = -run.moved_m(run.states.back(), kTip).y();
    result.plots.push_back(outline_plot(run, "6.3.4_shape_" + run.mesh,
                                        "Bubblefinger from the side, by its edges, " + run.mesh + " mesh", 0, 1));
  }
  const double difference = tip_difference(runs.front(), runs.back());
  result.numbers["tip_difference"] = difference;
  result.numbers["gas_residual"] = worst_gas_residual(runs);
  result.source_reports =
      "P0 1e5 Pa, no gravity, wedges on top, filled slowly by a factor of about 2.5: with a coarse mesh of the chamber "
      "(beta 2.57) the finger bends down, as expected, with a fine one (beta 2.45) up, while the chamber's triangles "
      "oscillate. Both runs end soon after in inverted triangles, for which the time step is blamed.";
  result.we_differ =
      "All dimensions and the two meshes (quadratic, throughout the body, not on the chamber's surface alone) are "
      "ours, "
      "for the source gives none; each beta is a rest state reached from the one before, where the source steps in "
      "time.";
  result.we_find = words(runs, difference, worst_gas_residual(runs));
  return result;
}

}  // namespace soft_robot_lab
