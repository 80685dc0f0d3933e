// SPDX-License-Identifier: BSD-3-Clause
#include "speed_accuracy_plots.h"

#include <algorithm>

#include "plot_series.h"

namespace soft_robot_lab {
namespace {

constexpr double kSmallest_percent = 1.0e-3;  // errors below are drawn here: the references are no better

double percent(double error) { return std::max(1.0e2 * error, kSmallest_percent); }

void add_bullet(Plot& plot, const std::vector<SpeedRun>& runs) {
  const std::vector<SpeedRun> best = best_of(runs);
  if (best.empty()) return;
  Series& series = series_of(plot, "Bullet, best of all settings");
  series.style = SeriesStyle::dashes_points;
  for (const SpeedRun& run : best) {
    series.x.push_back(run.cost);
    series.y.push_back(percent(run.error));
  }
}

void add_chance_hits(Plot& plot, const std::vector<SpeedRun>& runs) {
  for (const SpeedRun& run : runs) {
    if (run.own_equilibrium) continue;
    Series& series = series_of(plot, "Bullet, not at its own rest state");
    series.style = SeriesStyle::points;
    series.x.push_back(run.cost);
    series.y.push_back(percent(run.error));
  }
}

void add_elsewhere(Plot& plot, const SpeedLadder& ladder, const std::string& poissons_ratio) {
  for (const ElsewherePoint& point : ladder.elsewhere) {
    if (point.poissons_ratio != poissons_ratio || !point.cost) continue;
    Series& series = series_of(plot, point.name + ", elsewhere");
    series.style = SeriesStyle::points;
    series.x.push_back(*point.cost);
    series.y.push_back(point.error_percent);
  }
}

}  // namespace

Plot plot_speed_accuracy(const SpeedLadder& ladder, const SpeedProblem& problem, const std::string& poissons_ratio,
                         const std::vector<SpeedRun>& runs, const std::string& mode) {
  const bool settled = mode == "settled";
  Plot plot{(settled ? "speed_accuracy_" : "equilibrium_") + problem.name + "_" + poissons_ratio,
            problem.title + ", Poisson's ratio " + poissons_ratio,
            {},
            {}};
  plot.x = {settled ? "CPU-seconds per simulated second, 60 Hz" : "CPU-seconds per equilibrium", true};
  plot.y = {"error of the displacement [%]", true};
  plot.width_px = 1100;
  if (settled) plot.x.guides = {1.0};
  plot.y.guides = {1.0};
  std::vector<SpeedRun> bullet;
  for (const SpeedRun& run : runs) {
    if (run.problem != problem.name || run.poissons_ratio != poissons_ratio || run.mode != mode || !run.ended) continue;
    if (run.bullet) {
      bullet.push_back(run);
      continue;
    }
    Series& series = series_of(plot, run.rung);
    series.x.push_back(run.cost);
    series.y.push_back(percent(run.error));
  }
  add_bullet(plot, bullet);
  add_chance_hits(plot, bullet);
  if (settled && problem.name == "cantilever") add_elsewhere(plot, ladder, poissons_ratio);
  return plot;
}

}  // namespace soft_robot_lab
