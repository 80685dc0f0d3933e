// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/settings/yaml_node.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "settings/cpu_time.h"
#include "settings/read_file.h"
#include "settings/unit_limits.h"

namespace soft_robot_lab {
namespace {

YamlNode parse(const std::string& text) { return YamlNode::parse(text, "scene.yaml"); }

std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const SettingsError& error) {
    return error.what();
  }
  return "no error";
}

TEST(YamlNode, ReadsEveryKindOfValue) {
  const YamlNode node = parse(
      "size: 1.0e-5\nsame: 1e-5\nplus: +.5\ncount: -3\non: true\nname: \"Spinebot\"\nmodel: sliding\n"
      "at_m: [1, -2, 3.5]\nparts: [{a: 1}, {a: 2}]\n");
  EXPECT_EQ(node.number("size"), 1e-5);
  EXPECT_EQ(node.number("same"), 1e-5);
  EXPECT_EQ(node.number("plus"), 0.5);
  EXPECT_EQ(node.integer("count", -3, 3), -3);
  EXPECT_TRUE(node.boolean("on"));
  EXPECT_EQ(node.text("name"), "Spinebot");
  EXPECT_EQ(node.choice("model", {"springs", "sliding"}), "sliding");
  EXPECT_EQ(node.vector3("at_m"), Eigen::Vector3d(1, -2, 3.5));
  const std::vector<YamlNode> parts = node.sequence("parts");
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[1].number("a"), 2.0);
  EXPECT_EQ(parts[1].path(), "parts[1]");
  EXPECT_EQ(parts[0].number("a"), 1.0);
  EXPECT_NO_THROW(node.require_all_read());
}

TEST(YamlNode, HoldsNumbersWithinTheLimitOfTheirUnit) {
  const auto error = [](const std::string& text) {
    return error_of([&] { parse(text).vector3(text.substr(0, text.find(':'))); });
  };
  EXPECT_EQ(error("at_m: [1000, -1000, 0]"), "no error");
  EXPECT_EQ(error("at_m: [1, -1001, 0]"), "scene.yaml:1: at_m[1]: -1001 is out of range [-1000, 1000]");
  EXPECT_EQ(error("velocity_m_s: [0, 0, 1e300]"), "scene.yaml:1: velocity_m_s[2]: 1e300 is out of range [-1000, 1000]");
  for (const std::string key : {"a_s", "a_m_s2", "turn_rad", "turn_deg", "turn_rad_s", "size_m", "load_kg"})
    EXPECT_NE(error(key + ": [1e7, 0, 0]"), "no error") << key;
  for (const std::string key : {"stiffness_n_m", "mass_per_s", "size", "m", "modulus_pa"})
    EXPECT_EQ(error(key + ": [1e12, 0, 0]"), "no error") << key;
  EXPECT_NE(error("density_kg_m3: [2e9, 0, 0]"), "no error");
  const YamlNode node = parse("load_kg: 1e7\nsize_m: -1e9\nruns: [{time_s: 1e19}]\n");
  EXPECT_EQ(error_of([&] { node.number("load_kg", AllowedRange::positive()); }),
            "scene.yaml:1: load_kg: 1e7 is out of range [-1000000, 1000000]");
  EXPECT_EQ(error_of([&] { node.number("size_m", AllowedRange::positive()); }),
            "scene.yaml:2: size_m: -1e9 is out of range (0, inf)");
  EXPECT_THROW(node.sequence("runs")[0].number("time_s"), SettingsError);
}

TEST(UnitLimits, HoldValuesThatComeByServices) {
  EXPECT_NO_THROW(require_in_unit("target_m", Eigen::Vector3d(1, 2, -1000)));
  EXPECT_THROW(require_in_unit("target_m", Eigen::Vector3d(1, 2, 1e19)), std::invalid_argument);
  EXPECT_THROW(require_in_unit("turn_rad", 1e300), std::invalid_argument);
  EXPECT_THROW(require_in_unit("push_n", 1e10), std::invalid_argument);
  EXPECT_THROW(require_in_unit("pressure_pa", 1e14), std::invalid_argument);
  EXPECT_NO_THROW(require_in_unit("compliance_m_n", 1e11)) << "metres per newton";
  EXPECT_THROW(require_in_unit("turn_rad", std::nan("")), std::invalid_argument);
}

TEST(YamlNode, GivesDefaultsOnlyForAbsentKeys) {
  const YamlNode node = parse("wrong: word\nempty:\n");
  EXPECT_EQ(node.number_or("absent", 2.5), 2.5);
  EXPECT_EQ(node.integer_or("absent", 7, 0, 9), 7);
  EXPECT_TRUE(node.boolean_or("absent", true));
  EXPECT_EQ(node.text_or("absent", "x"), "x");
  EXPECT_EQ(node.choice_or("absent", "x", {"x", "y"}), "x");
  EXPECT_EQ(node.vector3_or("absent", {1, 2, 3}), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(node.optional_sequence("absent").empty());
  EXPECT_FALSE(node.optional_child("absent"));
  EXPECT_THROW(node.number_or("wrong", 1), SettingsError);
  EXPECT_THROW(node.integer_or("wrong", 1, 0, 9), SettingsError);
  EXPECT_THROW(node.boolean_or("wrong", true), SettingsError);
  EXPECT_THROW(node.choice_or("wrong", "x", {"x", "y"}), SettingsError);
  EXPECT_THROW(node.vector3_or("wrong", {1, 2, 3}), SettingsError);
  EXPECT_THROW(node.optional_sequence("wrong"), SettingsError);
  EXPECT_THROW(node.number_or("empty", 1), SettingsError);
  EXPECT_THROW(node.text_or("empty", "x"), SettingsError);
}

TEST(YamlNode, NamesFileLineKeyValueAndRange) {
  const YamlNode node = parse("cables:\n  - name: left\n    compliance_m_n: -1\n    model: glide\n");
  const YamlNode cable = node.sequence("cables")[0];
  EXPECT_EQ(error_of([&] { cable.number("compliance_m_n", AllowedRange::not_negative()); }),
            "scene.yaml:3: cables[0].compliance_m_n: -1 is out of range [0, inf)");
  EXPECT_EQ(error_of([&] {
              cable.choice("model", {"springs", "sliding"});
            }),
            "scene.yaml:4: cables[0].model: 'glide' is not one of springs, sliding");
  EXPECT_EQ(error_of([&] { cable.text("points_m"); }), "scene.yaml:2: cables[0]: key 'points_m' is missing");
  EXPECT_EQ(error_of([&] { cable.integer("name", 0, 1); }),
            "scene.yaml:2: cables[0].name: 'left' is not a whole number");
}

TEST(YamlNode, GuessesAMissingKeyFromOneThatNobodyRead) {
  const YamlNode node = parse("radus_m: 1\nstart_m: 2\n");
  EXPECT_EQ(error_of([&] { node.number("radius_m"); }),
            "scene.yaml:1: key 'radius_m' is missing (did you mean it by 'radus_m'?)");
  EXPECT_EQ(error_of([&] { node.number("end_m"); }), "scene.yaml:1: key 'end_m' is missing");
  node.number("start_m");
  EXPECT_EQ(error_of([&] { node.number("start"); }), "scene.yaml:1: key 'start' is missing") << "it has been read";
}

TEST(YamlNode, RefusesWhatIsNotAFiniteNumber) {
  for (const char* value : {"nan", ".nan", "inf", "-inf", ".inf", "1e999", "0x10", "1,5", "1.5m", "\"1.5\"", "''",
                            "+-1", "true", "~", "[1]", "{a: 1}"}) {
    const YamlNode node = parse(std::string("x: ") + value);
    EXPECT_THROW(node.number("x"), SettingsError) << value;
  }
  for (const char* value : {"1.0", "1e2", "99999999999999999999", "4", "-1", "\"1\""}) {
    EXPECT_THROW(parse(std::string("x: ") + value).integer("x", 0, 3), SettingsError) << value;
  }
  for (const char* value : {"True", "yes", "on", "1", "\"true\""}) {
    EXPECT_THROW(parse(std::string("x: ") + value).boolean("x"), SettingsError) << value;
  }
  for (const char* value : {"[1, 2]", "[1, 2, 3, 4]", "[1, 2, nan]", "[1, 2, [3]]", "1"}) {
    EXPECT_THROW(parse(std::string("x: ") + value).vector3("x"), SettingsError) << value;
  }
}

TEST(YamlNode, GuessesWhatWasMeantByATextThatIsNoNumber) {
  const auto error = [](const std::string& text) { return error_of([&] { parse("x_pa: " + text).number("x_pa"); }); };
  EXPECT_EQ(error("'1.5'"), "scene.yaml:1: x_pa: '1.5' is not a finite number but a text in quotes; leave these out");
  EXPECT_EQ(error("1,5"), "scene.yaml:1: x_pa: '1,5' is not a finite number: did you mean 1.5?");
  EXPECT_EQ(error("200 kPa"),
            "scene.yaml:1: x_pa: '200 kPa' is not a finite number: numbers have no unit; keys say which");
  EXPECT_EQ(error("two kPa"), "scene.yaml:1: x_pa: 'two kPa' is not a finite number");
}

TEST(YamlNode, KnowsOpenAndClosedRanges) {
  EXPECT_FALSE(AllowedRange::positive().contains(0.0));
  EXPECT_TRUE(AllowedRange::not_negative().contains(0.0));
  EXPECT_FALSE((AllowedRange{0, 0.5, false, true}).contains(0.5));
  EXPECT_TRUE((AllowedRange{0, 0.5}).contains(0.5));
  EXPECT_FALSE(AllowedRange::any().contains(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(AllowedRange::any().contains(std::numeric_limits<double>::infinity()));
  EXPECT_EQ((AllowedRange{0, 0.5, false, true}).to_string(), "[0, 0.5)");
  EXPECT_EQ(AllowedRange::positive().to_string(), "(0, inf)");
  EXPECT_EQ(AllowedRange::any().to_string(), "(-inf, inf)");
}

TEST(YamlNode, RefusesKeysThatNobodyRead) {
  const YamlNode node = parse("body:\n  element: linear\n  materal: {}\n");
  const YamlNode body = node.child("body");
  body.text("element");
  body.optional_child("material");
  EXPECT_EQ(error_of([&] { node.require_all_read(); }),
            "scene.yaml:3: body: unknown key 'materal' (did you mean 'material'?); known here: element, material");
}

TEST(YamlNode, RefusesUnreadKeysInsideLists) {
  const YamlNode node = parse("list:\n- a: 1\n- a: 1\n  zzzzzz: 2\n");
  for (const YamlNode& item : node.sequence("list")) item.number("a");
  EXPECT_EQ(error_of([&] { node.require_all_read(); }), "scene.yaml:4: list[1]: unknown key 'zzzzzz'; known here: a");
}

TEST(YamlNode, AskingWhetherAKeyIsThereDoesNotReadIt) {
  const YamlNode node = parse("a: 1");
  EXPECT_TRUE(node.has("a"));
  EXPECT_FALSE(node.has("b"));
  EXPECT_EQ(error_of([&] { node.require_all_read(); }), "scene.yaml:1: key 'a' has no use here");
}

TEST(YamlNode, RefusesWhatIsNotOneYamlDocument) {
  EXPECT_EQ(error_of([] { parse("a: 1\nb: 2\na: 3\n"); }), "scene.yaml:3: key 'a' stands twice, first in line 1");
  EXPECT_EQ(error_of([] { parse("x:\n  {a: 1,\n   a: 2}\n"); }),
            "scene.yaml:3: x: key 'a' stands twice, first in line 2");
  EXPECT_EQ(error_of([] { parse("a: 1\nb: [1, 2\n"); }).rfind("scene.yaml:", 0), 0u);
  EXPECT_NE(error_of([] { parse("a: 1\nb: c: d\n"); }).find("scene.yaml:2: not YAML"), std::string::npos);
  for (const std::string& open : {std::string("["), std::string("{a: ")}) {
    std::string deep;
    for (int i = 0; i < 600; ++i) deep += open;
    EXPECT_NE(error_of([&] { parse(deep); }).find("scene.yaml:1: nested too deep"), std::string::npos);
  }
  EXPECT_THROW(parse(""), SettingsError);
  EXPECT_THROW(parse("a: 1\n---\nb: 2\n"), SettingsError);
  EXPECT_THROW(parse("[1, 2]: 3"), SettingsError);
  EXPECT_EQ(error_of([] { parse(std::string("a: 1\nb: \0\n", 10)); }),
            "scene.yaml:2: not YAML: holds a byte of value 0, as no text does");
  EXPECT_THROW(YamlNode::load_file("/no/such/file.yaml"), SettingsError);
  EXPECT_THROW(YamlNode::load_file("/"), SettingsError);
}

TEST(YamlNode, RefusesDocumentsThatUnfoldWithoutEnd) {
  const std::string in_itself = error_of([] { parse("a: &a [*a]"); });
  EXPECT_NE(in_itself.find("an alias may stand within its own anchor"), std::string::npos) << in_itself;
  EXPECT_LT(in_itself.size(), 200u) << in_itself;
  std::string bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string below = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int j = 0; j < 9; ++j) bomb += below + ", ";
    bomb += below + "]\n";
  }
  EXPECT_THROW(parse(bomb), SettingsError);
}

// Few nodes, but each repeats a long text, or a long list of short ones.
TEST(YamlNode, CountsTheBytesThatAliasesRepeat) {
  std::string text = "long: &long " + std::string(1000000, 'x') + "\nall: [";
  for (int i = 0; i < 1000; ++i) text += "*long, ";
  EXPECT_NE(error_of([&] { parse(text + "1]\n"); }).find("too large"), std::string::npos);
  text = "list: &list [";
  for (int i = 0; i < 3000; ++i) text += "1, ";
  text += "1]\nall: [";
  for (int i = 0; i < 3000; ++i) text += "*list, ";
  EXPECT_NE(error_of([&] { parse(text + "1]\n"); }).find("too large"), std::string::npos);
}

TEST(YamlNode, RefusesTextsOfTooManyNodes) {
  std::string text = "[";
  for (int i = 0; i < 600000; ++i) text += "1,";
  EXPECT_NE(error_of([&] { parse(text + "1]"); }).find("more than 500000 values and keys"), std::string::npos);
}

// 1e10 comparisons of keys, were they quadratic, would take a minute.
TEST(YamlNode, ReadsAHundredThousandKeys) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += "a_rather_long_common_beginning_of_keys_" + std::to_string(i) + ": 1\n";
  const double start_s = cpu_time_s();
  const YamlNode node = parse(text);
  EXPECT_NE(error_of([&] { node.require_all_read(); }).find("unknown key"), std::string::npos);
  EXPECT_LT(cpu_time_s() - start_s, 10.0);
}

TEST(YamlNode, ReadsRegularFilesOnly) {
  const std::string pipe = testing::TempDir() + "yaml_node_test.pipe", large = pipe + ".large";
  unlink(pipe.c_str());
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(error_of([&] { YamlNode::load_file(pipe); }), pipe + ": cannot be read: it is no regular file");
  EXPECT_EQ(error_of([] { YamlNode::load_file("/dev/zero"); }), "/dev/zero: cannot be read: it is no regular file");
  EXPECT_EQ(error_of([] { YamlNode::load_file("/"); }), "/: cannot be read: it is a folder");
  EXPECT_EQ(error_of([] { YamlNode::load_file(""); }), "'': cannot be read: No such file or directory");
  std::ofstream(large) << "a: 1\n";
  std::filesystem::resize_file(large, kLargestSettings_bytes + 1);
  EXPECT_EQ(error_of([&] { YamlNode::load_file(large); }),
            large + ": cannot be read: 16777217 bytes are out of range [0, 16777216]");
  unlink(pipe.c_str());
  unlink(large.c_str());
}

TEST(YamlNode, LoadsAFileUnderItsName) {
  const std::string path = testing::TempDir() + "yaml_node_test.yaml";
  std::ofstream(path) << "# comment\nmass_kg: -2\n";
  const YamlNode node = YamlNode::load_file(path);
  EXPECT_EQ(node.source(), path);
  EXPECT_EQ(error_of([&] { node.number("mass_kg", AllowedRange::positive()); }),
            path + ":2: mass_kg: -2 is out of range (0, inf)");
}

TEST(MergeSettings, LaysMapsOverEachOtherAndReplacesTheRest) {
  const YamlNode robot =
      YamlNode::parse("body: {size: 1, element: linear}\nlist: [1, 2]\nonly_robot: 5\n", "robot.yaml");
  const YamlNode scene = YamlNode::parse("\nbody:\n  size: 2\nlist: [3]\n", "scene.yaml");
  const YamlNode both = merge_settings(robot, scene);
  EXPECT_EQ(both.child("body").number("size"), 2.0);
  EXPECT_EQ(both.child("body").text("element"), "linear");
  EXPECT_EQ(both.sequence("list").size(), 1u);
  EXPECT_EQ(both.number("only_robot"), 5.0);
  EXPECT_NO_THROW(both.require_all_read());
  EXPECT_THROW(robot.require_all_read(), SettingsError);  // reading the merged one does not read its parents
}

TEST(MergeSettings, ReplacesAMapByOneThatNamesItsPresetOrModel) {
  const YamlNode robot = parse("material: {stiffness: 1, density: 2}\n");
  EXPECT_EQ(merge_settings(robot, parse("material: {preset: soft}\n")).child("material").keys().size(), 1u);
  EXPECT_EQ(merge_settings(robot, parse("material: {model: hard, density: 3}\n")).child("material").keys().size(), 2u);
  EXPECT_EQ(merge_settings(robot, parse("material: {colour: red}\n")).child("material").keys().size(), 3u);
}

TEST(MergeSettings, ChangesItemsOfAListByTheirPlaces) {
  const YamlNode robot = YamlNode::parse("box: {size_m: [1, 2, 3]}\npoints: [[1, 2], [3, 4]]\n", "robot.yaml");
  const YamlNode both = merge_settings(robot, parse("box: {size_m: {\"[1]\": 5}}\npoints: {\"[1]\": {\"[0]\": 6}}\n"));
  EXPECT_EQ(both.child("box").vector3("size_m"), Eigen::Vector3d(1, 5, 3));
  EXPECT_EQ(both.sequence("points")[0].as_numbers(), Eigen::Vector2d(1, 2));
  EXPECT_EQ(both.sequence("points")[1].as_numbers(), Eigen::Vector2d(6, 4));
  EXPECT_EQ(robot.child("box").vector3("size_m"), Eigen::Vector3d(1, 2, 3));
  EXPECT_NE(
      error_of([&] { merge_settings(robot, parse("points: {\"[2]\": 1}\n")); }).find("no place [2] in a list of 2"),
      std::string::npos);
  EXPECT_THROW(merge_settings(robot, parse("points: {\"[0]\": 1, left: 2}\n")), SettingsError);
}

TEST(MergeSettings, ChangesItemsOfAListByTheirNames) {
  const YamlNode robot =
      YamlNode::parse("cables:\n  - {name: left, points: 3}\n  - {name: right, points: 4}\n", "robot.yaml");
  const YamlNode both = merge_settings(robot, parse("cables: {right: {model: friction}}\n"));
  const std::vector<YamlNode> cables = both.sequence("cables");
  ASSERT_EQ(cables.size(), 2u);
  EXPECT_FALSE(cables[0].has("model"));
  EXPECT_EQ(cables[1].text("model"), "friction");
  EXPECT_EQ(cables[1].number("points"), 4.0);
  EXPECT_FALSE(robot.sequence("cables")[1].has("model"));

  const auto refusal = [&](const std::string& overrides) {
    return error_of([&] { merge_settings(robot, YamlNode::parse(overrides, "lab.yaml")); });
  };
  EXPECT_EQ(refusal("\ncables: {rigth: {points: 5}}\n"), "lab.yaml:2: cables.rigth: 'rigth' is not one of left, right");
  EXPECT_EQ(refusal("cables: {left: 5}\n"), "lab.yaml:1: cables.left: must hold keys and values that change 'left'");
  EXPECT_EQ(error_of([&] { merge_settings(parse("list: [1, 2]\n"), parse("list: {a: {b: 1}}\n")); }),
            "scene.yaml:1: list: has items without a name, so that they cannot be changed by it");
}

TEST(MergeSettings, KeepsTheFileAndLineOfEachMember) {
  const YamlNode robot = YamlNode::parse("body:\n  size: 1\n  colour: blue\n", "robot.yaml");
  const YamlNode scene = YamlNode::parse("\n\nbody:\n  density: -1\n", "scene.yaml");
  const YamlNode both = merge_settings(robot, scene);
  const YamlNode body = both.child("body");
  EXPECT_EQ(error_of([&] { body.number("density", AllowedRange::positive()); }),
            "scene.yaml:4: body.density: -1 is out of range (0, inf)");
  EXPECT_EQ(error_of([&] { body.number("size", {2, 3}); }), "robot.yaml:2: body.size: 1 is out of range [2, 3]");
  EXPECT_EQ(error_of([&] { both.require_all_read(); }),
            "robot.yaml:3: body: unknown key 'colour'; known here: density, size");
}

TEST(MergeSettings, RemembersWhatWasReadBefore) {
  const YamlNode scene = parse("robot: robot.yaml\n");
  scene.text("robot");
  EXPECT_NO_THROW(merge_settings(parse("{}"), scene).require_all_read());
}

TEST(YamlNode, DumpsTheSameTextForTheSameContent) {
  const YamlNode a = parse("b: [1.5, word, \"2\", true]\na: {y: 'quote\" \\ \t', x:}\n");
  const YamlNode b = parse("a:\n  x: ~\n  y: \"quote\\\" \\\\ \\t\"\nb:\n- 1.5\n- \"word\"\n- '2'\n- true\n");
  EXPECT_EQ(a.dump(), b.dump());
  EXPECT_EQ(parse(a.dump()).dump(), a.dump());
  EXPECT_NO_THROW(a.require_all_read());
  EXPECT_EQ(parse(a.dump()).child("b").items()[0].as_number(), 1.5);
  EXPECT_THROW(parse(a.dump()).child("b").items()[2].as_number(), SettingsError);
  EXPECT_NE(parse("a: [1, 2]").dump(), parse("a: [2, 1]").dump());
}

}  // namespace
}  // namespace soft_robot_lab
