// SPDX-License-Identifier: BSD-3-Clause
#include "control/configuration_table.h"

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

std::vector<Configuration> read(const std::string& text) {
  return read_configurations(YamlNode::parse(text, "table.yaml"));
}

// What it says of a wrong table; empty where it takes it.
std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const SettingsError& error) {
    return error.what();
  }
  return "";
}

TEST(ConfigurationTable, KeepsItsOrder) {
  const auto table = read("configurations: [{name: c, contractions: [1, 1]}, {name: a, contractions: [0.8, 1.1]}]");
  ASSERT_EQ(table.size(), 2U);
  EXPECT_EQ(table[0].name, "c");
  EXPECT_EQ(table[1].name, "a");
  EXPECT_EQ(table[1].commands, (std::vector<double>{0.8, 1.1}));
}

TEST(ConfigurationTable, TakesMillilitresOfSyringes) {
  const auto table = read("configurations: [{name: a, syringe_ml: [0, 0, 80]}]");
  EXPECT_EQ(table[0].commands, (std::vector<double>{0.0, 0.0, 80.0}));
  EXPECT_TRUE(commands_syringes(YamlNode::parse("configurations: [{syringe_ml: [0]}]", "table.yaml")));
  EXPECT_FALSE(commands_syringes(YamlNode::parse("configurations: [{contractions: [1]}]", "table.yaml")));
}

TEST(ConfigurationTable, TakesCommandsOfAnyActuators) {
  const auto table = read("configurations: [{name: a, commands: [0, 20000]}, {name: b, commands: [-5000, 1]}]");
  ASSERT_EQ(table.size(), 2U);
  EXPECT_EQ(table[0].commands, (std::vector<double>{0.0, 20000.0}));
  EXPECT_EQ(table[1].commands, (std::vector<double>{-5000.0, 1.0}));
  EXPECT_FALSE(commands_syringes(YamlNode::parse("configurations: [{commands: [1]}]", "table.yaml")));
}

TEST(ConfigurationTable, RefusesWhatIsNoTable) {
  EXPECT_NE(refusal("configurations: []").find("configurations is empty"), std::string::npos);
  EXPECT_NE(refusal("configurations: [{name: a, contractions: []}]").find("contractions is empty"), std::string::npos);
  EXPECT_NE(refusal("configurations: [{name: '', contractions: [1]}]").find("name is empty"), std::string::npos);
  EXPECT_NE(refusal("configurations: [{name: a, contractions: [0]}]").find("(0, inf)"), std::string::npos);
  EXPECT_NE(
      refusal("configurations: [{name: a, contractions: [1]}, {name: b, syringe_ml: [1]}]").find("'contractions'"),
      std::string::npos);
  EXPECT_NE(refusal("configurations: [{name: a, commands: [1]}, {name: b, contractions: [1]}]").find("'commands'"),
            std::string::npos);
  EXPECT_NE(refusal("configurations: [{name: a, contractions: [1]}, {name: a, contractions: [1]}]").find("'a'"),
            std::string::npos);
  EXPECT_NE(refusal("configurations: [{name: a, contractions: [1, 1]}, {name: b, contractions: [1]}]")
                .find("has 1 numbers, the first configuration 2"),
            std::string::npos);
}

}  // namespace
}  // namespace soft_robot_lab
