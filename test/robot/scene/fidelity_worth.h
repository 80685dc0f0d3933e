// SPDX-License-Identifier: BSD-3-Clause
// What the choice of fidelity is worth, computed from test/data/fidelity_bank.json.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace soft_robot_lab {

// Of the meshes that are within the tolerance, of those tried and those chosen.
inline std::optional<double> cheapest_s(const nlohmann::json& scene, double tolerance_m) {
  std::optional<double> least;
  for (const char* list : {"meshes", "choices"})
    for (const nlohmann::json& mesh : scene.at(list)) {
      const double error_m = mesh.at("error_m").get<double>(), cost_s = mesh.at("cost_s").get<double>();
      if (error_m >= 0.0 && error_m <= tolerance_m) least = std::min(cost_s, least.value_or(cost_s));
    }
  return least;
}

// Of the meshes tried, from the coarsest on after which none is beyond the tolerance: what needs no luck. None where
// the finest is.
inline std::optional<double> cheapest_without_luck_s(const nlohmann::json& scene, double tolerance_m) {
  std::optional<double> least;
  for (const nlohmann::json& mesh : scene.at("meshes")) {  // from coarse to fine
    const double cost_s = mesh.at("cost_s").get<double>();
    if (mesh.at("error_m").get<double>() > tolerance_m)
      least.reset();
    else
      least = std::min(cost_s, least.value_or(cost_s));
  }
  return least;
}

struct FidelityWorth {
  // Cost over the cheapest, and over the cheapest that needs no luck; judging over a rest state.
  std::vector<double> regrets, without_luck, judging;
  // A miss counts beyond what is unsure of the truth; refused is what a mesh would have met.
  int misses = 0, refused = 0, met = 0, near_buckling = 0;

  void add(const nlohmann::json& scene, const nlohmann::json& choice) {
    const double tolerance_m = choice.at("tolerance_m").get<double>(), error_m = choice.at("error_m").get<double>();
    const std::optional<double> least_s = cheapest_s(scene, tolerance_m);
    if (choice.value("near_buckling", false)) {
      ++near_buckling;
      return;
    }
    judging.push_back(choice.at("judging_cost_s").get<double>() / choice.at("cost_s").get<double>());
    if (!choice.at("met").get<bool>()) {
      refused += least_s ? 1 : 0;
      return;
    }
    ++met;
    if (error_m < 0.0 || error_m > tolerance_m + scene.at("unsure_m").get<double>())
      ++misses;
    else if (error_m <= tolerance_m)
      regrets.push_back(choice.at("cost_s").get<double>() / *least_s);
    if (const std::optional<double> sure_s = cheapest_without_luck_s(scene, tolerance_m))
      without_luck.push_back(choice.at("cost_s").get<double>() / *sure_s);
  }
};

}  // namespace soft_robot_lab
