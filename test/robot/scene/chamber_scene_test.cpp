// SPDX-License-Identifier: BSD-3-Clause
// Chambers as scene files describe them.
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

SceneOptions chamber_options() {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return options;
}

// A block of 40 mm with a closed hollow and one that opens to the side.
std::string block(const std::string& chambers, const std::string& more = "") {
  return R"(body:
  solid:
    difference:
      - {name: skin, box: {size_m: [0.04, 0.04, 0.04], center_m: [0, 0, 0]}}
      - {name: cavity, box: {size_m: [0.01, 0.02, 0.02], center_m: [-0.01, 0, 0]}}
      - box: {size_m: [0.02, 0.01, 0.01], center_m: [0.02, 0, 0]}
  element_size_m: 0.02
  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, -0.0199]}}]
markers: [{name: top, position_m: [0, 0, 0.02]}]
chambers:
)" + chambers +
         more;
}

const char* const kTwo = R"(  - {name: closed, surface: cavity}
  - name: open
    surface: {solid: {box: {size_m: [0.02, 0.01, 0.01], center_m: [0.02, 0, 0]}}}
    command: syringe
    syringe_volume_ml: 5
)";

TEST(ChamberScene, BindsBySurfaceNameOrBySolid) {
  const SceneFolder folder;
  const std::string run = "run: {sensitivity: true, commands: [{closed: 1.5, open: 0.5}]}\n";
  Scene scene = load_scene(folder.write("block.yaml", block(kTwo, run)), chamber_options());
  const RunReport report = run_scene(scene);
  ASSERT_TRUE(report.solve.converged) << report.solve.message;
  EXPECT_EQ(report.sensitivity.cols(), 2);
  const nlohmann::json chambers = nlohmann::json::parse(result_json(scene, report))["chambers"];
  EXPECT_NEAR(chambers["closed"]["initial_volume_m3"], 4e-6, 1e-15);
  EXPECT_NEAR(chambers["open"]["initial_volume_m3"], 1e-6, 1e-15);
  for (const std::string name : {"closed", "open"}) {
    const nlohmann::json& chamber = chambers[name];
    EXPECT_GT(chamber["volume_m3"], chamber["initial_volume_m3"]) << name;
    EXPECT_GT(chamber["gauge_pressure_pa"], 100.0) << name;
    EXPECT_LT(std::abs(chamber["gas_residual"].get<double>()), 1e-6) << name;
  }
}

// A flat chamber under a membrane that is sucked onto its bottom, 5 mm above the clamp and 1.5 mm thick.
TEST(ChamberScene, OfLessThanNoVolumeIsNoRestState) {
  const std::string scene = R"(body:
  solid:
    difference:
      - box: {size_m: [0.04, 0.04, 0.0095], center_m: [0, 0, 0.00475]}
      - {name: hollow, box: {size_m: [0.03, 0.03, 0.003], center_m: [0, 0, 0.0065]}}
  element_size_m: 0.005
  material: {youngs_modulus_pa: 150000, poissons_ratio: 0.49}
  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, 1.0e-6]}}]
chambers: [{name: air, surface: hollow, command: gauge_pressure, min_gauge_pressure_pa: -20000}]
markers: [{name: middle, position_m: [0, 0, 0.0095]}]
run: {commands: [{air: -8000}]}
)";
  const SceneFolder folder;
  Scene open = load_scene(folder.write("open.yaml", scene), chamber_options());
  const RunReport through = run_scene(open);
  EXPECT_FALSE(through.solve.converged);
  EXPECT_NE(through.solve.message.find("actuator air: a volume of -"), std::string::npos) << through.solve.message;
  EXPECT_NE(through.solve.message.find("contact: {self: true}"), std::string::npos) << through.solve.message;
  Scene closed = load_scene(folder.write("closed.yaml", scene + "contact: {self: true}\n"), chamber_options());
  const RunReport on = run_scene(closed);
  ASSERT_TRUE(on.solve.converged) << on.solve.message;
  const nlohmann::json result = nlohmann::json::parse(result_json(closed, on));
  EXPECT_NEAR(result["chambers"]["air"]["volume_m3"].get<double>(), 4.6e-7, 0.1e-7);
  EXPECT_NEAR(closed.simulation->marker_position(0).z(), 6.48e-3, 0.05e-3);
}

TEST(ChamberScene, RefusesWhatItCannotFind) {
  struct BadChamber {
    std::string text, words;
  };
  const std::string box = "box: {size_m: [0.02, 0.01, 0.02], center_m: [0.02, 0, 0]}";
  const std::vector<BadChamber> table = {
      {block("  - {name: a, surface: hole}\n"),
       "chambers[0].surface: the mesh has no surface 'hole'; known: cavity, skin"},
      {block("  - {name: a, surface: {solid: {" + box + "}}}\n"),
       "chambers[0].surface: is none of the 2 solids that a difference of body.solid takes away"},
      {block("  - {name: a, surface: skin}\n"), "chambers[0].surface: "},
      {block("  - {name: a, surface: cavity, beta: 2}\n"), "unknown key 'beta'"},
      {block(kTwo, "run: {commands: [{closed: -1}]}\n"),
       "closed: -1 is out of range [0.05, 5]; min_beta of 'closed' moves that limit"},
      {block(kTwo, "run: {commands: [{open: 6}]}\n"), "open: 6 is out of range [0, 5]"},
  };
  const SceneFolder folder;
  for (const BadChamber& bad : table) {
    SCOPED_TRACE(bad.words);
    try {
      load_scene(folder.write("bad.yaml", bad.text), chamber_options());
      ADD_FAILURE() << "accepted";
    } catch (const SettingsError& error) {
      EXPECT_NE(std::string(error.what()).find(bad.words), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
