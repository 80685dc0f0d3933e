// SPDX-License-Identifier: BSD-3-Clause
#include "convergence_chart.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "manufactured_problem.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "mechanics/mesh/subdivide.h"

namespace soft_robot_lab {
namespace {

constexpr int kLevels = 4;  // of the smooth problem with linear elements; quadratic ones are as fine a level before
constexpr double kCoarsest_m = 0.02;  // elements of the cantilever, which are then cut
constexpr int kCuts = 3;              // of its linear elements; of quadratic ones one less
constexpr double kSwing_s = 0.096;    // to its first minimum
constexpr double kLongestStep_s = 0.016;
constexpr int kHalvings = 4;

void find_orders(ConvergenceSeries& series) {
  for (std::size_t i = 1; i < series.size.size(); ++i)
    series.orders.push_back(std::log(series.error[i - 1] / series.error[i]) /
                            std::log(series.size[i - 1] / series.size[i]));
}

std::string label_of(bool quadratic, double poissons_ratio) {
  std::ostringstream label;
  label << (quadratic ? "quadratic" : "linear") << " elements, " << poissons_ratio;
  return label.str();
}

ConvergenceSeries smooth(bool quadratic, double poissons_ratio, bool quick) {
  ConvergenceSeries series{"smooth", label_of(quadratic, poissons_ratio), {}, {}, {}};
  for (int level = quadratic ? 1 : 2; level <= kLevels - (quadratic ? 1 : 0) - (quick ? 1 : 0); ++level) {
    const ManufacturedRun run = solve_manufactured(poissons_ratio, quadratic, level);
    series.size.push_back(run.size_m);
    series.error.push_back(run.error);
    series.converged = series.converged && run.converged;
  }
  return series;
}

ConvergenceSeries cantilever(const ExperimentContext& context, const SpeedProblem& problem, std::size_t nu,
                             bool quadratic, bool quick) {
  ConvergenceSeries series{"cantilever", label_of(quadratic, std::stod(problem.poissons_ratios[nu])), {}, {}, {}};
  const Overrides overrides = Overrides()
                                  .set({"body", "element"}, quadratic ? "quadratic" : "linear")
                                  .set({"body", "element_size_m"}, kCoarsest_m)
                                  .set({"body", "material", "poissons_ratio"}, std::stod(problem.poissons_ratios[nu]));
  const Eigen::Vector3d& reference_m = problem.references_m[nu];
  for (int cuts = 0; cuts <= kCuts - (quadratic ? 1 : 0) - (quick ? 1 : 0); ++cuts) {
    SceneOptions options = context.scene_options(overrides);
    options.change_mesh = [cuts](TetMesh& mesh) {
      for (int i = 0; i < cuts; ++i) mesh = subdivide(mesh).mesh;
    };
    const Scene scene = load_scene(problem.scene, options);
    Simulation& simulation = *scene.simulation;
    series.converged = simulation.solve_equilibrium().converged && series.converged;
    const Eigen::Vector3d moved_m = simulation.marker_position(0) - simulation.markers().at(0).rest_position_m();
    series.size.push_back(kCoarsest_m / std::pow(2.0, cuts));
    series.error.push_back((moved_m - reference_m).norm() / reference_m.norm());
  }
  return series;
}

// Heights of the tip after each of the longest steps of a fall from the straight shape.
std::vector<double> fall(const ExperimentContext& context, const SpeedProblem& problem, const std::string& integrator,
                         int steps_in_longest, bool& converged) {
  const Overrides overrides = Overrides()
                                  .set({"body", "element_size_m"}, kCoarsest_m)
                                  .set({"solver", "integrator"}, integrator)
                                  .set({"solver", "dynamic_tolerance"}, 1.0e-7)
                                  .set({"solver", "time_step_s"}, kLongestStep_s / steps_in_longest);
  const Scene scene = load_scene(problem.scene, context.scene_options(overrides));
  Simulation& simulation = *scene.simulation;
  std::vector<double> heights_m;
  for (int i = 1; i <= steps_in_longest * static_cast<int>(std::lround(kSwing_s / kLongestStep_s)); ++i) {
    converged = simulation.step().converged && converged;
    if (i % steps_in_longest == 0) heights_m.push_back(simulation.marker_position(0).y());
  }
  return heights_m;
}

// The tip's largest distance from where steps eight times shorter than the shortest put it, over the fall.
ConvergenceSeries in_time(const ExperimentContext& context, const SpeedProblem& problem, const std::string& integrator,
                          const std::vector<double>& truth_m) {
  ConvergenceSeries series{"time", integrator == "bdf2" ? "BDF2" : "implicit Euler", {}, {}, {}};
  const double depth_m = -*std::min_element(truth_m.begin(), truth_m.end());
  for (int halvings = 1; halvings <= kHalvings; ++halvings) {
    const int steps = 1 << halvings;
    const std::vector<double> found_m = fall(context, problem, integrator, steps, series.converged);
    double largest_m = 0.0;
    for (std::size_t i = 0; i < truth_m.size(); ++i) largest_m = std::max(largest_m, std::abs(found_m[i] - truth_m[i]));
    series.size.push_back(kLongestStep_s / steps);
    series.error.push_back(largest_m / depth_m);
  }
  return series;
}

Axis axis(const std::string& label) {
  Axis axis;
  axis.label = label;
  axis.logarithmic = true;
  return axis;
}

}  // namespace

std::vector<ConvergenceSeries> run_convergence(const ExperimentContext& context, const SpeedLadder& ladder,
                                               bool quick) {
  const SpeedProblem& problem = ladder.problems.front();
  std::vector<ConvergenceSeries> all;
  for (const bool quadratic : {true, false}) {
    for (const double nu : {0.3, 0.45, 0.499}) all.push_back(smooth(quadratic, nu, quick));
    for (std::size_t nu = 0; nu < problem.poissons_ratios.size(); ++nu)
      all.push_back(cantilever(context, problem, nu, quadratic, quick));
  }
  bool converged = true;
  const std::vector<double> truth_m = fall(context, problem, "bdf2", 8 << kHalvings, converged);
  for (const char* integrator : {"implicit_euler", "bdf2"})
    all.push_back(in_time(context, problem, integrator, truth_m));
  all.back().converged = all.back().converged && converged;
  for (ConvergenceSeries& series : all) find_orders(series);
  return all;
}

std::vector<Plot> plot_convergence(const std::vector<ConvergenceSeries>& all) {
  std::vector<Plot> plots = {
      {"convergence_smooth", "A smooth problem (manufactured): error of the displacements", {}, {}},
      {"convergence_cantilever", "Cantilever (R1): error of the tip", {}, {}},
      {"convergence_time", "Fall of the cantilever: error of the tip", {}, {}}};
  for (Plot& plot : plots) {
    const bool time = plot.name == "convergence_time";
    plot.x = axis(time ? "time step [ms]" : "element size [mm], cut into eight each time");
    plot.y = axis("error [%]");
    plot.width_px = 1100;
    for (const ConvergenceSeries& series : all) {
      if (plot.name != "convergence_" + series.picture) continue;
      std::ostringstream label;
      label.precision(2);
      label << series.label;
      // The cantilever's clamped edges are singular, and errors of both signs cancel: no order is to be read there.
      if (series.picture != "cantilever") label << ": order " << series.orders.back();
      Series line{label.str(), {}, {}};
      if (series.label.rfind("linear", 0) == 0) line.style = SeriesStyle::dashes_points;
      for (std::size_t i = 0; i < series.size.size(); ++i) {
        line.x.push_back(1e3 * series.size[i]);
        line.y.push_back(1e2 * series.error[i]);
      }
      plot.series.push_back(line);
    }
  }
  return plots;
}

nlohmann::ordered_json convergence_json(const std::vector<ConvergenceSeries>& all) {
  auto json = nlohmann::ordered_json::array();
  for (const ConvergenceSeries& series : all)
    json.push_back({{"problem", series.picture},
                    {"series", series.label},
                    {"size", series.size},
                    {"error", series.error},
                    {"orders", series.orders},
                    {"converged", series.converged}});
  return json;
}

}  // namespace soft_robot_lab
