// SPDX-License-Identifier: BSD-3-Clause
#include "speed_claims.h"

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

std::vector<SpeedRun> chosen(const std::vector<SpeedRun>& runs, const SpeedProblem& problem, const std::string& nu,
                             bool bullet) {
  std::vector<SpeedRun> result;
  for (const SpeedRun& run : runs) {
    if (run.problem == problem.name && run.poissons_ratio == nu && run.bullet == bullet && run.mode == "settled" &&
        run.ended)
      result.push_back(run);
  }
  return result;
}

// The cheapest run that is wrong by no more.
std::optional<SpeedRun> cheapest_within(const std::vector<SpeedRun>& runs, double error) {
  std::optional<SpeedRun> best;
  for (const SpeedRun& run : runs) {
    if (run.error <= error && (!best || run.cost < best->cost)) best = run;
  }
  return best;
}

Json numbers_of(const SpeedRun& run) {
  return {{"method", run.rung},
          {"size_m", run.size_m},
          {"elements", run.elements},
          {"error_percent", 1e2 * run.error},
          {"cpu_s_per_simulated_s", run.cost}};
}

Json numbers_of(const std::optional<SpeedRun>& run) { return run ? numbers_of(*run) : Json(nullptr); }

// For each point of a rival: how many times cheaper our cheapest run is that is at least as exact.
Json against(const std::vector<SpeedRun>& ours, double error, std::optional<double> cost) {
  const std::optional<SpeedRun> better = cheapest_within(ours, error);
  Json json = {{"error_percent", 1e2 * error}};
  json["cpu_s_per_simulated_s"] = cost ? Json(*cost) : Json(nullptr);
  json["ours"] = numbers_of(better);
  json["times_faster"] = better && cost ? Json(*cost / better->cost) : Json(nullptr);
  return json;
}

// Bullet's best runs; what is no rest state of its mesh counts on demand.
Json against_bullet(const std::vector<SpeedRun>& ours, std::vector<SpeedRun> bullet, bool chance_hits) {
  if (chance_hits)
    for (SpeedRun& run : bullet) run.own_equilibrium = true;
  Json json = Json::array();
  for (const SpeedRun& run : best_of(std::move(bullet))) json.push_back(against(ours, run.error, run.cost));
  return json;
}

// The one rung that serves every Poisson's ratio within the error: cost is its dearest, error its worst.
std::optional<SpeedRun> cheapest_for_all(const std::vector<SpeedRun>& runs, const SpeedProblem& problem, double error) {
  std::map<std::pair<std::string, double>, std::vector<SpeedRun>> rungs;
  for (const std::string& nu : problem.poissons_ratios)
    for (const SpeedRun& run : chosen(runs, problem, nu, false)) rungs[{run.rung, run.size_m}].push_back(run);
  std::optional<SpeedRun> best;
  for (const auto& [name, same] : rungs) {
    if (same.size() != problem.poissons_ratios.size()) continue;
    SpeedRun worst = same.front();
    for (const SpeedRun& run : same) {
      worst.error = std::max(worst.error, run.error);
      worst.cost = std::max(worst.cost, run.cost);
    }
    if (worst.error <= error && (!best || worst.cost < best->cost)) best = worst;
  }
  return best;
}

Json frequencies(const std::vector<SpeedRun>& runs, const std::string& nu) {
  Json json = Json::array();
  for (const SpeedRun& run : runs) {
    if (run.frequency_error >= 0.0 && run.poissons_ratio == nu)
      json.push_back({{"method", run.rung}, {"size_m", run.size_m}, {"error_percent", 1e2 * run.frequency_error}});
  }
  return json;
}

}  // namespace

SpeedClaims check_claims(const SpeedLadder& ladder, const std::vector<SpeedRun>& runs) {
  SpeedClaims claims;
  std::ostringstream words;
  words.precision(3);
  for (const SpeedProblem& problem : ladder.problems) {
    Json& numbers = claims.numbers[problem.name];
    for (const double percent : {30.0, 5.0, 1.0, 0.5}) {
      std::ostringstream key;
      key << "every_poissons_ratio_within_" << percent << "_percent";
      numbers[key.str()] = numbers_of(cheapest_for_all(runs, problem, 1e-2 * percent));
    }
    if (const auto rung = cheapest_for_all(runs, problem, 0.01)) {
      words << problem.name << ": within 1 % at every Poisson's ratio for " << rung->cost
            << " CPU-seconds per simulated second (" << rung->rung << ", " << rung->elements << " elements). ";
    }
    for (const std::string& nu : problem.poissons_ratios) {
      const std::vector<SpeedRun> ours = chosen(runs, problem, nu, false);
      Json& here = numbers[nu];
      here["within_1_percent"] = numbers_of(cheapest_within(ours, 0.01));
      here["within_0.5_percent"] = numbers_of(cheapest_within(ours, 0.005));
      here["bullet"] = against_bullet(ours, chosen(runs, problem, nu, true), false);
      here["bullet_with_chance_hits"] = against_bullet(ours, chosen(runs, problem, nu, true), true);
      if (!here["bullet"].empty()) {
        const Json& last = here["bullet"].back();
        if (!last["times_faster"].is_null()) {
          words << "At " << nu << " Bullet comes to " << last["error_percent"].get<double>() << " %, and we are "
                << last["times_faster"].get<double>() << " times faster there. ";
        }
      }
      if (problem.name != "cantilever") continue;
      here["frequencies"] = frequencies(runs, nu);
      for (const ElsewherePoint& point : ladder.elsewhere) {
        if (point.poissons_ratio != nu) continue;
        Json row = against(ours, 1e-2 * point.error_percent, point.cost);
        row["name"] = point.name;
        here["elsewhere"].push_back(row);
      }
    }
  }
  claims.words = words.str();
  return claims;
}

}  // namespace soft_robot_lab
