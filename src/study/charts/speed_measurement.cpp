// SPDX-License-Identifier: BSD-3-Clause
#include "speed_measurement.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "robot/design/timed_process.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "settings/cpu_time.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "mechanics/simulation/modal.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kSameElements = "linear, Newton";  // the rung that solves what Bullet solves

constexpr double kWorthTelling = 0.99;
// How far curves may be apart, as small-strain and neo-Hookean elements are, and errors, which count the last moments
// too.
constexpr double kSameEquilibrium = 0.03;

Overrides overrides_of(const SpeedProblem& problem, const std::string& nu, const Overrides& more, double size,
                       const MeasuringTools& tools) {
  std::vector<OverrideValue> markers;
  for (Eigen::Index i = 0; i < problem.points_m.cols(); ++i)
    markers.emplace_back(Overrides()
                             .set({"name"}, "point_" + std::to_string(i))
                             .set({"position_m"}, Eigen::Vector3d(problem.points_m.col(i))));
  return Overrides()
      .set({"body", "element_size_m"}, size * problem.size_m)
      .set({"body", "material", "poissons_ratio"}, std::stod(nu))
      .set({"solver", "time_step_s"}, tools.time_step_s)
      .set({"markers"}, markers)
      .lay(more);
}

Scene load(const SpeedProblem& problem, const Overrides& overrides, const MeasuringTools& tools) {
  SceneOptions options;
  options.mesher = tools.mesher;
  options.actuator_factory = make_actuator;
  options.overrides = overrides;
  Scene scene = load_scene(problem.scene, options);
  for (const TimedCommands& timed : scene.run.commands)
    for (const auto& [actuator, value] : timed.commands) scene.simulation->set_command(actuator, value);
  return scene;
}

// What a problem's points should do at one Poisson's ratio.
struct Truth {
  const Eigen::Vector3d& first_m;  // by an independent method
  const Eigen::Matrix3Xd& curve_m;

  void judge(const Eigen::Matrix3Xd& moved_m, SpeedRun& run) const {
    const double first = (moved_m.col(0) - first_m).norm() / first_m.norm();
    const double all = (moved_m - curve_m).norm() / curve_m.norm();
    run.error = std::max({run.error, first, all});
    const Eigen::Matrix3Xd curve = moved_m / curve_m.norm();
    run.curve.assign(curve.data(), curve.data() + curve.size());
  }
};

Eigen::Matrix3Xd moved_m(const Simulation& simulation) {
  Eigen::Matrix3Xd moved(3, static_cast<Eigen::Index>(simulation.markers().size()));
  for (int i = 0; i < static_cast<int>(moved.cols()); ++i)
    moved.col(i) = simulation.marker_position(i) - simulation.markers()[static_cast<std::size_t>(i)].rest_position_m();
  return moved;
}

void note(SpeedRun& run, const SolveReport& report) {
  if (report.converged) return;
  run.ended = false;
  if (run.message.empty()) run.message = report.message.empty() ? "did not converge" : report.message;
}

void settle(Simulation& simulation, const SpeedProblem& problem, const Truth& truth, const MeasuringTools& tools,
            SpeedRun& run) {
  const double h = simulation.options().time_step_s;
  const int steps = static_cast<int>(std::lround(problem.duration_s / h));
  const int judged = static_cast<int>(std::lround(tools.judged_s / h));
  int active = 0, iterations = 0;
  double active_s = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double before_s = cpu_time_s();
    const SolveReport report = simulation.step();
    const double step_s = cpu_time_s() - before_s;
    run.cpu_s += step_s;
    note(run, report);
    iterations += report.iterations;
    if (report.iterations > 0) {
      ++active;
      active_s += step_s;
    }
    if (i >= steps - judged) truth.judge(moved_m(simulation), run);
  }
  run.cost = active_s / (std::max(active, 1) * h);
  run.iterations = static_cast<double>(iterations) / std::max(active, 1);
}

void find_equilibrium(Simulation& simulation, const Truth& truth, SpeedRun& run) {
  const double before_s = cpu_time_s();
  const SolveReport report = simulation.solve_equilibrium();
  run.cost = run.cpu_s = cpu_time_s() - before_s;
  note(run, report);
  run.iterations = report.iterations;
  truth.judge(moved_m(simulation), run);
}

void run_ours(const SpeedProblem& problem, const Truth& truth, const Overrides& overrides, bool settled,
              const MeasuringTools& tools, SpeedRun& run) {
  const Scene scene = load(problem, overrides, tools);
  run.nodes = scene.simulation->body().mesh().node_count();
  run.elements = scene.simulation->body().mesh().tet_count();
  run.ended = true;
  if (settled) {
    settle(*scene.simulation, problem, truth, tools, run);
  } else {
    find_equilibrium(*scene.simulation, truth, run);
  }
}

std::filesystem::path temporary_file(const std::string& ending) {
  return std::filesystem::temp_directory_path() / ("bullet_peer_" + std::to_string(getpid()) + ending);
}

// A program of its own: it may crash, and it may take for ever.
void run_bullet(const SpeedProblem& problem, const Truth& truth, const Overrides& overrides, const Overrides& settings,
                const MeasuringTools& tools, SpeedRun& run) {
  const auto result = temporary_file(".json"), errors = temporary_file(".errors");
  std::vector<std::string> command = {tools.bullet,  problem.scene,
                                      "--overrides", overrides.text(),
                                      "--settings",  settings.empty() ? "{}" : settings.text(),
                                      "--result",    result.string(),
                                      "--duration",  std::to_string(problem.duration_s),
                                      "--judged",    std::to_string(tools.judged_s),
                                      "--cpu-limit", std::to_string(tools.cpu_limit_s)};
  if (!tools.mesher.empty()) command.insert(command.end(), {"--mesher", tools.mesher});
  const ProcessEnd end = run_with_limit(command, errors.string(), 10.0 * tools.cpu_limit_s + 120.0);
  std::ostringstream words;
  words << std::ifstream(errors).rdbuf();
  std::filesystem::remove(errors);
  if (end.kind == ProcessEnd::Kind::exited && end.value == 2) throw std::runtime_error(words.str());
  if (end.kind != ProcessEnd::Kind::exited) {
    run.message = end.kind == ProcessEnd::Kind::timed_out ? "ran out of time" : "crashed";
    return;
  }
  const auto json = nlohmann::json::parse(std::ifstream(result));
  std::filesystem::remove(result);
  run.nodes = json.at("nodes");
  run.elements = json.at("elements");
  run.cpu_s = json.at("cpu_s");
  run.cost = run.cpu_s / json.at("simulated_s").get<double>();
  run.ended = json.at("ran_to_the_end");
  if (!run.ended) run.message = run.cpu_s < tools.cpu_limit_s ? "blew up" : "ran out of time";
  for (const auto& moment : json.at("displacements_m")) {
    const std::vector<double> moved = moment.get<std::vector<double>>();
    truth.judge(Eigen::Map<const Eigen::Matrix3Xd>(moved.data(), 3, problem.points_m.cols()), run);
  }
}

}  // namespace

SpeedRun measure(const SpeedProblem& problem, std::size_t poissons_ratio, const SpeedRung& rung, double size,
                 bool settled, const MeasuringTools& tools) {
  const std::string& nu = problem.poissons_ratios.at(poissons_ratio);
  const Truth truth{problem.references_m.at(poissons_ratio), problem.curves_m.at(poissons_ratio)};
  SpeedRun best;
  for (int i = 0; i < kRepeats; ++i) {
    SpeedRun run;
    run.problem = problem.name;
    run.poissons_ratio = nu;
    run.rung = rung.name;
    run.mode = settled ? "settled" : "equilibrium";
    run.bullet = rung.bullet;
    run.size_m = size * problem.size_m;
    if (rung.bullet) {
      const Overrides linear = Overrides().set({"body", "element"}, "linear");
      run_bullet(problem, truth, overrides_of(problem, nu, linear, size, tools), rung.overrides, tools, run);
    } else {
      run_ours(problem, truth, overrides_of(problem, nu, rung.overrides, size, tools), settled, tools, run);
    }
    if (i == 0 || run.cost < best.cost) best = run;
    if (run.cpu_s > kLong_s || !run.ended) break;
  }
  return best;
}

double measure_frequency(const SpeedProblem& problem, const std::string& poissons_ratio, const SpeedRung& rung,
                         double size, double frequency_hz, const MeasuringTools& tools) {
  const Scene scene = load(problem, overrides_of(problem, poissons_ratio, rung.overrides, size, tools), tools);
  const ModalResult result = modal_analysis(scene.simulation->body(), 2);
  // The bar's two lowest bend it about y and about z alike; the worse one counts.
  return (result.frequencies_hz.array() / frequency_hz - 1.0).abs().maxCoeff();
}

void judge_equilibria(std::vector<SpeedRun>& runs) {
  for (SpeedRun& run : runs) {
    if (!run.bullet || !run.ended) continue;
    for (const SpeedRun& ours : runs) {
      if (ours.bullet || !ours.ended || ours.rung != kSameElements || ours.problem != run.problem ||
          ours.poissons_ratio != run.poissons_ratio || std::abs(ours.size_m - run.size_m) > 1e-9)
        continue;
      const Eigen::Index count = static_cast<Eigen::Index>(run.curve.size());
      const double apart =
          (Eigen::VectorXd::Map(ours.curve.data(), count) - Eigen::VectorXd::Map(run.curve.data(), count)).norm();
      run.own_equilibrium = std::max(apart, std::abs(ours.error - run.error)) < kSameEquilibrium;
      if (!run.own_equilibrium) run.message = "not at its own rest state";
    }
  }
}

std::vector<SpeedRun> best_of(std::vector<SpeedRun> runs) {
  const auto unfit = [](const SpeedRun& run) { return !run.ended || !run.own_equilibrium; };
  runs.erase(std::remove_if(runs.begin(), runs.end(), unfit), runs.end());
  std::sort(runs.begin(), runs.end(), [](const SpeedRun& a, const SpeedRun& b) { return a.cost < b.cost; });
  std::vector<SpeedRun> best;
  for (const SpeedRun& run : runs) {
    if (best.empty() || run.error < kWorthTelling * best.back().error) best.push_back(run);
  }
  return best;
}

}  // namespace soft_robot_lab
