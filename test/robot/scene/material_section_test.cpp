// SPDX-License-Identifier: BSD-3-Clause
// `body.material` in scene files: models, their constants, and the presets of config/materials.
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "robot/scene/sections.h"
#include "settings/reference_table.h"

namespace soft_robot_lab {
namespace {

Material read(const std::string& yaml) {
  const YamlNode node = YamlNode::parse(yaml, "scene");
  const Material material = read_material(node);
  node.require_all_read();
  return material;
}

TEST(MaterialSection, ReadsEveryModel) {
  EXPECT_EQ(read("{}").youngs_modulus_pa, Material().youngs_modulus_pa);
  EXPECT_EQ(read("{model: neo_hookean, youngs_modulus_pa: 1.0e5}").youngs_modulus_pa, 1.0e5);
  const Material rivlin = read("{model: mooney_rivlin, c10_pa: 2.0e4, c01_pa: 1.0e4, poissons_ratio: 0.45}");
  EXPECT_EQ(rivlin.model, MaterialModel::mooney_rivlin);
  EXPECT_NEAR(rivlin.c10_pa(), 2.0e4, 1e-9);
  EXPECT_NEAR(rivlin.youngs_modulus_pa, 6.0e4 * 2 * 1.45, 1e-9);
  const Material yeoh = read("{model: yeoh, c1_pa: 2.0e4, c2_pa: -5.0, c3_pa: 1.0, density_kg_m3: 1100}");
  EXPECT_EQ(yeoh.model, MaterialModel::yeoh);
  EXPECT_NEAR(yeoh.c10_pa(), 2.0e4, 1e-9);
  EXPECT_EQ(yeoh.c2_pa, -5.0);
  EXPECT_EQ(yeoh.c3_pa, 1.0);
  EXPECT_EQ(yeoh.density_kg_m3, 1100.0);
}

TEST(MaterialSection, PresetsMayHaveAnotherPoissonsRatioAndDensity) {
  const Material soft = read("{preset: ecoflex_00_30}");
  const Material changed = read("{preset: ecoflex_00_30, poissons_ratio: 0.49, density_kg_m3: 1000}");
  EXPECT_NEAR(changed.lame_mu_pa(), soft.lame_mu_pa(), 1e-9);
  EXPECT_EQ(changed.c2_pa, soft.c2_pa);
  EXPECT_EQ(changed.poissons_ratio, 0.49);
  EXPECT_EQ(changed.density_kg_m3, 1000.0);
}

TEST(MaterialSection, ScalesEveryModulusByItsRatio) {
  EXPECT_NEAR(read("{youngs_modulus_pa: 1.0e5, stiffness_ratio: 1.15}").youngs_modulus_pa, 1.15e5, 1e-9);
  const Material rivlin = read("{model: mooney_rivlin, c10_pa: 2.0e4, c01_pa: 1.0e4, stiffness_ratio: 2}");
  EXPECT_NEAR(rivlin.c10_pa(), 4.0e4, 1e-9);
  EXPECT_NEAR(rivlin.c01_pa, 2.0e4, 1e-9);
  const Material yeoh = read("{model: yeoh, c1_pa: 2.0e4, c2_pa: -5.0, c3_pa: 1.0, stiffness_ratio: 0.5}");
  EXPECT_NEAR(yeoh.c10_pa(), 1.0e4, 1e-9);
  EXPECT_EQ(yeoh.c2_pa, -2.5);
  EXPECT_EQ(yeoh.c3_pa, 0.5);
}

TEST(MaterialSection, RefusesWithTheFixInTheMessage) {
  const std::pair<const char*, const char*> cases[] = {
      {"{preset: ecoflex_00_60}", "dragon_skin_10, dragon_skin_30, ecoflex_00_30, ecoflex_00_50"},
      {"{preset: ecoflex_00_50, youngs_modulus_pa: 1.0e5}", "belongs to the preset 'ecoflex_00_50'"},
      {"{preset: ecoflex_00_50, model: yeoh}", "belongs to the preset"},
      {"{model: ogden}", "neo_hookean, mooney_rivlin, yeoh"},
      {"{model: yeoh, youngs_modulus_pa: 1.0e5}", "c1_pa"},
      {"{model: yeoh, c1_pa: 1.0e4, youngs_modulus_pa: 1.0e5}", "youngs_modulus_pa"},
      {"{model: mooney_rivlin, c10_pa: 1.0e4}", "c01_pa"},
      {"{model: mooney_rivlin, c10_pa: 1.0e4, c01_pa: -1.0}", "c01_pa: -1 is out of range [0"},
      {"{c10_pa: 1.0e4}", "c10_pa"}};
  for (const auto& [yaml, words] : cases) {
    try {
      read(yaml);
      ADD_FAILURE() << yaml;
    } catch (const SettingsError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
}

// Each preset against the tensile test that its file names as its source.
TEST(MaterialSection, PresetsStretchAsTheirSilicone) {
  std::map<std::string, double> worst;
  for (const ReferenceRow& row :
       read_reference(std::string(SOFT_ROBOT_LAB_SOURCE) + "/test/data", "silicone_tension")) {
    const Material material = read("{preset: " + row.text("material") + "}");
    const double stretch = 1.0 + row.number("strain"), measured_pa = row.number("nominal_stress_pa");
    const double phi = stretch * stretch + 2.0 / stretch - 3.0;
    const double stress_pa =
        2.0 * (stretch - 1.0 / (stretch * stretch)) * (material.c10_pa() + 2.0 * material.c2_pa * phi);
    double& off = worst[row.text("material")];
    off = std::max(off, std::abs(stress_pa / measured_pa - 1.0));
  }
  ASSERT_EQ(worst.size(), 4u);
  for (const auto& [name, off] : worst) EXPECT_LT(off, 0.083) << name;
  for (const auto& file : std::filesystem::directory_iterator(std::string(SOFT_ROBOT_LAB_SOURCE) + "/config/materials"))
    EXPECT_TRUE(worst.count(file.path().stem().string())) << file.path();
}

}  // namespace
}  // namespace soft_robot_lab
