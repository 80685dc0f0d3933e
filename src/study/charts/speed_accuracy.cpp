// SPDX-License-Identifier: BSD-3-Clause
#include "speed_accuracy.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "convergence_chart.h"
#include "field_chart.h"
#include "node_costs.h"
#include "release_chart.h"
#include "speed_accuracy_plots.h"
#include "speed_claims.h"
#include "speed_ladder.h"
#include "speed_measurement.h"
#include "speed_runs_file.h"
#include "settings/reference_table.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kCantilever = "cantilever";  // the body of R6 too, and of what others measured

// The lowest frequency of a problem's body (R6); negative where the table has none.
double frequency_of(const ExperimentContext& context, const SpeedProblem& problem, const std::string& nu) {
  if (problem.name != kCantilever) return -1.0;
  for (const ReferenceRow& row : read_reference(context.config_folder + "/reference", "r6_modal")) {
    if (row.text("nu") == nu) return row.number("f1_bend_Hz");
  }
  return -1.0;
}

std::string describe(const SpeedRun& run) {
  std::ostringstream text;
  text.precision(3);
  text << run.problem << " at " << run.poissons_ratio << ", " << (run.bullet ? "Bullet, " : "") << run.rung << ", "
       << 1e3 * run.size_m << " mm, " << run.mode << ": ";
  if (run.ended) {
    text << 1e2 * run.error << " % for " << run.cost << " s";
  } else {
    text << run.message;
  }
  return text.str();
}

// What was measured before, or nothing.
const SpeedRun* find(const std::vector<SpeedRun>& known, const SpeedProblem& problem, const std::string& nu,
                     const SpeedRung& rung, double size, const std::string& mode) {
  for (const SpeedRun& run : known) {
    if (run.problem == problem.name && run.poissons_ratio == nu && run.rung == rung.name && run.bullet == rung.bullet &&
        run.mode == mode && std::abs(run.size_m - size * problem.size_m) < 1e-9)
      return &run;
  }
  return nullptr;
}

struct Climber {
  const ExperimentContext& context;
  const SpeedLadder& ladder;
  const MeasuringTools& tools;
  const std::vector<SpeedRun>& known;

  // A series grows finer until a run takes too long.
  void climb(const SpeedProblem& problem, std::size_t nu, const SpeedRung& rung, bool settled, double fraction,
             std::vector<SpeedRun>& runs) const {
    const std::string& poissons_ratio = problem.poissons_ratios[nu];
    for (const double size : rung.sizes) {
      const SpeedRun* before = find(known, problem, poissons_ratio, rung, size, settled ? "settled" : "equilibrium");
      runs.push_back(before ? *before : measure(problem, nu, rung, size, settled, tools));
      SpeedRun& run = runs.back();
      const double frequency_hz = before || settled ? -1.0 : frequency_of(context, problem, poissons_ratio);
      if (frequency_hz > 0.0)
        run.frequency_error = measure_frequency(problem, poissons_ratio, rung, size, frequency_hz, tools);
      if (!before) context.report(fraction, describe(run));
      if (run.cpu_s > ladder.stop_after_cpu_s) break;
    }
    write_runs(context.output_folder + "/runs.json", runs);
  }
};

bool is_tried(const SpeedRung& rung, const SpeedProblem& problem, const MeasuringTools& tools) {
  if (rung.bullet && tools.bullet.empty()) return false;
  return rung.problems.empty() || std::count(rung.problems.begin(), rung.problems.end(), problem.name) > 0;
}

std::vector<SpeedRun> run_all(const Climber& climber) {
  std::vector<SpeedRun> runs;
  double done = 0.0, all = 0.0;
  for (const SpeedProblem& problem : climber.ladder.problems)
    all += static_cast<double>(problem.poissons_ratios.size() * climber.ladder.rungs.size());
  for (const SpeedProblem& problem : climber.ladder.problems) {
    for (std::size_t nu = 0; nu < problem.poissons_ratios.size(); ++nu) {
      for (const SpeedRung& rung : climber.ladder.rungs) {
        const double fraction = done++ / all;
        if (!is_tried(rung, problem, climber.tools)) continue;
        if (rung.settled) climber.climb(problem, nu, rung, true, fraction, runs);
        if (rung.equilibrium) climber.climb(problem, nu, rung, false, fraction, runs);
      }
    }
  }
  judge_equilibria(runs);
  return runs;
}

std::vector<SpeedRun> read_known(const SpeedAccuracyOptions& options) {
  std::vector<SpeedRun> known;
  for (const std::string& file : options.reuse) {
    for (SpeedRun& run : read_runs(file)) {
      if (run.bullet || !options.reuse_bullet_only) known.push_back(std::move(run));
    }
  }
  return known;
}

Table table_of(const std::vector<SpeedRun>& runs) {
  Table table;
  table.columns = {{"problem"},
                   {"Poisson's ratio"},
                   {"question"},
                   {"method"},
                   {"size [mm]"},
                   {"elements"},
                   {"nodes"},
                   {"error [%]", 3},
                   {"cost [s]", 3},
                   {"iterations", 3},
                   {"frequency error [%]", 2},
                   {"remark"}};
  for (const SpeedRun& run : runs) {
    const auto cell = [](bool there, double value) { return there ? TableCell(value) : TableCell(std::string()); };
    table.rows.push_back({run.problem, run.poissons_ratio, run.mode, (run.bullet ? "Bullet, " : "") + run.rung,
                          1e3 * run.size_m, double(run.elements), double(run.nodes), cell(run.ended, 1e2 * run.error),
                          cell(run.ended, run.cost), cell(!run.bullet, run.iterations),
                          cell(run.frequency_error >= 0.0, 1e2 * run.frequency_error), run.message});
  }
  return table;
}

void add_plots(const SpeedLadder& ladder, const std::vector<SpeedRun>& runs, std::vector<Plot>& plots) {
  const auto add = [&](Plot plot) {
    if (!plot.series.empty()) plots.push_back(std::move(plot));
  };
  for (const SpeedProblem& problem : ladder.problems) {
    for (const std::string mode : {"settled", "equilibrium"}) {
      for (const std::string& nu : problem.poissons_ratios) add(plot_speed_accuracy(ladder, problem, nu, runs, mode));
    }
  }
}

nlohmann::ordered_json releases_json(const std::vector<ReleaseRun>& releases) {
  auto json = nlohmann::ordered_json::array();
  for (const ReleaseRun& run : releases) {
    json.push_back({{"integrator", run.rung},
                    {"time_step_s", run.step_s},
                    {"largest_error_percent", 1e2 * run.error},
                    {"first_minimum_error_percent", 1e2 * run.minimum_error},
                    {"period_error_percent", 1e2 * run.period_error},
                    {"cpu_s_per_simulated_s", run.cost}});
  }
  return json;
}

// What the chart has so far.
struct Chart {
  const ExperimentContext& context;
  const SpeedLadder& ladder;
  const MeasuringTools& tools;
  ExperimentResult& result;

  void add_errors(const std::vector<SpeedRun>& runs) {
    result.table = table_of(runs);
    add_plots(ladder, runs, result.plots);
    const SpeedClaims claims = check_claims(ladder, runs);
    result.numbers = claims.numbers;
    result.we_find = claims.words;
    for (const SpeedRun& run : runs) {
      if (!run.bullet && !run.ended)
        fail(run.problem + " at " + run.poissons_ratio + ", " + run.rung + ": " + run.message);
    }
  }

  void add_convergence(bool quick) {
    context.report(1.0, "convergence");
    const std::vector<ConvergenceSeries> convergence = run_convergence(context, ladder, quick);
    for (Plot& plot : plot_convergence(convergence)) result.plots.push_back(std::move(plot));
    result.numbers["convergence"] = convergence_json(convergence);
    context.report(1.0, "release");
    const std::vector<ReleaseRun> releases = run_releases(context, ladder.release);
    result.plots.push_back(plot_releases(releases));
    result.numbers["release"] = releases_json(releases);
  }

  void add_nodes() {
    const std::vector<SpeedRun> runs = run_node_costs(context, ladder.nodes, tools);
    for (Plot& plot : plot_node_costs(ladder.nodes, runs)) result.plots.push_back(std::move(plot));
    result.numbers["cost_of_nodes"] = node_costs_json(ladder.nodes, runs);
  }

  std::vector<MotionRun> add_motion() {
    std::vector<MotionRun> runs = run_motion(context, ladder.motion);
    result.plots.push_back(plot_motion(ladder.motion, runs));
    result.numbers["motion"] = motion_json(runs);
    return runs;
  }

  void add_rollouts() {
    const std::vector<RolloutRate> rates = run_rollouts(context, ladder.rollouts);
    result.plots.push_back(plot_rollouts(ladder.rollouts, rates));
    result.numbers["rollouts"] = rollouts_json(ladder.rollouts, rates);
  }

  void add_field(const std::vector<SpeedRun>& runs, const std::vector<MotionRun>& motion) {
    const std::string& ratio = ladder.problems.front().poissons_ratios.front();
    const std::vector<FieldPoint> points = field_points(runs, ratio, motion, ladder.published);
    result.plots.push_back(plot_field(points));
    result.numbers["field"] = field_json(points);
  }

 private:
  void fail(const std::string& what) {
    result.converged = false;
    result.message += what + "; ";
  }
};

bool wants(const SpeedAccuracyOptions& options, const std::string& part) {
  return options.parts.empty() || std::count(options.parts.begin(), options.parts.end(), part) > 0;
}

void require_known_parts(const SpeedAccuracyOptions& options) {
  const std::vector<std::string> known = speed_parts();
  for (const std::string& part : options.parts) {
    if (std::count(known.begin(), known.end(), part) == 0)
      throw std::invalid_argument("unknown part '" + part + "'; known: " + join(known));
  }
}

}  // namespace

std::vector<std::string> speed_parts() { return {"errors", "convergence", "nodes", "motion", "rollouts"}; }

ExperimentResult run_speed_accuracy(const ExperimentContext& context, const SpeedAccuracyOptions& options) {
  require_known_parts(options);
  SpeedLadder ladder = read_speed_ladder(context);
  ladder = choose_problems(std::move(ladder), options.problems, options.poissons_ratios);
  if (options.quick) ladder = quick_part(std::move(ladder));
  const MeasuringTools tools{context.mesher, options.bullet_program, ladder.time_step_s, ladder.judged_s,
                             10.0 * ladder.stop_after_cpu_s};
  const std::vector<SpeedRun> known = read_known(options);
  ExperimentResult result;
  result.title = "Error against CPU time";
  Chart chart{context, ladder, tools, result};
  const std::vector<SpeedRun> runs =
      wants(options, "errors") ? run_all({context, ladder, tools, known}) : std::vector<SpeedRun>{};
  if (wants(options, "errors")) chart.add_errors(runs);
  const bool cantilever = ladder.problems.front().name == kCantilever;
  if (cantilever && wants(options, "convergence")) chart.add_convergence(options.quick);
  if (cantilever && wants(options, "nodes")) chart.add_nodes();
  const std::vector<MotionRun> motion = wants(options, "motion") ? chart.add_motion() : std::vector<MotionRun>{};
  if (wants(options, "rollouts")) chart.add_rollouts();
  if (!motion.empty()) chart.add_field(runs, motion);
  return result;
}

}  // namespace soft_robot_lab
