// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "chamber_experiments.h"
#include "chamber_run.h"
#include "robot/design/mesh_quality.h"

namespace soft_robot_lab {
namespace {

constexpr int kBins = 20;
constexpr double kPoor = 0.5;  // Q_vl below which the source counts an element as irregular

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

// What the source counts in its two meshes.
struct SourceMesh {
  const char* name;
  int elements, poor;
};
constexpr SourceMesh kSourceMeshes[] = {{"coarse", 16057, 15843}, {"fine", 80822, 28865}};

int count_poor(const std::vector<double>& quality) {
  return static_cast<int>(std::count_if(quality.begin(), quality.end(), [](double q) { return q < kPoor; }));
}

void add_row(const ChamberRun& run, const ChamberState& state, const std::string& how, Table& table) {
  const std::vector<double> quality = qualities(run, state);
  double mean = 0.0;
  for (const double q : quality) mean += q / static_cast<double>(quality.size());
  table.rows.push_back({how, state.beta, run.mesh, double(quality.size()),
                        *state.chamber.volume_m3 / *state.chamber.initial_volume_m3, *state.chamber.gauge_pressure_pa,
                        1e3 * bends_away_m(run, state), 1e3 * stretches_m(run, state),
                        *std::min_element(quality.begin(), quality.end()), mean, double(count_poor(quality)),
                        double(state.solve.inverted_elements), state.gas_residual});
}

nlohmann::ordered_json quality_numbers(const std::vector<ChamberRun>& runs) {
  nlohmann::ordered_json numbers;
  for (const SourceMesh& mesh : kSourceMeshes)
    numbers["source"][mesh.name] = {{"elements", mesh.elements}, {"below_half", mesh.poor}};
  for (const ChamberRun& run : runs) {
    const std::vector<double> rest = qualities(run, run.states.front()), full = qualities(run, run.states.back());
    numbers["ours"][run.mesh] = {
        {"elements", rest.size()}, {"below_half", count_poor(rest)}, {"below_half_inflated", count_poor(full)}};
  }
  return numbers;
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
  Plot plot = outline_plot(run, "6.3.5_shape", "Bubblebot from the side, by its edges, " + run.mesh + " mesh", 1, 2);
  plot.height_px = plot.width_px;
  return plot;
}

Plot pump_plot(const Pumping& pumping) {
  Plot plot{"6.3.5_in_time", "Bubblebot's chamber pumped by 0.01 a step of 0.0016 s", {}, {}, {}};
  plot.x.label = "time [s]";
  plot.y.label = "V / V0";
  Series volume{"volume, " + pumping.run.mesh + " mesh", pumping.time_s, {}, SeriesStyle::lines};
  for (const double volume_m3 : pumping.volume_m3) volume.y.push_back(volume_m3 / pumping.volume_m3.front());
  plot.series = {volume};
  return plot;
}

void describe_quality(const ChamberRun& run, std::ostream& text) {
  const std::vector<double> rest = qualities(run, run.states.front()), full = qualities(run, run.states.back());
  text << "On the " << run.mesh << " mesh " << count_poor(rest) << " of " << rest.size()
       << " elements have Q_vl below 0.5 at rest and " << count_poor(full) << " inflated. ";
}

int inverted(const std::vector<ChamberRun>& runs) {
  int count = 0;
  for (const ChamberRun& run : runs)
    for (const ChamberState& state : run.states) count += state.solve.inverted_elements;
  return count;
}

std::string words(const std::vector<ChamberRun>& runs, const Pumping& pumping, double difference, double residual) {
  std::ostringstream text;
  text.precision(3);
  const ChamberRun& run = runs.back();
  const ChamberState &last = run.states.back(), &pumped = pumping.run.states.back();
  text << "At beta " << last.beta << " the side of chamber " << last.chamber.name << " is "
       << 1e3 * stretches_m(run, last) << " mm longer, and the tip lies " << 1e3 * bends_away_m(run, last)
       << " mm away from that chamber. The meshes differ by " << 1e2 * difference
       << " % of the tip's travel. Pumped in time, the chamber has "
       << pumped.chamber.volume_m3.value() / pumping.volume_m3.front() << " times its volume after "
       << pumping.time_s.back() << " s, at rest "
       << *runs.front().states.back().chamber.volume_m3 / *runs.front().states.back().chamber.initial_volume_m3
       << " times on that mesh. ";
  for (const ChamberRun& one : runs) describe_quality(one, text);
  text << inverted(runs) << " elements are inverted. p V = beta P0 V0 closes to " << residual << ".";
  return text.str();
}

}  // namespace

ExperimentResult run_bubblebot_experiment(const ExperimentContext& context) {
  ExperimentResult result;
  result.title = "One chamber of Bubblebot inflated";
  result.table.columns = {{"found by"},
                          {"beta"},
                          {"mesh"},
                          {"elements", 6},
                          {"V / V0"},
                          {"pressure [Pa]"},
                          {"tip away from chamber [mm]"},
                          {"side longer by [mm]"},
                          {"least Q_vl", 2},
                          {"mean Q_vl", 2},
                          {"Q_vl < 0.5", 6},
                          {"inverted"},
                          {"gas residual", 2}};
  const ChamberSettings settings = read_chamber_settings(context, "6.3.5");
  if (!settings.pump) throw std::invalid_argument(context.settings_file("6.3.5") + ": pump is missing");
  const Pumping pumping = pump_chamber(context, settings, result);
  add_row(pumping.run, pumping.run.states.back(), "steps in time", result.table);
  const std::vector<ChamberRun> runs = run_chambers(context, settings, result);
  for (const ChamberRun& run : runs) {
    for (const ChamberState& state : run.states) add_row(run, state, "rest state", result.table);
    result.numbers["bends_away_m"][run.mesh] = bends_away_m(run, run.states.back());
    result.numbers["stretches_m"][run.mesh] = stretches_m(run, run.states.back());
    result.plots.push_back(quality_plot(run));
  }
  result.plots.push_back(shape_plot(runs.back()));
  result.plots.push_back(pump_plot(pumping));
  const Eigen::Vector3d first_m = runs.front().moved_m(runs.front().states.back(), kTip);
  const Eigen::Vector3d last_m = runs.back().moved_m(runs.back().states.back(), kTip);
  const double difference = (first_m - last_m).norm() / last_m.norm();
  result.numbers["tip_difference"] = difference;
  result.numbers["gas_residual"] = worst_gas_residual(runs);
  result.numbers["quality"] = quality_numbers(runs);
  result.numbers["pumped_growth"] = pumping.volume_m3.back() / pumping.volume_m3.front();
  result.source_reports =
      "One chamber, P0 101 kPa, factor 5 (called pressure and volume in turn), time step 0.0016 s: the mesh of 16057 "
      "tetrahedra, 15843 of them with Q_vl below 0.5, moves a little the right way, that of 80822, 28865 of them "
      "below, "
      "hardly at all, and its chamber's walls turn jagged. It concludes that the number of irregular elements matters.";
  result.we_differ =
      "Walls, chambers and meshes are ours but for the chambers' volume, with quadratic elements, of which fewer do; "
      "the "
      "chambers are closed, and open below in the source; only the coarse mesh is stepped in time, by implicit Euler, "
      "and "
      "rest states are found on both.";
  result.we_find = words(runs, pumping, difference, worst_gas_residual(runs));
  return result;
}

}  // namespace soft_robot_lab
