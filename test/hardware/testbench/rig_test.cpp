// SPDX-License-Identifier: BSD-3-Clause
// The driver against the real firmware on the emulated rig.
#include <cmath>

#include <gtest/gtest.h>

#include "hardware/testbench/emulated_session.h"
#include "refusal.h"

namespace soft_robot_lab {
namespace {

const char* two_cables =
    "device: /dev/null\n"
    "motors:\n"
    "  - {name: left, cable: {rest_length_m: 0.1, min_contraction: 0.5, max_contraction: 1.2}}\n"
    "  - {name: right, cable: {rest_length_m: 0.1, min_contraction: 0.5, max_contraction: 1.2}}\n";

EmulatedSession emulate(const std::string& yaml) {
  return EmulatedSession(parse_rig(yaml, "test"), 1, SOFT_ROBOT_LAB_RIG_EMULATOR);
}

constexpr auto left = 0;
constexpr auto right = 1;

class Rig : public testing::Test {
 protected:
  void start() { ASSERT_TRUE(session.run_until_ready()); }
  void go_to(double value) {
    session.command({"left"}, {value});
    ASSERT_TRUE(session.run_until_rest());
  }
  MotorStatus motor(int index) { return session.driver().motors()[static_cast<std::size_t>(index)]; }
  void expect_exact(int index) {
    EXPECT_TRUE(motor(index).known);
    EXPECT_EQ(motor(index).position_steps, session.shaft(index));
  }

  EmulatedSession session = emulate(two_cables);
};

TEST_F(Rig, MovesShaftsToTheStepsThatContractionsMean) {
  start();
  session.command({"left", "right"}, {0.8, 1.1});
  ASSERT_TRUE(session.run_until_rest());
  EXPECT_EQ(session.shaft(left), 320);
  EXPECT_EQ(session.shaft(right), -160);
  EXPECT_EQ(motor(left).target_steps, 320);
  expect_exact(left);
  expect_exact(right);
  EXPECT_EQ(session.driver().commands().acknowledged, 1);
}

TEST_F(Rig, TellsItsStateFiftyTimesASecondWhileMotorsMove) {
  start();
  session.command({"left", "right"}, {0.6, 0.6});
  const auto before = session.driver().link_counts().received;
  session.run(1.0);
  EXPECT_TRUE(motor(left).moving);
  EXPECT_GE(session.driver().link_counts().received - before, 2 * 49);
}

TEST_F(Rig, TakesANewTargetInTheMiddleOfAMotion) {
  start();
  session.command({"left"}, {0.6});
  session.run(0.5);
  EXPECT_TRUE(motor(left).moving);
  go_to(1.05);
  EXPECT_EQ(session.shaft(left), -80);
  expect_exact(left);
}

TEST_F(Rig, StopsSoftlyAndStaysWhereItStopped) {
  start();
  session.command({"left"}, {0.6});
  session.run(0.5);
  session.driver().soft_stop();
  ASSERT_TRUE(session.finish_operation());
  ASSERT_TRUE(session.run_until_rest());
  EXPECT_GT(session.shaft(left), 100);
  EXPECT_LT(session.shaft(left), 300);
  EXPECT_EQ(motor(left).target_steps, motor(left).position_steps);
  expect_exact(left);
}

TEST_F(Rig, EmergencyStopWinsAndHoldsUntilCleared) {
  start();
  session.command({"left"}, {0.6});
  session.run(0.5);
  session.driver().emergency_stop();
  const double stopped_at = session.shaft(left);
  session.run(0.5);
  EXPECT_NEAR(session.shaft(left), stopped_at, 2.0);
  EXPECT_TRUE(contains(refusal(session, {"left"}, {0.9}), "emergency stop"));
  EXPECT_TRUE(contains(motor(left).fault, "emergency stop"));

  // Not even a driver that does not know of it moves anything.
  session.start_driver(false);
  session.run(0.5);
  EXPECT_TRUE(contains(refusal(session, {"left"}, {0.9}), "emergency stop"));

  session.driver().clear();
  ASSERT_TRUE(session.finish_operation());
  session.run(0.1);
  go_to(0.9);
  EXPECT_EQ(session.shaft(left), 160);
}

TEST_F(Rig, MovesAgainOnceAnEmergencyStopIsCleared) {
  start();
  session.driver().emergency_stop();
  session.run(0.1);
  session.driver().clear();
  ASSERT_TRUE(session.finish_operation());
  EXPECT_FALSE(session.driver().emergency_stopped());
  session.run(0.1);
  go_to(0.9);
  EXPECT_EQ(session.shaft(left), 160);
}

TEST_F(Rig, EmergencyStopWinsOverClearing) {
  start();
  session.driver().emergency_stop();
  session.run(0.1);
  session.driver().clear();
  session.driver().update(session.rig.time_s());
  session.driver().emergency_stop();
  EXPECT_FALSE(session.finish_operation());
  EXPECT_EQ(session.driver().operation_failure(), "emergency stop");
  session.run(0.3);
  EXPECT_TRUE(session.driver().emergency_stopped());
  EXPECT_NE(motor(left).flags & wire::flag_emergency_stop, 0);
}

TEST_F(Rig, EmergencyStopIsRepeatedUntilTheBoardHasHeardIt) {
  start();
  session.command({"left"}, {0.6});
  session.run(0.3);
  session.rig.ask("noise 0 1 0");
  session.driver().emergency_stop();
  session.run(0.1);
  session.rig.ask("noise 0 0 0");
  session.run(0.1);
  EXPECT_FALSE(session.rig.shafts()[left].moving);
  EXPECT_TRUE(contains(motor(left).fault, "emergency stop"));
}

TEST_F(Rig, WatchdogStopsTheMotorsWhenTheHostDies) {
  start();
  session.command({"left"}, {0.5});
  session.run(0.5);
  session.stop_driver();
  session.run(0.4);
  EXPECT_TRUE(session.rig.shafts()[left].moving);
  session.run(0.2);
  EXPECT_FALSE(session.rig.shafts()[left].moving);
  const double stopped_at = session.shaft(left);

  // A new driver reads the position back, and nothing jumps.
  session.start_driver(true);
  ASSERT_TRUE(session.run_until_ready());
  session.run(0.5);
  EXPECT_EQ(session.shaft(left), stopped_at);
  EXPECT_EQ(motor(left).target_steps, stopped_at);
  expect_exact(left);
  go_to(0.9);
  EXPECT_EQ(session.shaft(left), 160);
}

// On a noisy line the watchdog must not bite because a few frames in a row were lost.
TEST_F(Rig, FeedsTheWatchdogTenTimesInItsTime) {
  start();
  const auto before = session.driver().link_counts().sent;
  session.run(session.settings.watchdog_s);
  EXPECT_GE(session.driver().link_counts().sent - before, 10);
}

// As far as the rig's file says: a machine under load, or an emulated board there, may answer late.
TEST(RigLink, WaitsForASilentBoardNotQuiteAsLongAsItsWatchdog) {
  for (const double watchdog_s : {0.2, 2.0}) {
    EmulatedSession session = emulate("watchdog_s: " + std::to_string(watchdog_s) + "\n" + two_cables);
    ASSERT_TRUE(session.run_until_ready());
    session.rig.ask("noise 0 1 0");
    session.run(0.5 * watchdog_s);
    EXPECT_TRUE(session.driver().linked()) << watchdog_s;
    session.run(0.2 * watchdog_s);
    EXPECT_FALSE(session.driver().linked()) << watchdog_s;
  }
}

TEST_F(Rig, LosesNoPositionWhenTheBoardIsReset) {
  start();
  session.command({"left"}, {0.5});
  session.run(0.5);
  session.rig.ask("reset 0.5");
  session.run(0.4);
  EXPECT_FALSE(session.driver().linked());
  EXPECT_TRUE(contains(motor(left).fault, "no link"));
  EXPECT_FALSE(motor(left).known);
  ASSERT_TRUE(session.run_until_ready());
  ASSERT_TRUE(session.run_until_rest());
  expect_exact(left);
  EXPECT_LT(session.shaft(left), 800);
  go_to(1.0);
  EXPECT_EQ(session.shaft(left), 0);
}

TEST_F(Rig, ComesBackHoweverLongTheBoardBoots) {
  start();
  for (const char* boot_s : {"0.05", "0.123456789", "0.2222222222"}) {
    session.rig.ask(std::string("reset ") + boot_s);
    session.run(0.5);
    ASSERT_TRUE(session.run_until_ready());
  }
}

TEST_F(Rig, DeclaresThePositionUnknownAfterAPowerCut) {
  start();
  go_to(0.9);
  session.rig.ask("brownout 0.5");
  session.run(2.0);
  EXPECT_TRUE(session.driver().ready());
  EXPECT_FALSE(motor(left).known);
  EXPECT_TRUE(contains(refusal(session, {"left"}, {0.8}), "position unknown"));
  session.driver().zero({"left"});
  ASSERT_TRUE(session.finish_operation());
  session.run(0.1);
  go_to(0.8);
  EXPECT_EQ(session.shaft(left), 320);
}

TEST_F(Rig, ComesBackAfterUnplugging) {
  start();
  session.command({"left"}, {0.5});
  session.run(0.3);
  session.rig.unplug();
  session.run(2.0);
  EXPECT_FALSE(session.rig.shafts()[left].moving);
  EXPECT_TRUE(contains(refusal(session, {"left"}, {0.8}), "no link"));
  session.rig.replug();
  ASSERT_TRUE(session.run_until_ready());
  expect_exact(left);
  EXPECT_TRUE(session.at_rest());
  go_to(0.9);
  EXPECT_EQ(session.shaft(left), 160);
}

class RigFault : public Rig, public testing::WithParamInterface<std::pair<const char*, const char*>> {};

TEST_P(RigFault, IsLatchedAndRefusesMotionUntilCleared) {
  const auto [command, name] = GetParam();
  start();
  session.command({"left"}, {0.6});
  session.run(0.5);
  session.rig.ask(std::string(command) + " 0 on");
  session.run(0.5);
  EXPECT_FALSE(session.rig.shafts()[left].moving);
  EXPECT_TRUE(contains(motor(left).fault, name)) << motor(left).fault;
  EXPECT_FALSE(motor(left).known);
  EXPECT_TRUE(contains(refusal(session, {"left"}, {0.9}), name));
  EXPECT_EQ(motor(right).fault, "");

  // While the cause lasts, clearing it is of no use.
  session.driver().clear();
  ASSERT_TRUE(session.finish_operation());
  session.run(0.1);
  const bool shows_at_rest = std::string(command) != "stall";
  EXPECT_EQ(contains(motor(left).fault, name), shows_at_rest) << motor(left).fault;

  session.rig.ask(std::string(command) + " 0 off");
  session.driver().clear();
  ASSERT_TRUE(session.finish_operation());
  session.run(0.1);
  EXPECT_TRUE(contains(refusal(session, {"left"}, {0.9}), "position unknown"));
  session.driver().zero({"left"});
  ASSERT_TRUE(session.finish_operation());
  session.run(0.1);
  go_to(0.9);
  EXPECT_EQ(session.shaft(left), 160);
}

INSTANTIATE_TEST_SUITE_P(All, RigFault,
                         testing::Values(std::pair("stall", "stall"), std::pair("overcurrent", "over-current"),
                                         std::pair("overheat", "too hot"), std::pair("undervoltage", "undervoltage")),
                         [](const auto& fault) { return std::string(fault.param.first); });

TEST_F(Rig, RefusesWhatLiesBeyondLimitsOrComesTooFast) {
  start();
  EXPECT_EQ(refusal(session, {"left"}, {0.4}),
            "left: 0.400000 is not in [0.500000, 1.200000]; min_contraction of its rig's file moves that limit");
  EXPECT_TRUE(contains(refusal(session, {"left"}, {NAN}), "is not in"));
  EXPECT_EQ(refusal(session, {"middle"}, {0.9}), "'middle' is not one of left, right");
  EXPECT_TRUE(contains(refusal(session, {"left", "left"}, {0.9, 0.9}), "named twice"));
  EXPECT_TRUE(contains(refusal(session, {"left"}, {}), "1 and 0"));
  EXPECT_EQ(refusal(session, {"left", "right"}, {0.9, 0.4}),
            "right: 0.400000 is not in [0.500000, 1.200000]; min_contraction of its rig's file moves that limit");
  session.run(0.1);
  EXPECT_TRUE(session.at_rest());
  EXPECT_EQ(session.shaft(left), 0);

  EXPECT_EQ(refusal(session, {"left"}, {0.9}), "");
  EXPECT_TRUE(contains(refusal(session, {"left"}, {0.8}), "min_command_period_s"));
  ASSERT_TRUE(session.run_until_rest());
  EXPECT_EQ(session.shaft(left), 160);
  const CommandCounts counts = session.driver().commands();
  EXPECT_EQ(counts.received, 8);
  EXPECT_EQ(counts.refused, 7);
  EXPECT_EQ(counts.acknowledged, 1);
}

TEST_F(Rig, SupersedesCommandsThatWereNotSentYet) {
  start();
  session.rig.ask("noise 0 1 0");  // nothing gets through for a moment
  for (const double value : {0.9, 0.85, 0.8}) {
    session.command({"left"}, {value});
    session.run(0.01);
  }
  session.rig.ask("noise 0 0 0");
  ASSERT_TRUE(session.run_until_rest());
  EXPECT_EQ(session.shaft(left), 320);
  EXPECT_EQ(session.driver().commands().acknowledged, 2);
  EXPECT_EQ(session.driver().commands().superseded, 1);
}

TEST_F(Rig, MakesUpForBacklash) {
  EmulatedSession loose = emulate(
      "device: /dev/null\n"
      "motors:\n"
      "  - {name: left, backlash_steps: 12, cable: {rest_length_m: 0.1, min_contraction: 0.5, max_contraction: "
      "1.2}}\n");
  loose.rig.ask("backlash 0 12");
  ASSERT_TRUE(loose.run_until_ready());
  for (const double value : {0.8, 0.9, 0.95, 0.7, 1.0}) {
    loose.command({"left"}, {value});
    ASSERT_TRUE(loose.run_until_rest());
    EXPECT_EQ(loose.rig.shafts()[0].spool_steps, std::round(1600 * (1 - value))) << value;
    EXPECT_EQ(loose.driver().motors()[0].spool_steps, loose.rig.shafts()[0].spool_steps);
  }
}

TEST_F(Rig, DrivesSixMotorsInOneChain) {
  std::string yaml = "device: /dev/null\nmotors:\n";
  for (int i = 0; i < 6; ++i) {
    yaml += "  - {name: m" + std::to_string(i) + ", direction: " + (i % 2 ? "-1" : "1") +
            ", cable: {rest_length_m: 0.1, min_contraction: 0.5, max_contraction: 1.2}}\n";
  }
  EmulatedSession six = emulate(yaml);
  ASSERT_TRUE(six.run_until_ready());
  six.command({"m0", "m1", "m2", "m3", "m4", "m5"}, {0.95, 0.94, 0.93, 0.92, 0.91, 0.90});
  ASSERT_TRUE(six.run_until_rest());
  for (int i = 0; i < 6; ++i) EXPECT_EQ(six.shaft(i), (i % 2 ? -1 : 1) * (80 + 16 * i)) << i;
}

TEST_F(Rig, RefusesAChainOfAnotherLength) {
  Testbench three(3, 1, SOFT_ROBOT_LAB_RIG_EMULATOR);
  MotorDriver driver(parse_rig(two_cables, "test"), {}, three.ports());
  while (three.time_s() < 0.5) {
    driver.update(three.time_s());
    three.run(0.005);
  }
  EXPECT_FALSE(driver.ready());
  EXPECT_EQ(driver.link_failure(), "the board found 3 motor drivers, the rig's file lists 2");
}

// Every command of PROTOCOL.md with each of its words replaced by each bad one, left out and doubled.
std::vector<std::string> bad_lines() {
  const std::vector<std::vector<std::string>> good = {{"shafts"},
                                                      {"counts"},
                                                      {"noise", "0.01", "0", "0", "0.1", "0.001"},
                                                      {"unplug"},
                                                      {"replug"},
                                                      {"reset", "0.01"},
                                                      {"brownout", "0.01"},
                                                      {"stall", "0", "on"},
                                                      {"slip", "0", "3"},
                                                      {"overheat", "1", "off"},
                                                      {"backlash", "0", "2"},
                                                      {"run", "100", "00ff"}};
  const std::vector<std::string> bad = {
      "nan", "-inf", "1e300", "-1",  "0x1p99999", "1e", "2147483648", "\"'", "\xff\xfe", "%n%s", std::string(2000, '9'),
      "",    "run",  "on",    "0.5", "zz",        "abc"};
  std::vector<std::string> lines = {"", " ", "\t", "help", std::string(4000, 'x')};
  for (const auto& words : good)
    for (std::size_t at = 0; at < words.size(); ++at)
      for (std::string other : bad) {
        if (other == "abc") other = words[at] + " " + words[at];
        std::string line;
        for (std::size_t i = 0; i < words.size(); ++i) line += (i ? " " : "") + (i == at ? other : words[i]);
        lines.push_back(line);
      }
  return lines;
}

TEST(RigCommands, AreAnsweredHoweverBadTheyAre) {
  Testbench rig(2, 1, SOFT_ROBOT_LAB_RIG_EMULATOR);
  int refused = 0;
  for (const std::string& line : bad_lines()) {
    SCOPED_TRACE(line.substr(0, 80));
    try {
      rig.ask(line);
    } catch (const std::invalid_argument& error) {
      EXPECT_STRNE(error.what(), "");
      ++refused;
    }
  }
  EXPECT_GT(refused, 200);
  rig.ask("noise 0 0 0");
  EXPECT_EQ(rig.shafts().size(), 2u) << "answers are no longer those of the questions";
  for (const ShaftTruth& shaft : rig.shafts()) EXPECT_TRUE(std::isfinite(shaft.shaft_steps + shaft.spool_steps));
}

TEST_F(Rig, KeepsTheSessionThroughDelays) {
  session.rig.ask("noise 0 0 0 0.01 0.05");
  start();
  for (const double value : {0.9, 1.1, 0.95}) go_to(value);
  EXPECT_EQ(session.shaft(left), 80);
  EXPECT_EQ(session.driver().link_counts().lost, 0);
}

}  // namespace
}  // namespace soft_robot_lab
