#include <cmath>
#include <sstream>

#include "experiment/chamber_experiments.h"
#include "experiment/chamber_run.h"

namespace soft_robot_lab {
namespace {

const char* const kTip = "tip";

void add_rows(const ChamberRun& run, Table& table) {
  for (const ChamberState& state : run.states) {
    const Eigen::Vector3d tip_mm = 1e3 * run.moved_m(state, kTip);
    table.rows.push_back({state.beta, run.mesh, double(run.simulation().body().mesh().node_count()),
                          *state.chamber.volume_m3 / *state.chamber.initial_volume_m3, *state.chamber.gauge_pressure_pa,
                          tip_mm.x(), tip_mm.y(), double(state.solve.inverted_elements), state.gas_residual});
  }
}

Plot path_plot(const std::vector<ChamberRun>& runs) {
  Plot plot{"6.3.4_tip", "Bubblefinger: way of the tip from its rest under gravity", {}, {}, {}};
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

Plot shape_plot(const ChamberRun& run) {
  Plot plot{"6.3.4_shape", "Bubblefinger from the side, " + run.mesh + " mesh", {}, {}, {}};
  plot.x.label = "x [mm]";
  plot.y.label = "y [mm]";
  for (const ChamberState* state : {&run.states.front(), &run.states.back()}) {
    std::ostringstream label;
    label << "skin at beta " << state->beta;
    plot.series.push_back(skin(run, *state, 0, 1, label.str()));
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
    text << "On the " << run.mesh << " mesh the finger bends " << direction(run) << ", its tip by "
         << 1e3 * run.moved_m(run.states.back(), kTip).norm() << " mm. ";
  text << "At the last beta the meshes differ by " << 1e2 * difference
       << " % of the tip's travel. The wedges leave the top of the chamber thin and folded, so it stretches under "
          "pressure, while the strip below is straight and keeps its length: the longer top bends the finger down, "
          "with gravity. Elements that do not lock find the same side on every mesh. p V = beta P0 V0 closes to "
       << residual << ".";
  return text.str();
}

}  // namespace

ExperimentResult run_bubblefinger_experiment(const ExperimentContext& context) {
  ExperimentResult result;
  result.title = "Bubblefinger inflated, wedges up";
  result.table.columns = {{"beta"},       {"mesh"},       {"nodes", 6}, {"V / V0"},         {"pressure [Pa]"},
                          {"tip x [mm]"}, {"tip y [mm]"}, {"inverted"}, {"gas residual", 2}};
  const std::vector<ChamberRun> runs = run_chambers(context, read_chamber_settings(context, "6.3.4"), result);
  for (const ChamberRun& run : runs) {
    add_rows(run, result.table);
    result.numbers["bends_down_m"][run.mesh] = -run.moved_m(run.states.back(), kTip).y();
  }
  const Eigen::Vector3d first_m = runs.front().moved_m(runs.front().states.back(), kTip);
  const Eigen::Vector3d last_m = runs.back().moved_m(runs.back().states.back(), kTip);
  const double difference = (first_m - last_m).norm() / last_m.norm();
  result.numbers["tip_difference"] = difference;
  result.numbers["gas_residual"] = worst_gas_residual(runs);
  result.plots = {path_plot(runs), shape_plot(runs.back())};
  result.source_reports =
      "The source inflates the finger to beta 2.57 on a coarse and a fine mesh; no number of it is known here.";
  result.we_find = words(runs, difference, worst_gas_residual(runs));
  return result;
}

}  // namespace soft_robot_lab
