// The program `experiment` as a user runs it.
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scene/scene_files.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

struct Outcome {
  int exit_status;
  std::string out, err;
};

Outcome experiment(const SceneFolder& folder, const std::string& arguments) {
  const std::string out = folder.path("out"), err = folder.path("err");
  const int status =
      std::system((std::string(SOFT_ROBOT_LAB_EXPERIMENT) + " " + arguments + " >" + out + " 2>" + err).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(out), contents(err)};
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
      {"cantilever --result", "--result needs a value"},
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
