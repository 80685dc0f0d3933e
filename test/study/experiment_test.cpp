// SPDX-License-Identifier: BSD-3-Clause
// The program `experiment` as a user runs it.
#include <cmath>
#include <filesystem>
#include <regex>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

Outcome experiment(const SceneFolder& folder, const std::string& arguments) {
  return run_program(SOFT_ROBOT_LAB_EXPERIMENT, folder, arguments);
}

TEST(Experiment, RepeatsTheCantilever) {
  const SceneFolder folder;
  const Outcome outcome = experiment(
      folder, "cantilever --result " + folder.path("result.json") + " --output " + folder.path("out_folder"));
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  const Json result = Json::parse(contents(folder.path("result.json")));
  EXPECT_EQ(result["converged"], true);
  EXPECT_EQ(result["table"].size(), 8u);
  for (const Json& row : result["table"]) {
    if (row["element"] != "quadratic") continue;
    EXPECT_LT(std::abs(row["error [%]"].get<double>()), 1.0) << row;
    EXPECT_LE(row["Newton iterations"].get<int>(), 6) << row;
  }
  EXPECT_NE(outcome.out.find("sag [mm]"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("cantilever: 0 %: quadratic at 0.45\n"), std::string::npos) << outcome.err;
  for (const std::string name : {"cantilever.svg", "cantilever.png", "cantilever.csv", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path("out_folder/" + name))) << name;
  }
}

TEST(Experiment, FindsEveryFileThatItsSettingsName) {
  const std::string config = SOFT_ROBOT_LAB_SOURCE "/config/";
  const std::regex file("(robots|motors|cameras|scenes)/[A-Za-z0-9_./]+[.]yaml");
  int named = 0;
  for (const auto& settings : std::filesystem::directory_iterator(config + "experiments")) {
    const std::string text = contents(settings.path().string());
    for (std::sregex_iterator at(text.begin(), text.end(), file), end; at != end; ++at, ++named)
      EXPECT_TRUE(std::filesystem::exists(config + at->str())) << settings.path() << ": " << at->str();
  }
  EXPECT_GT(named, 50);
}

TEST(Experiment, ListsWhatItKnows) {
  const SceneFolder folder;
  const Outcome outcome = experiment(folder, "--list");
  EXPECT_EQ(outcome.exit_status, 0);
  EXPECT_NE(outcome.out.find("cantilever: "), std::string::npos);
}

TEST(Experiment, TellsWhatIsWrongWithItsArguments) {
  const SceneFolder folder;
  const std::vector<std::pair<std::string, std::string>> table = {
      {"9.9.9", "unknown experiment '9.9.9'; known: all, cantilever"},
      {"", "no experiment named"},
      {"cantilever --result", "--result: 1 required FILE missing"},
      {"cantilever --colour", "unknown option --colour"},
  };
  for (const auto& [arguments, words] : table) {
    SCOPED_TRACE(arguments);
    const Outcome outcome = experiment(folder, arguments);
    EXPECT_EQ(outcome.exit_status, 2);
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace soft_robot_lab
