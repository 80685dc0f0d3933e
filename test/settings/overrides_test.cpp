// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/settings/overrides.h"

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

YamlNode parse(const std::string& text) { return YamlNode::parse(text, "robot.yaml"); }

const char* const kRobot =
    "body: {size_m: 0.01, colour: blue}\n"
    "cables:\n"
    "  - {name: left, points_m: [[0, 0, 0], [1, 2, 3]]}\n"
    "  - {name: right, points_m: [[0, 0, 0], [1, 2, 3]]}\n";

TEST(Overrides, KeepEveryBitOfANumber) {
  for (const double number : {0.1, 1.0 / 3.0, 1e-300, -2.5e22, 3.0, 123456789.0}) {
    const YamlNode both = Overrides().set({"body", "factor"}, number).over(parse(kRobot));
    EXPECT_EQ(both.child("body").number("factor"), number);
    EXPECT_EQ(parse(Overrides().set({"n"}, number).text()).number("n"), number);
  }
}

TEST(Overrides, AreReadAsWhatTheyAre) {
  const YamlNode both = Overrides()
                            .set({"count"}, 1000000)
                            .set({"yes"}, true)
                            .set({"word"}, "5")
                            .set({"place"}, Eigen::Vector3d(1, 2, 3))
                            .set({"path"}, std::vector<Eigen::Vector3d>{{1, 2, 3}, {4, 5, 6}})
                            .over(parse(kRobot));
  EXPECT_EQ(both.integer("count", 0, 2000000), 1000000);
  EXPECT_TRUE(both.boolean("yes"));
  EXPECT_EQ(both.text("word"), "5");
  EXPECT_THROW(both.number("word"), SettingsError);
  EXPECT_EQ(both.vector3("place"), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(both.sequence("path")[1].as_numbers()[2], 6.0);
}

TEST(Overrides, ChangeWhatTheyNameAndNothingElse) {
  const YamlNode robot = parse(kRobot);
  Overrides overrides;
  overrides.set({"body", "size_m"}, 0.02).set({"cables", "right", "model"}, "friction");
  const Overrides before = overrides;
  overrides.set({"body", "size_m"}, 0.03);
  const YamlNode both = overrides.over(robot);
  EXPECT_EQ(both.child("body").number("size_m"), 0.03);
  EXPECT_EQ(both.child("body").text("colour"), "blue");
  EXPECT_FALSE(both.sequence("cables")[0].has("model"));
  EXPECT_EQ(both.sequence("cables")[1].sequence("points_m").size(), 2u);
  EXPECT_EQ(before.over(robot).child("body").number("size_m"), 0.02) << "a copy changes with its original";
  EXPECT_EQ(robot.child("body").number("size_m"), 0.01);
}

// A key `model` replaces its neighbours where settings are merged, but not where it is set.
TEST(Overrides, SetAKeyBesideOthers) {
  Overrides overrides(parse("cables: [{name: left, via: given}, {name: right}]"));
  overrides.set({"cables", "left", "model"}, "friction").set({"cables", "[1]", "model"}, "springs");
  const std::vector<YamlNode> cables = overrides.over(parse(kRobot)).sequence("cables");
  EXPECT_EQ(cables[0].text("via"), "given");
  EXPECT_EQ(cables[0].text("model"), "friction");
  EXPECT_EQ(cables[1].text("model"), "springs");
  EXPECT_THROW(overrides.set({"cables", "middle", "model"}, "springs"), SettingsError);
}

TEST(Overrides, LayOverOneAnother) {
  Overrides overrides = Overrides().set({"a", "b"}, 1).set({"a", "c"}, 2);
  overrides.lay(Overrides().set({"a", "c"}, 3)).lay({});
  const YamlNode both = overrides.over(parse("a: {d: 4}"));
  EXPECT_EQ(both.child("a").number("b") + both.child("a").number("c") + both.child("a").number("d"), 8.0);
  EXPECT_TRUE(overrides.has({"a", "b"}));
  EXPECT_FALSE(overrides.has({"a", "d"}));
  EXPECT_FALSE(overrides.empty());
  EXPECT_TRUE(Overrides().empty());
}

// What stands in one file and is laid over another counts as read in the first, and is read strictly in the second.
TEST(Overrides, AreReadStrictlyWhereTheyEndUp) {
  const YamlNode experiment = YamlNode::parse("over: {body: {size_m: -1, blue: 1}}", "experiment.yaml");
  const Overrides overrides(experiment.child("over"));
  experiment.require_all_read();
  for (int i = 0; i < 2; ++i) {
    const YamlNode both = overrides.over(parse(kRobot));
    try {
      both.child("body").number("size_m", AllowedRange::positive());
      ADD_FAILURE() << "accepted";
    } catch (const SettingsError& error) {
      EXPECT_STREQ(error.what(), "experiment.yaml:1: over.body.size_m: -1 is out of range (0, inf)");
    }
    EXPECT_THROW(both.require_all_read(), SettingsError);
  }
}

TEST(Overrides, AreNamedInErrors) {
  const YamlNode both = Overrides()
                            .set({"body", "size_m"}, -1.0)
                            .set({"list"}, std::vector<OverrideValue>{Overrides().set({"x"}, "far")})
                            .over(parse(kRobot));
  const auto refusal = [](const auto& read) -> std::string {
    try {
      read();
    } catch (const SettingsError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal([&] { both.child("body").number("size_m", AllowedRange::positive()); }),
            "robot.yaml (with changes):1: body.size_m: -1 is out of range (0, inf)");
  EXPECT_EQ(refusal([&] { both.sequence("list")[0].number("x"); }),
            "robot.yaml (with changes):1: list[0].x: 'far' is not a finite number");
}

}  // namespace
}  // namespace soft_robot_lab
