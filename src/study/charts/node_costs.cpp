// SPDX-License-Identifier: BSD-3-Clause
#include "node_costs.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <Eigen/QR>

namespace soft_robot_lab {
namespace {

constexpr std::size_t kFewest = 3;  // meshes that an exponent is of

std::string name_of(const SpeedRun& run) { return (run.bullet ? "Bullet, " : "") + run.rung; }

// The runs of each method for one question, coarse to fine.
std::vector<std::vector<SpeedRun>> series_of(const std::vector<SpeedRun>& runs, const std::string& mode) {
  std::vector<std::vector<SpeedRun>> all;
  for (const SpeedRun& run : runs) {
    if (run.mode != mode || !run.ended) continue;
    if (all.empty() || name_of(all.back().front()) != name_of(run)) all.emplace_back();
    all.back().push_back(run);
  }
  return all;
}

}  // namespace

std::optional<double> exponent(const std::vector<SpeedRun>& runs, int from_nodes) {
  std::vector<SpeedRun> fine;
  std::copy_if(runs.begin(), runs.end(), std::back_inserter(fine),
               [&](const SpeedRun& run) { return run.nodes >= from_nodes; });
  if (fine.size() < kFewest) return std::nullopt;
  Eigen::MatrixX2d nodes(static_cast<Eigen::Index>(fine.size()), 2);
  Eigen::VectorXd cost(nodes.rows());
  for (Eigen::Index i = 0; i < nodes.rows(); ++i) {
    const SpeedRun& run = fine[static_cast<std::size_t>(i)];
    nodes.row(i) << 1.0, std::log(run.nodes);
    cost[i] = std::log(run.cost);
  }
  return nodes.colPivHouseholderQr().solve(cost)[1];
}

std::vector<SpeedRun> run_node_costs(const ExperimentContext& context, const NodeCosts& costs,
                                     const MeasuringTools& tools) {
  std::vector<SpeedRun> runs;
  for (const SpeedRung& rung : costs.rungs) {
    if (rung.bullet && tools.bullet.empty()) continue;
    for (const bool settled : {true, false}) {
      if (!(settled ? rung.settled : rung.equilibrium)) continue;
      for (const double size : rung.sizes) {
        runs.push_back(measure(costs.problem, 0, rung, size, settled, tools));
        const SpeedRun& run = runs.back();
        context.report(1.0, name_of(run) + ": " + std::to_string(run.nodes) + " nodes, " + run.mode + ": " +
                                (run.ended ? std::to_string(run.cost) + " s" : run.message));
        if (run.cpu_s > costs.stop_after_cpu_s) break;
      }
    }
  }
  return runs;
}

std::vector<Plot> plot_node_costs(const NodeCosts& costs, const std::vector<SpeedRun>& runs) {
  std::vector<Plot> plots;
  for (const std::string mode : {"settled", "equilibrium"}) {
    const bool motion = mode == "settled";
    Plot plot{motion ? "cost_of_nodes_motion" : "cost_of_nodes_equilibrium",
              costs.problem.title + (motion ? ", falling: cost over nodes" : ", its equilibrium: cost over nodes"),
              {},
              {}};
    plot.x = {"nodes", true};
    plot.y = {motion ? "CPU-seconds per simulated second, 60 Hz" : "CPU-seconds per equilibrium", true};
    plot.y.guides = {1.0};
    plot.width_px = 1100;
    for (const std::vector<SpeedRun>& series : series_of(runs, mode)) {
      std::ostringstream label;
      label.precision(2);
      label << name_of(series.front());
      if (const auto power = exponent(series, costs.from_nodes)) label << ": power " << *power;
      plot.series.push_back({label.str(), {}, {}});
      for (const SpeedRun& run : series) {
        plot.series.back().x.push_back(run.nodes);
        plot.series.back().y.push_back(run.cost);
      }
    }
    if (!plot.series.empty()) plots.push_back(std::move(plot));
  }
  return plots;
}

nlohmann::ordered_json node_costs_json(const NodeCosts& costs, const std::vector<SpeedRun>& runs) {
  auto json = nlohmann::ordered_json::array();
  for (const std::string mode : {"settled", "equilibrium"}) {
    for (const std::vector<SpeedRun>& series : series_of(runs, mode)) {
      const auto power = exponent(series, costs.from_nodes);
      nlohmann::ordered_json one = {{"method", name_of(series.front())},
                                    {"question", mode == "settled" ? "motion" : mode},
                                    {"exponent_from_nodes", costs.from_nodes}};
      one["exponent"] = power ? nlohmann::ordered_json(*power) : nlohmann::ordered_json(nullptr);
      for (const SpeedRun& run : series)
        one["meshes"].push_back({{"nodes", run.nodes}, {"elements", run.elements}, {"cpu_s", run.cost}});
      json.push_back(one);
    }
  }
  return json;
}

}  // namespace soft_robot_lab
