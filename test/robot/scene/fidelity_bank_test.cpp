// SPDX-License-Identifier: BSD-3-Clause
// What the choice of fidelity is worth, by true errors and counted costs of many scenes (nightly/fidelity_bank.cpp).
#include "fidelity_bank.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "fidelity_worth.h"
#include "scene_files.h"
#include "settings/quantile.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/run_scene.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::json;

// Of the table as it is; a change for the better lowers them.
constexpr int kBankMisses = 0, kBankRefused = 6;
// The worst is luck of meshes: of column_aside at 0.3 mm 76 nodes are within it, and 232, 277 and 362 are not.
constexpr double kBankWorstRegret = 56.0, kBankWorstWithoutLuck = 6.0, kBankJudging = 30.0;

Json bank() {
  std::ifstream stream(std::string(SOFT_ROBOT_LAB_SOURCE) + "/test/data/fidelity_bank.json");
  return Json::parse(stream).at("scenes");
}

FidelityWorth worth(const Json& scenes) {
  FidelityWorth all;
  for (const Json& scene : scenes)
    for (const Json& choice : scene.at("choices")) all.add(scene, choice);
  return all;
}

TEST(FidelityBank, ChoosesNearlyTheCheapestThatWillDo) {
  const FidelityWorth all = worth(bank());
  RecordProperty("median_regret", std::to_string(median(all.regrets)));
  RecordProperty("worst_regret", std::to_string(*std::max_element(all.regrets.begin(), all.regrets.end())));
  EXPECT_GE(all.met, 40);
  EXPECT_EQ(all.misses, kBankMisses);
  EXPECT_LE(all.refused, kBankRefused);
  EXPECT_LE(median(all.regrets), 1.3);
  EXPECT_LE(*std::max_element(all.regrets.begin(), all.regrets.end()), kBankWorstRegret);
  EXPECT_LE(median(all.without_luck), 1.3);
  EXPECT_LE(*std::max_element(all.without_luck.begin(), all.without_luck.end()), kBankWorstWithoutLuck);
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

// No error is stated of what buckles or is about to, and of all else one is.
TEST(FidelityBank, RefusesWhatBucklesAlone) {
  const std::set<std::string> buckles{"column_below_buckling", "column_beyond_buckling", "column_far_beyond_buckling",
                                      "standing_post", "antagonists"};
  for (const Json& scene : bank())
    for (const Json& choice : scene.at("choices")) {
      SCOPED_TRACE(scene.at("name").get<std::string>() + " " + choice.at("tolerance_m").dump());
      EXPECT_EQ(choice.value("near_buckling", false), buckles.count(scene.at("name").get<std::string>()) > 0);
    }
  EXPECT_EQ(bank().size(), bank_scenes().size());
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
