#include "soft_robot_lab/experiment/speed_accuracy.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "experiment/release_chart.h"
#include "experiment/speed_accuracy_plots.h"
#include "experiment/speed_claims.h"
#include "experiment/speed_ladder.h"
#include "experiment/speed_measurement.h"
#include "soft_robot_lab/experiment/reference_table.h"

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

// A series grows finer until a run takes too long.
void climb(const ExperimentContext& context, const SpeedLadder& ladder, const SpeedProblem& problem, std::size_t nu,
           const SpeedRung& rung, bool settled, const MeasuringTools& tools, double share,
           std::vector<SpeedRun>& runs) {
  const std::string& poissons_ratio = problem.poissons_ratios[nu];
  const double frequency_hz = frequency_of(context, problem, poissons_ratio);
  for (const double size : rung.sizes) {
    SpeedRun run = measure(problem, nu, rung, size, settled, tools);
    if (frequency_hz > 0.0 && !rung.bullet && !settled)
      run.frequency_error = measure_frequency(problem, poissons_ratio, rung, size, frequency_hz, tools);
    context.tell(share, describe(run));
    runs.push_back(run);
    if (run.cpu_s > ladder.stop_after_cpu_s) return;
  }
}

bool is_tried(const SpeedRung& rung, const SpeedProblem& problem, const MeasuringTools& tools) {
  if (rung.bullet && tools.bullet.empty()) return false;
  return rung.problems.empty() || std::count(rung.problems.begin(), rung.problems.end(), problem.name) > 0;
}

std::vector<SpeedRun> run_all(const ExperimentContext& context, const SpeedLadder& ladder,
                              const MeasuringTools& tools) {
  std::vector<SpeedRun> runs;
  double done = 0.0, all = 0.0;
  for (const SpeedProblem& problem : ladder.problems)
    all += static_cast<double>(problem.poissons_ratios.size() * ladder.rungs.size());
  for (const SpeedProblem& problem : ladder.problems) {
    for (std::size_t nu = 0; nu < problem.poissons_ratios.size(); ++nu) {
      for (const SpeedRung& rung : ladder.rungs) {
        const double share = done++ / all;
        if (!is_tried(rung, problem, tools)) continue;
        if (rung.settled) climb(context, ladder, problem, nu, rung, true, tools, share, runs);
        if (rung.equilibrium) climb(context, ladder, problem, nu, rung, false, tools, share, runs);
      }
    }
  }
  return runs;
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
    add(plot_convergence(problem, runs));
    add(plot_cost_of_nodes(problem, runs));
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

}  // namespace

ExperimentResult run_speed_accuracy(const ExperimentContext& context, const SpeedAccuracyOptions& options) {
  SpeedLadder ladder = read_speed_ladder(context);
  ladder = choose_problems(std::move(ladder), options.problems);
  if (options.quick) ladder = quick_part(std::move(ladder));
  MeasuringTools tools{context.mesher, options.bullet_program, ladder.time_step_s, ladder.judged_s,
                       4.0 * ladder.stop_after_cpu_s};
  const std::vector<SpeedRun> runs = run_all(context, ladder, tools);

  ExperimentResult result;
  result.title = "Error against CPU time";
  result.table = table_of(runs);
  add_plots(ladder, runs, result.plots);
  const SpeedClaims claims = check_claims(ladder, runs);
  result.numbers = claims.numbers;
  result.we_find = claims.words;
  if (ladder.problems.front().name == kCantilever) {
    context.tell(1.0, "release");
    const std::vector<ReleaseRun> releases = run_releases(context, ladder.release);
    result.plots.push_back(plot_releases(releases));
    result.numbers["release"] = releases_json(releases);
  }
  for (const SpeedRun& run : runs) {
    if (run.bullet || run.ended) continue;
    result.converged = false;
    result.message += run.problem + " at " + run.poissons_ratio + ", " + run.rung + ": " + run.message + "; ";
  }
  return result;
}

}  // namespace soft_robot_lab
