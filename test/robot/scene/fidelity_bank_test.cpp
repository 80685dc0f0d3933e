// SPDX-License-Identifier: BSD-3-Clause
// What the choice of fidelity is worth, by true errors and counted costs of many scenes (nightly/fidelity_bank.cpp).
#include "fidelity_bank.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/run_scene.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::json;

// Of the table as it is; a change for the better lowers them.
constexpr int kBankMisses = 0, kBankRefused = 3;
constexpr double kBankWorstRegret = 6.5, kBankJudging = 70.0;

Json bank() {
  std::ifstream stream(std::string(SOFT_ROBOT_LAB_SOURCE) + "/test/data/fidelity_bank.json");
  return Json::parse(stream).at("scenes");
}

// Of the meshes that are within the tolerance, of those tried and those chosen.
std::optional<double> cheapest_s(const Json& scene, double tolerance_m) {
  std::optional<double> least;
  for (const char* list : {"meshes", "choices"})
    for (const Json& mesh : scene.at(list)) {
      const double error_m = mesh.at("error_m").get<double>(), cost_s = mesh.at("cost_s").get<double>();
      if (error_m >= 0.0 && error_m <= tolerance_m) least = std::min(cost_s, least.value_or(cost_s));
    }
  return least;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.at(values.size() / 2);
}

struct Worth {
  std::vector<double> regrets, judging;  // cost over the cheapest; judging over a rest state
  int misses = 0, refused = 0, met = 0;  // a miss counts beyond what is unsure of the truth
};

Worth worth(const Json& scenes) {
  Worth all;
  for (const Json& scene : scenes)
    for (const Json& choice : scene.at("choices")) {
      const double tolerance_m = choice.at("tolerance_m").get<double>(), error_m = choice.at("error_m").get<double>();
      const std::optional<double> least_s = cheapest_s(scene, tolerance_m);
      all.judging.push_back(choice.at("judging_cost_s").get<double>() / choice.at("cost_s").get<double>());
      if (!choice.at("met").get<bool>()) {
        all.refused += least_s ? 1 : 0;
        continue;
      }
      ++all.met;
      if (error_m < 0.0 || error_m > tolerance_m + scene.at("unsure_m").get<double>())
        ++all.misses;
      else if (error_m <= tolerance_m)
        all.regrets.push_back(choice.at("cost_s").get<double>() / *least_s);
    }
  return all;
}

TEST(FidelityBank, ChoosesNearlyTheCheapestThatWillDo) {
  const Worth all = worth(bank());
  RecordProperty("median_regret", std::to_string(median(all.regrets)));
  RecordProperty("worst_regret", std::to_string(*std::max_element(all.regrets.begin(), all.regrets.end())));
  EXPECT_GE(all.met, 40);
  EXPECT_EQ(all.misses, kBankMisses);
  EXPECT_LE(all.refused, kBankRefused);
  EXPECT_LE(median(all.regrets), 1.3);
  EXPECT_LE(*std::max_element(all.regrets.begin(), all.regrets.end()), kBankWorstRegret);
  EXPECT_LE(median(all.judging), kBankJudging);
}

TEST(FidelityBank, ALooserToleranceNeverAsksForMoreNodes) {
  for (const Json& scene : bank()) {
    int last = 1 << 30;
    for (const Json& choice : scene.at("choices")) {  // from tight to loose
      if (!choice.at("met").get<bool>()) continue;
      SCOPED_TRACE(scene.at("name").get<std::string>() + " " + choice.at("tolerance_m").dump());
      EXPECT_LE(choice.at("nodes").get<int>(), last);
      last = choice.at("nodes").get<int>();
    }
  }
}

// The table is that of today's choice.
TEST(FidelityBank, HoldsWhatIsChosenToday) {
  SceneFolder folder;
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.cache_folder = folder.path("cache");
  options.actuator_factory = make_actuator;
  const Json rows = bank();
  for (const BankScene& scene : bank_scenes()) {
    if (scene.name != "hollow_cuboid" && scene.name != "pulled_bar" && scene.name != "spinebot") continue;
    SCOPED_TRACE(scene.name);
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const Json& r) { return r.at("name") == scene.name; });
    ASSERT_NE(row, rows.end());
    const auto& choices = row->at("choices");
    const auto at =
        std::find_if(choices.begin(), choices.end(), [](const Json& c) { return c.at("tolerance_m") == 0.001; });
    ASSERT_NE(at, choices.end());
    const Scene chosen =
        load_scene(YamlNode::parse(scene.text + "fidelity: {tolerance_m: 0.001}\n",
                                   std::string(SOFT_ROBOT_LAB_SOURCE) + "/config/" + scene.name + ".yaml"),
                   options);
    EXPECT_EQ(chosen.fidelity->nodes, at->at("nodes").get<int>());
    EXPECT_NEAR(*chosen.fidelity->expected_error_m, at->at("expected_m").get<double>(), 1e-5);
  }
}

}  // namespace
}  // namespace soft_robot_lab
