// SPDX-License-Identifier: BSD-3-Clause
// chart_fidelity FILE FOLDER: what `fidelity` chose in each scene of test/data/fidelity_bank.json among the meshes that
// there are, as a picture, and what the choice is worth at each tolerance, as fidelity.json.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "robot/scene/fidelity_worth.h"
#include "session/report/plot.h"
#include "settings/quantile.h"

namespace {

using namespace soft_robot_lab;
using Json = nlohmann::json;

constexpr double kRelative = 100.0;  // of the cheapest mesh's cost, below and above which nothing is drawn

// The cost of a scene's cheapest mesh within a tolerance is 1, its error is over the tolerance: so that all scenes
// share one picture, in which a good choice lies near (1, 1).
struct Cloud {
  Series meshes{"meshes that were tried", {}, {}, SeriesStyle::points, 5};
  Series chosen{"chosen", {}, {}, SeriesStyle::points, 1};
  Series unmet{"chosen, but not said to be within it", {}, {}, SeriesStyle::crosses, 2};
};

void add(double error, double cost, Series& series) {
  if (!(error > 0.0) || cost > kRelative || cost < 1.0 / kRelative) return;
  series.x.push_back(error);
  series.y.push_back(cost);
}

void add(const Json& scene, const Json& choice, Cloud& cloud) {
  const double tolerance_m = choice.at("tolerance_m").get<double>();
  const double own_s = choice.at("cost_s").get<double>(), least_s = cheapest_s(scene, tolerance_m).value_or(own_s);
  for (const Json& mesh : scene.at("meshes"))
    add(mesh.at("error_m").get<double>() / tolerance_m, mesh.at("cost_s").get<double>() / least_s, cloud.meshes);
  add(choice.at("error_m").get<double>() / tolerance_m, own_s / least_s,
      choice.at("met").get<bool>() ? cloud.chosen : cloud.unmet);
}

Plot drawn(const Json& scenes) {
  Cloud cloud;
  for (const Json& scene : scenes)
    for (const Json& choice : scene.at("choices")) add(scene, choice, cloud);
  Plot plot{"fidelity", "Cost over true error of all scenes and tolerances of the bank", {}, {}};
  plot.x = {"true error over the tolerance", true};
  plot.y = {"cost over that of the cheapest within it", true};
  plot.x.guides = plot.y.guides = {1.0};
  plot.series = {cloud.meshes, cloud.chosen, cloud.unmet};
  return plot;
}

Json rows(const Json& scenes) {
  std::map<double, FidelityWorth> of_tolerance;
  for (const Json& scene : scenes)
    for (const Json& choice : scene.at("choices"))
      of_tolerance[choice.at("tolerance_m").get<double>()].add(scene, choice);
  Json all = Json::array();
  for (const auto& [tolerance_m, worth] : of_tolerance) {
    Json row{{"tolerance_mm", 1e3 * tolerance_m},
             {"met", worth.met},
             {"misses", worth.misses},
             {"refused", worth.refused},
             {"near_buckling", worth.near_buckling},
             {"judging_rest_states", median(worth.judging)},
             {"scenes", worth.judging.size()}};
    if (!worth.regrets.empty()) {
      row["median_regret"] = median(worth.regrets);
      row["worst_regret"] = *std::max_element(worth.regrets.begin(), worth.regrets.end());
    }
    if (!worth.without_luck.empty())
      row["worst_without_luck"] = *std::max_element(worth.without_luck.begin(), worth.without_luck.end());
    all.push_back(row);
  }
  return all;
}

void draw(const std::string& file, const std::string& folder) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error("cannot read " + file);
  const Json scenes = Json::parse(stream).at("scenes");
  write_plot(drawn(scenes), folder);
  std::ofstream(folder + "/fidelity.json") << rows(scenes).dump(1) << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "chart_fidelity FILE FOLDER\n";
    return 2;
  }
  try {
    draw(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::cerr << "chart_fidelity: " << error.what() << "\n";
    return 2;
  }
}
