// SPDX-License-Identifier: BSD-3-Clause
// What the panel knows beside actuators: lamps, poses, and services that are asked on threads.
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "ros/panel/calls.h"
#include "ros/panel/framing.h"
#include "geometry/convex_hull.h"
#include "ros/panel/history.h"
#include "ros/panel/lamps.h"
#include "ros/panel/poses.h"
#include "ros/panel/reachable_tips.h"
#include "ros/panel/robot_choices.h"
#include "ros/panel/turn_watch.h"

namespace soft_robot_lab {
namespace {

using Level = Lamp::Level;

diagnostic_msgs::DiagnosticArray diagnosis(const std::string& name, int level, const std::string& message,
                                           const std::string& factor = "") {
  diagnostic_msgs::DiagnosticArray array;
  array.status.resize(1);
  array.status[0].name = name;
  array.status[0].level = static_cast<signed char>(level);
  array.status[0].message = message;
  if (!factor.empty()) {
    array.status[0].values.resize(1);
    array.status[0].values[0].key = "real-time factor";
    array.status[0].values[0].value = factor;
  }
  return array;
}

TEST(Lamps, AreGreyBeforeAnythingIsHeard) {
  const auto lamps = Lamps().lamps(0.0);
  ASSERT_EQ(lamps.size(), 2u);  // no rig, no gap
  for (const Lamp& lamp : lamps) EXPECT_EQ(lamp.level, Level::unknown);
}

TEST(Lamps, ShowTheSimulationAndItsSpeed) {
  Lamps lamps;
  lamps.add(diagnosis("simulator: simulation", 0, "runs", "0.998"), 0.0);
  EXPECT_EQ(lamps.lamps(0.5)[0].level, Level::ok);
  EXPECT_EQ(lamps.lamps(0.5)[1].value, "1.00 x");
  lamps.add(diagnosis("simulator: simulation", 1, "steps that did not converge", "0.4"), 1.0);
  EXPECT_EQ(lamps.lamps(1.5)[0].level, Level::warn);
  EXPECT_EQ(lamps.lamps(1.5)[0].reason, "steps that did not converge");
  EXPECT_EQ(lamps.lamps(1.5)[1].level, Level::warn);
}

TEST(Lamps, SayInTheWindowWhatLasts) {
  Lamps lamps;
  diagnostic_msgs::DiagnosticArray solves = diagnosis("simulator: simulation", 1, "solving for 12 s; Stop ends it");
  solves.status[0].values.resize(1);
  solves.status[0].values[0].key = "lasts [s]";
  solves.status[0].values[0].value = "12";
  lamps.add(solves, 0.0);
  EXPECT_EQ(lamps.lamps(0.5)[0].value, "solving for 12 s; Stop ends it");
  EXPECT_EQ(lamps.lamps(0.5)[1].value, "0.00 x");
  lamps.add(diagnosis("simulator: simulation", 0, "runs", "1"), 1.0);
  EXPECT_EQ(lamps.lamps(1.5)[0].value, "");
}

TEST(Lamps, ShowHowSqueezedTheSiliconeIsAndWhatItTouches) {
  Lamps lamps;
  auto heard = diagnosis("simulator: simulation", 0, "runs", "1");
  heard.status[0].values.resize(3);
  heard.status[0].values[1].key = "least det F";
  heard.status[0].values[2].key = "contact force [N]";
  const auto shown = [&](const std::string& least, const std::string& force) {
    heard.status[0].values[1].value = least;
    heard.status[0].values[2].value = force;
    lamps.add(heard, 0.0);
    return lamps.lamps(0.5);
  };
  ASSERT_EQ(shown("0.9", "0").size(), 4u);
  EXPECT_EQ(shown("0.9", "0")[2].level, Level::ok);
  EXPECT_EQ(shown("0.9", "0")[3].value, "none");
  EXPECT_EQ(shown("0.1", "1.5")[2].level, Level::warn);
  EXPECT_EQ(shown("-0.01", "1.5")[2].level, Level::error);
  EXPECT_EQ(shown("0.9", "1.5")[3].value, "1.50 N");
  EXPECT_EQ(lamps.lamps(Lamps::silence_s + 1.0).size(), 2u);
}

TEST(Lamps, ShowHowARobotIsReduced) {
  Lamps lamps;
  auto heard = diagnosis("simulator: simulation", 0, "runs", "1");
  const auto shown = [&](const std::vector<std::pair<std::string, std::string>>& said) {
    heard.status[0].values.resize(1 + said.size());
    for (std::size_t i = 0; i < said.size(); ++i) {
      heard.status[0].values[i + 1].key = said[i].first;
      heard.status[0].values[i + 1].value = said[i].second;
    }
    lamps.add(heard, 0.0);
    return lamps.lamps(0.5);
  };
  EXPECT_EQ(shown({{"solver", "newton"}}).size(), 2u);
  EXPECT_FALSE(lamps.training(0.5));
  EXPECT_EQ(shown({{"reduced model", "training: 40 %, snapshots"}})[2].value, "newton");
  EXPECT_EQ(lamps.lamps(0.5)[2].level, Level::ok);
  ASSERT_TRUE(lamps.training(0.5));
  EXPECT_DOUBLE_EQ(lamps.training(0.5)->share, 0.4);
  EXPECT_EQ(lamps.training(0.5)->text, "training: 40 %, snapshots");
  EXPECT_FALSE(lamps.training(Lamps::silence_s + 1.0));  // nothing is heard of it any more
  EXPECT_EQ(shown({{"reduced model", "not trained: friction"}})[2].level, Level::warn);
  for (const char* other : {"not trained: friction at 40 %", "training: nan %, x", "training: 400 %, x", "training"}) {
    shown({{"reduced model", other}});
    EXPECT_FALSE(lamps.training(0.5)) << other;
  }
  const auto moved_by = [&](const std::string& solver) {
    return shown({{"solver", solver}, {"audited error [m]", "0.00012"}, {"trusted error [m]", "0.0004"}})[2];
  };
  EXPECT_EQ(moved_by("reduced").value, "0.12 mm");
  EXPECT_EQ(moved_by("reduced").level, Level::ok);
  EXPECT_EQ(moved_by("newton").value, "newton");
  EXPECT_EQ(moved_by("newton").level, Level::warn);
}

TEST(History, KeepsTheLastSecondsOfATipThatMoves) {
  History history;
  MarkerObservations markers;
  markers.names = {"middle", "tip"};
  markers.positions.resize(2);
  for (int i = 0; i <= 3000; ++i) {
    markers.header.stamp = ros::Time(100.0 + 0.01 * i);
    markers.positions[1].x = 0.001 * i;
    history.add(markers, "tip");
  }
  ASSERT_EQ(history.titles(), (std::vector<std::string>{"tip [mm]"}));
  const History::Points& x = history.curves("tip [mm]").at("x");
  EXPECT_NEAR(x.back().first - x.front().first, History::kept_s, 0.06);
  EXPECT_LE(x.size(), 402u);
  EXPECT_NEAR(x.back().second, 3000.0, 5.1);
  EXPECT_EQ(history.curves("tip [mm]").at("y").back().second, 0.0);
  ActuatorState state;
  state.header.stamp = ros::Time(130.0);
  state.cables.resize(1);
  state.cables[0].name = "left";
  state.cables[0].tension_n = 2.5;
  history.add(state);
  EXPECT_EQ(history.curves("tension [N]").at("left").back().second, 2.5);
  markers.header.stamp = ros::Time(3.0);  // the session begins anew
  history.add(markers, "tip");
  EXPECT_EQ(history.curves("tip [mm]").at("x").size(), 1u);
  EXPECT_TRUE(history.curves("tension [N]").empty());
}

TEST(History, ZoomsNoNearerThanItsNoiseMatters) {
  History history;
  EXPECT_EQ(history.range("tip [mm]"), std::pair(-0.5, 0.5)) << "of nothing";
  MarkerObservations markers;
  markers.names = {"tip"};
  markers.positions.resize(1);
  ActuatorState state;
  state.cables.resize(1);
  state.chambers.resize(1);
  for (const int i : {0, 1}) {
    state.header.stamp = markers.header.stamp = ros::Time(100.0 + i);
    markers.positions[0].x = 1e-7 * i;
    state.cables[0].tension_n = 3.0 + 1e-6 * i;
    state.chambers[0].gauge_pressure_pa = 2000.0 * i;
    history.add(markers, "tip");
    history.add(state);
  }
  EXPECT_NEAR(history.range("tip [mm]").first, -0.5, 1e-4);
  EXPECT_NEAR(history.range("tip [mm]").second, 0.5, 1e-3);
  EXPECT_NEAR(history.range("tension [N]").first, 2.95, 1e-5);
  EXPECT_NEAR(history.range("tension [N]").second, 3.05, 1e-5);
  EXPECT_EQ(history.range("pressure [kPa]"), std::pair(0.0, 2.0)) << "what is larger fills it";
}

TEST(Lamps, TurnGreyInSilence) {
  Lamps lamps;
  lamps.add(diagnosis("simulator: simulation", 0, "runs", "1"), 0.0);
  EXPECT_EQ(lamps.lamps(Lamps::silence_s + 0.1)[0].level, Level::unknown);
}

TEST(Lamps, ShowARigsLinkAndTheGapOnceTheyAreHeardOf) {
  Lamps lamps;
  lamps.add(diagnosis("motor: motors", 2, "no link"), 0.0);
  RealityGap gap;
  gap.rms_m = 0.00123;
  lamps.add(gap, 0.0);
  const auto shown = lamps.lamps(0.1);
  ASSERT_EQ(shown.size(), 4u);
  EXPECT_EQ(shown[2].name, "Link");
  EXPECT_EQ(shown[2].level, Level::error);
  EXPECT_EQ(shown[3].value, "1.23 mm");
}

TEST(Lamps, SayWhyARigDoesNotMove) {
  Lamps lamps;
  EXPECT_EQ(lamps.link_fault(0.0), "") << "there is no rig";
  lamps.add(diagnosis("motor: motors", 0, "runs"), 0.0);
  EXPECT_EQ(lamps.link_fault(0.0), "");
  lamps.add(diagnosis("motor: motors", 2, "no link to the board"), 1.0);
  EXPECT_EQ(lamps.link_fault(1.0), "no link to the board");
}

TEST(Lamps, BelongToOneSession) {
  Lamps lamps("left");
  lamps.add(diagnosis("right/simulator: simulation", 2, "ill", "1"), 0.0);
  lamps.add(diagnosis("simulator: simulation", 2, "ill", "1"), 0.0);
  EXPECT_EQ(lamps.lamps(0.1)[0].level, Level::unknown);
  lamps.add(diagnosis("/left/simulator: simulation", 0, "runs", "1"), 0.0);
  EXPECT_EQ(lamps.lamps(0.1)[0].level, Level::ok);
}

std::vector<ActuatorRow> rows(double left, double right) {
  std::vector<ActuatorRow> rows(2);
  rows[0].name = "left";
  rows[1].name = "right";
  rows[0].shown = left;
  rows[1].shown = right;
  for (ActuatorRow& row : rows) {
    row.min = 0.7;
    row.max = 1.3;
  }
  return rows;
}

TEST(Poses, AreStoredAndPlayed) {
  Poses poses;
  EXPECT_EQ(poses.store("", rows(0.9, 1.1)), "pose 1");
  EXPECT_EQ(poses.store("", rows(0.8, 1.0)), "pose 2");
  const Policy policy = poses.policy("pose 1", rows(1.0, 1.0), 1.5);
  EXPECT_EQ(policy.names, (std::vector<std::string>{"left", "right"}));
  ASSERT_EQ(policy.steps.size(), 1u);
  EXPECT_EQ(policy.steps[0].time_s, 1.5);
  EXPECT_EQ(policy.steps[0].values, (std::vector<double>{0.9, 1.1}));
}

TEST(Poses, SurviveTheFileTheyAreKeptIn) {
  Poses poses, again;
  poses.store("bent: far = left", rows(0.7 + 1e-15, 1.0 / 0.9));
  again.read(poses.text());
  ASSERT_EQ(again.names(), poses.names());
  EXPECT_EQ(again.policy(again.names()[0], rows(1, 1), 1.0).steps[0].values[1], 1.0 / 0.9);
}

// A scene may call a cable so.
TEST(Poses, KeepActuatorsOfAnyName) {
  for (const std::string name :
       {"my cable", "a=b", "@left", "a:b", "50%41", "%", "gr\u00f6\u00dfe \u6f22", "a|b#c, d"}) {
    std::vector<ActuatorRow> named = rows(0.9, 1.1);
    named[0].name = name;
    Poses poses, again;
    poses.store("bent", named);
    again.read(poses.text());
    const Policy policy = again.policy("bent", named, 1.0);
    EXPECT_EQ(policy.names, (std::vector<std::string>{name, "right"})) << poses.text();
    EXPECT_EQ(policy.steps[0].values, (std::vector<double>{0.9, 1.1})) << poses.text();
  }
}

TEST(Poses, LeaveOutLinesThatCannotBeRead) {
  Poses poses;
  poses.read("good: left=0.9\nbad\n: left=1\nworse: left=fast\nnone: left=nan\ncut: left=0.9e\nlong: left=0.9x\n");
  EXPECT_EQ(poses.names(), std::vector<std::string>{"good"});
}

// Names of actuators are alike on many robots, forces are not.
TEST(Poses, AreInTheUnitOfTheCommand) {
  std::vector<ActuatorRow> shown = rows(0.9, 1.1);
  shown[0].command_per_unit = 1000.0;  // kPa
  Poses poses;
  poses.store("bent", shown);
  EXPECT_EQ(poses.policy("bent", shown, 1.0).steps[0].values, (std::vector<double>{900.0, 1.1}));
}

TEST(Poses, BelongToTheRobotTheyWereStoredFor) {
  Poses poses, again;
  poses.read("old: left=0.95");
  poses.set_scene("/robots/spine bot/a=b|c%.yaml");
  EXPECT_EQ(poses.store("bent", rows(0.9, 1.1)), "bent");
  EXPECT_EQ(poses.names(), (std::vector<std::string>{"bent", "old"}));
  poses.set_scene("/robots/gripper.yaml");
  EXPECT_EQ(poses.names(), std::vector<std::string>{"old"});
  EXPECT_THROW(poses.policy("bent", rows(1, 1), 1.0), std::invalid_argument);
  poses.store("bent", rows(1.2, 1.2));
  EXPECT_EQ(poses.text().find('|'), std::string::npos);
  again.read(poses.text());
  again.set_scene("/robots/spine bot/a=b|c%.yaml");
  EXPECT_EQ(again.policy("bent", rows(1, 1), 1.0).steps[0].values, (std::vector<double>{0.9, 1.1}));
  again.remove("bent");
  EXPECT_EQ(again.names(), std::vector<std::string>{"old"});
  again.set_scene("/robots/gripper.yaml");
  EXPECT_EQ(again.policy("bent", rows(1, 1), 1.0).steps[0].values, (std::vector<double>{1.2, 1.2}));
}

TEST(Poses, AreKeptInAFileOfTheUserForAllScenesOfARobot) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / ("poses_" + std::to_string(getpid()));
  fs::create_directories(folder / "arm");
  std::ofstream(folder / "arm/robot.yaml") << "body: {}\n";
  std::ofstream(folder / "arm/ball.yaml") << "include: robot.yaml\n";
  const std::string file = folder / "new/poses.txt";
  Poses poses, again;
  poses.read_file(file);
  EXPECT_TRUE(poses.names().empty()) << "there is none yet";
  poses.set_scene(folder / "arm/robot.yaml");
  poses.store("bent", rows(0.9, 1.1));
  poses.write_file(file);
  again.set_scene(folder / "arm/ball.yaml");
  again.read_file(file);
  ASSERT_EQ(again.names(), std::vector<std::string>{"bent"});
  EXPECT_EQ(again.policy("bent", rows(1, 1), 1.0).robot, "arm");
  again.set_scene(folder / "arm/other.yaml");
  EXPECT_TRUE(again.names().empty());
  fs::remove_all(folder);
}

TEST(Poses, MoveOnlyActuatorsThatTheRobotHas) {
  Poses poses;
  poses.read("other: left=0.2 tail=3\nalien: tail=3");
  EXPECT_EQ(poses.policy("other", rows(1, 1), 1.0).steps[0].values, std::vector<double>{0.7});  // within its limits
  EXPECT_THROW(poses.policy("alien", rows(1, 1), 1.0), std::invalid_argument);
  EXPECT_THROW(poses.policy("unknown", rows(1, 1), 1.0), std::invalid_argument);
}

TEST(RobotChoices, OfferTheScenesOfEachRobot) {
  std::set<std::string> labels;
  for (const auto& [label, file] : robot_choices(SOFT_ROBOT_LAB_SOURCE "/config/robots")) {
    EXPECT_TRUE(labels.insert(label).second) << label;
    EXPECT_EQ(label_of(file), label);
  }
  for (const char* label : {"gripper", "gripper: ball", "spinebot", "spinebot: touching", "bubblebot: fine"})
    EXPECT_EQ(labels.count(label), 1u) << label;
  EXPECT_EQ(labels.count("spinebot: motors"), 0u);
  EXPECT_EQ(labels.count("spinebot: random"), 0u);
  EXPECT_TRUE(robot_choices("/nowhere").empty());
}

std::vector<CallOutcome> outcomes_of(Calls& calls) {
  while (calls.any_busy()) std::this_thread::yield();
  return calls.take_outcomes();
}

TEST(Calls, ReturnAtOnceAndGiveTheOutcomeLater) {
  Calls calls;
  std::atomic<bool> go{false};
  EXPECT_TRUE(calls.start("slow", "Optimise", [&go] {
    while (!go) std::this_thread::yield();
    return "found";
  }));
  EXPECT_TRUE(calls.busy("slow"));
  EXPECT_TRUE(calls.take_outcomes().empty());
  go = true;
  const auto outcomes = outcomes_of(calls);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_TRUE(outcomes[0].success);
  EXPECT_EQ(outcomes[0].message, "found");
}

TEST(Calls, LetAStopThroughBesideASearch) {
  Calls calls;
  std::atomic<bool> stopped{false};
  calls.start("slow", "Optimise", [&stopped] {
    while (!stopped) std::this_thread::yield();
    return "stopped";
  });
  EXPECT_FALSE(calls.start("slow", "Optimise", [] { return ""; }));  // one at a time
  EXPECT_TRUE(calls.start("quick", "Stop", [&stopped] {
    stopped = true;
    return "";
  }));
  EXPECT_EQ(outcomes_of(calls).size(), 2u);
}

TEST(Calls, TurnWhatIsThrownIntoAFailure) {
  Calls calls;
  calls.start("quick", "Reset", []() -> std::string { throw std::runtime_error("no simulator"); });
  const auto outcomes = outcomes_of(calls);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_FALSE(outcomes[0].success);
  EXPECT_EQ(outcomes[0].message, "no simulator");
}

// Every service is asked by `ask`: so none can make the window wait.
TEST(Calls, AreRefusedInTheThreadOfTheWindow) {
  Calls calls;
  EXPECT_THROW(calls.refuse_window("simulator/reset"), std::logic_error);
  calls.start("quick", "Reset", [&calls] {
    calls.refuse_window("simulator/reset");
    return "";
  });
  EXPECT_TRUE(outcomes_of(calls)[0].success);
}

TEST(TurnWatch, KeepsTheLongestGapAndTheMostWork) {
  TurnWatch watch;
  watch.turn(100.0, 5.0);
  EXPECT_EQ(watch.take().wall_s, 0.0);
  watch.turn(100.02, 5.01);
  watch.turn(100.12, 5.02);
  watch.turn(100.14, 5.04);
  const TurnGap longest = watch.take();
  EXPECT_NEAR(longest.wall_s, 0.1, 1e-9);
  EXPECT_NEAR(longest.work_s, 0.02, 1e-9);
  watch.turn(100.17, 5.04);
  EXPECT_NEAR(watch.take().wall_s, 0.03, 1e-9) << "across what was taken";
}

const std::string kTable =
    "task,left,right,state,reason,snapped,markers.tip.position_m.x,markers.tip.position_m.y,markers.tip.position_m.z,"
    "actuators.left.tension_n,actuators.right.tension_n,folded,"
    "least_singular_value_m\n"
    "a,0.8,1,good,,false,0.01,0,-0.09,2.5,0,false,0.004\n"
    "b,0.8,0.9,failed,\"no rest state, at all\",,,,,,,,\n"
    "c,1,0.8,good,,false,-0.01,0.001,-0.09,0,3.5,true,0.001\n";

TEST(ReachableTips, AreTheRestStatesOfATable) {
  const ReachableTips found = read_reachable_tips(kTable, "tip");
  EXPECT_EQ(found.actuators, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(found.effort, "tension [N]");
  ASSERT_EQ(found.tips.size(), 2u);
  EXPECT_EQ(found.tips[0].position_m, Eigen::Vector3d(0.01, 0, -0.09));
  EXPECT_EQ(found.tips[1].commands, (std::vector<double>{1.0, 0.8}));
  EXPECT_EQ(found.tips[1].effort, 3.5);
  EXPECT_FALSE(found.tips[0].snaps);
  EXPECT_TRUE(found.tips[1].snaps);
  const std::vector<TipQuantity> quantities = quantities_of(found);
  ASSERT_EQ(quantities.size(), 2u);
  EXPECT_EQ(quantities[0].largest(), 3.5);
  EXPECT_EQ(quantities[1].label, "least motion [mm]");
  EXPECT_EQ(quantities[1].values, (std::vector<double>{4.0, 1.0}));
  ASSERT_EQ(quantities_of({}).size(), 1u) << "where no effort is measured";
  EXPECT_GT(quantities_of({})[0].largest(), 0.0) << "of no tips too";
}

TEST(ReachableTips, RefuseWhatIsNoSuchTable) {
  const std::string head = kTable.substr(0, kTable.find('\n') + 1);
  EXPECT_THROW(read_reachable_tips(kTable, "nose"), std::invalid_argument);
  for (const std::string& text : {std::string(), std::string("a,b\n"), head + "a,0.8,1,good\n",
                                  head + "a,0.8,1,good,,false,nan,0,-0.09,2.5,0,false,0.004\n",
                                  head + "a,0.8,1,good,,false,0.01x,0,-0.09,2.5,0,false,0.004\n",
                                  head + "a,0.8,1,good,,false,east,0,-0.09,2.5,0,false,0.004\n"})
    EXPECT_THROW(read_reachable_tips(text, "tip"), std::invalid_argument) << text;
}

TEST(ReachableTips, HaveAConvexHull) {
  const std::vector<Eigen::Vector2d> square = {{0, 0}, {1, 1}, {0.5, 0.5}, {1, 0}, {0.5, 0}, {0, 1}, {0, 0}};
  const std::vector<std::size_t> hull = convex_hull(square);
  ASSERT_EQ(hull.size(), 4u);
  double area = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d &a = square[hull[i]], &b = square[hull[(i + 1) % 4]];
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  EXPECT_EQ(area, 1.0) << "counter-clockwise";
  EXPECT_EQ(convex_hull({{0, 0}, {2, 2}, {1, 1}}).size(), 2u) << "of a line its ends";
  EXPECT_TRUE(convex_hull({}).empty());
}

// Boxes of robots that hang, stand, lie and reach far, from before, from the corner of our rviz files, and from above.
class FramingOf : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(FramingOf, ShowsTheWholeRobotAndNotFromAfar) {
  const auto [yaw_rad, pitch_rad] = GetParam();
  const Eigen::Matrix3d eye_from_world = (Eigen::AngleAxisd(-pitch_rad, Eigen::Vector3d::UnitX()) *
                                          Eigen::AngleAxisd(-yaw_rad - M_PI_2, Eigen::Vector3d::UnitZ()))
                                             .toRotationMatrix();  // x to the right, y ahead, z up
  for (const double aspect : {1.6, 1.1, 0.5})                      // 0.5: beside the image of a camera
    for (const Eigen::Vector3d& size_m :
         {Eigen::Vector3d(0.03, 0.02, 0.1), Eigen::Vector3d(0.2, 0.2, 0.05), Eigen::Vector3d(0.3, 0.02, 0.02),
          Eigen::Vector3d(0.02, 0.3, 0.02), Eigen::Vector3d(0.005, 0.005, 0.4)}) {
      const Eigen::AlignedBox3d box_m(Eigen::Vector3d(0.1, -0.2, -size_m.z()),
                                      Eigen::Vector3d(0.1, -0.2, 0.0) + Eigen::Vector3d(size_m.x(), size_m.y(), 0.0));
      const Framing framing = framing_of(box_m, {yaw_rad, pitch_rad}, aspect);
      for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector3d at_m =
            eye_from_world * (box_m.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)) - framing.focus_m);
        at_m.y() += framing.distance_m;
        EXPECT_LT(std::abs(at_m.z()) / at_m.y(), std::tan(M_PI / 8)) << size_m.transpose();
        EXPECT_LT(std::abs(at_m.x()) / at_m.y(), aspect * std::tan(M_PI / 8)) << size_m.transpose();
      }
      EXPECT_LT(framing.distance_m, 3.5 * size_m.maxCoeff() / std::min(1.0, aspect)) << "not from afar";
    }
}

INSTANTIATE_TEST_SUITE_P(Eyes, FramingOf,
                         testing::Values(std::pair(4.712389, 0.0), std::pair(4.15, 0.3), std::pair(1.0, -0.7),
                                         std::pair(0.0, 1.2)));

}  // namespace
}  // namespace soft_robot_lab
