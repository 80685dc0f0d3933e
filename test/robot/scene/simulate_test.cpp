// SPDX-License-Identifier: BSD-3-Clause
// The program `simulate` as a user runs it.
#include <cmath>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "reference_table.h"
#include "run_program.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

const std::string kCantilever = std::string(SOFT_ROBOT_LAB_SOURCE) + "/config/scenes/cantilever.yaml";

Outcome simulate(const SceneFolder& folder, const std::string& arguments) {
  return run_program(SOFT_ROBOT_LAB_SIMULATE, folder, arguments);
}

double reference_sag_m(const std::string& poissons_ratio) {
  for (const ReferenceRow& row : read_reference("r1_cantilever")) {
    if (row.text("nu") == poissons_ratio && row.text("law") == "iso") return -row.number("tip_uy_m");
  }
  ADD_FAILURE() << "no reference for " << poissons_ratio;
  return std::nan("");
}

class Cantilever : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(PoissonsRatio, Cantilever, testing::Values("0.45", "0.499", "0.4999"),
                         [](const auto& param_info) { return "nu_0_" + param_info.param.substr(2); });

TEST_P(Cantilever, SagsAsTheReferenceInFewIterations) {
  const SceneFolder folder;
  const std::string scene = folder.write(
      "scene.yaml", "include: " + kCantilever + "\nbody: {material: {poissons_ratio: " + GetParam() + "}}\n");
  const Outcome outcome = simulate(folder, scene + " --result " + folder.path("result.json"));
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  const Json result = Json::parse(contents(folder.path("result.json")));
  const double sag_m = -result["markers"]["tip"]["displacement_m"][1].get<double>();
  const double reference_m = reference_sag_m(GetParam());
  EXPECT_NEAR(sag_m, reference_m, 0.03 * reference_m);
  EXPECT_LE(result["solver"]["iterations"].get<int>(), 8);
  EXPECT_NE(outcome.out.find("converged: "), std::string::npos);
}

TEST(Simulate, PrintsTheResultWhereNoFileIsNamed) {
  const SceneFolder folder;
  const Outcome outcome = simulate(folder, folder.path("bar.yaml"));
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_TRUE(Json::parse(outcome.out).contains("markers"));
  EXPECT_EQ(outcome.err, "");
}

TEST(Simulate, ShowsHowFarItIsAndKeepsWhatIsDoneAtCtrlC) {
  const SceneFolder folder;
  const std::string scene =
      folder.write("long.yaml", "include: bar.yaml\nrun: {mode: dynamic, duration_s: 100000, record_every_s: 1}\n");
  const Outcome outcome = run_program("timeout --preserve-status --signal=INT 4 " SOFT_ROBOT_LAB_SIMULATE, folder,
                                      scene + " --result " + folder.path("result.json"));
  EXPECT_EQ(outcome.exit_status, 1) << outcome.err;
  EXPECT_NE(outcome.err.find(" %: runs; Ctrl-C ends it"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(" of 100000 s, as asked"), std::string::npos) << outcome.err;
  const Json result = Json::parse(contents(folder.path("result.json")));
  EXPECT_GE(result["trajectory"]["time_s"].size(), 2u);
}

// Before a solve that may take long, and once.
TEST(Simulate, SaysFirstWhatIsKnownWhenTheFileIsRead) {
  const SceneFolder folder;
  const std::string scene = folder.write(
      "soft.yaml", "include: bar.yaml\nbody: {material: {youngs_modulus_pa: 264.2}}\nsolver: {time_limit_s: 1.0e-9}\n");
  const Outcome outcome = simulate(folder, scene + " --result " + folder.path("result.json"));
  EXPECT_EQ(outcome.exit_status, 1) << outcome.out;
  const std::string words = "simulate: warning: Young's modulus is 264.2 Pa";
  EXPECT_EQ(outcome.err.find(words), 0u) << outcome.err;
  EXPECT_EQ(outcome.err.rfind(words), 0u) << outcome.err;
  EXPECT_EQ(Json::parse(contents(folder.path("result.json")))["solver"]["warnings"][0]["kind"],
            "implausible_stiffness");
}

// Before what may last minutes, and once.
TEST(Simulate, WarnsBeforeItTrains) {
  const SceneFolder folder;
  const std::string scene = folder.write("odd.yaml", R"(include: bar.yaml
gravity_m_s2: [0, -60, 0]
solver: {method: reduced, modes: 1, tolerance_m: 1, commands: {left: [0.99, 1], right: [0.99, 1]}}
)");
  const Outcome outcome = simulate(folder, scene + " --result " + folder.path("result.json"));
  const std::string words = "simulate: warning: gravity_m_s2 is 60 m/s2 long";
  EXPECT_EQ(outcome.err.find(words), 0u) << outcome.err;
  EXPECT_EQ(outcome.err.rfind(words), 0u) << outcome.err;
}

TEST(Simulate, WritesTheSameBytesTwiceButForTheTime) {
  const SceneFolder folder;
  const auto without_time = [](const std::string& text) {
    std::istringstream lines(text);
    std::string rest;
    for (std::string line; std::getline(lines, line);) {
      if (line.find("\"wall_s\"") == std::string::npos) rest += line + "\n";
    }
    return rest;
  };
  const std::string once = simulate(folder, kCantilever).out;
  const std::string again = simulate(folder, kCantilever).out;
  EXPECT_NE(once.find("wall_s"), std::string::npos);
  EXPECT_EQ(without_time(once), without_time(again));
}

TEST(Simulate, WritesTheResultThoughItDidNotConverge) {
  const SceneFolder folder;
  const std::string scene =
      folder.write("hard.yaml", "include: bar.yaml\nsolver: {tolerance: 1.0e-300, max_iterations: 1}\n");
  const Outcome outcome = simulate(folder, scene + " --result " + folder.path("result.json"));
  EXPECT_EQ(outcome.exit_status, 1) << outcome.out;
  EXPECT_NE(outcome.err.find("did not converge: "), std::string::npos);
  const Json result = Json::parse(contents(folder.path("result.json")));
  EXPECT_EQ(result["solver"]["converged"], false);
  EXPECT_TRUE(result["markers"]["tip"]["position_m"][1].is_number());
  EXPECT_TRUE(result["solver"]["residual"].is_number());
}

TEST(Simulate, TellsTheExpectedErrorOfASceneAsItIs) {
  const SceneFolder folder;
  const Outcome outcome = simulate(folder, kCantilever + " --estimate-error --result " + folder.path("result.json"));
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("expected error of the markers: 0."), std::string::npos) << outcome.out;
  const Json fidelity = Json::parse(contents(folder.path("result.json")))["fidelity"];
  EXPECT_GT(fidelity["expected_error_m"].get<double>(), 0.00001);
  EXPECT_FALSE(fidelity.contains("tolerance_m"));
}

TEST(Simulate, EndsWithOneWhereTheToleranceIsNotMet) {
  const SceneFolder folder;
  const std::string scene =
      folder.write("strict.yaml", "include: " + kCantilever + "\nfidelity: {tolerance_m: 1.0e-6, max_nodes: 300}\n");
  const Outcome outcome = simulate(folder, scene + " --result " + folder.path("result.json"));
  EXPECT_EQ(outcome.exit_status, 1);
  EXPECT_NE(outcome.err.find("beyond the tolerance of 0.001 mm"), std::string::npos) << outcome.err;
  const Json result = Json::parse(contents(folder.path("result.json")));
  EXPECT_EQ(result["solver"]["converged"], true);
  EXPECT_EQ(result["fidelity"]["met"], false);
}

TEST(Simulate, TellsWhatIsWrongWithASceneOrArgument) {
  const SceneFolder folder;
  folder.write("bad.yaml", "include: bar.yaml\nbody: {element: cubic}\n");
  const std::vector<std::pair<std::string, std::string>> table = {
      {folder.path("bad.yaml"), "bad.yaml:2: body.element: 'cubic' is not one of linear, quadratic"},
      {folder.path("missing.yaml"), "missing.yaml: cannot be read"},
      {folder.write("text.yaml", "body: [1, 2\n"), "text.yaml:2: not YAML"},
      {folder.write("tab.yaml", "body:\n  element: linear\n\telement_size_m: 0.02\n"),
       "tab.yaml:3: not YAML: a tab indents this line, where YAML takes spaces alone"},
      {folder.write("one.yaml", "include: bar.yaml\ngravity_m_s2: -9.81\n"),
       "one.yaml:2: gravity_m_s2: must be a list [x, y, z], not the one value '-9.81'"},
      {"", "SCENE is required\nUsage: simulate [OPTIONS] SCENE\n"},
      {"--resutl x " + kCantilever, "unknown option --resutl"},
      {kCantilever + " --result", "--result: 1 required FILE missing"},
      {kCantilever + " " + kCantilever, "not expected: " + kCantilever},
      {kCantilever + " --result /nowhere/result.json", "/nowhere/result.json: cannot be written"},
  };
  for (const auto& [arguments, words] : table) {
    SCOPED_TRACE(arguments);
    const Outcome outcome = simulate(folder, arguments);
    EXPECT_EQ(outcome.exit_status, 2);
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  }
}

TEST(Simulate, EndsWithOneWhereTheDiskIsFull) {
  const SceneFolder folder;
  const std::string message = "cannot be written: No space left on device";
  const int status = std::system(
      (std::string(SOFT_ROBOT_LAB_SIMULATE) + " " + kCantilever + " >/dev/full 2>" + folder.path("err")).c_str());
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_NE(contents(folder.path("err")).find(message), std::string::npos);
  const Outcome outcome = simulate(folder, kCantilever + " --result /dev/full");
  EXPECT_EQ(outcome.exit_status, 1);
  EXPECT_NE(outcome.err.find("/dev/full: " + message), std::string::npos) << outcome.err;
}

TEST(Simulate, ExplainsItself) {
  const SceneFolder folder;
  for (const std::string flag : {"-h", "--help"}) {
    const Outcome outcome = simulate(folder, flag);
    EXPECT_EQ(outcome.exit_status, 0);
    EXPECT_NE(outcome.out.find("Usage: simulate [OPTIONS] SCENE"), std::string::npos);
  }
}

}  // namespace
}  // namespace soft_robot_lab
