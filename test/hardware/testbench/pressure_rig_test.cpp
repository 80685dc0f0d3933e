// SPDX-License-Identifier: BSD-3-Clause
// The driver of pressure channels against the real firmware on the emulated rig.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <random>

#include <gtest/gtest.h>

#include "hardware/motor/motor_driver.h"
#include "hardware/testbench/emulated_session.h"
#include "hardware/testbench/pressure_session.h"
#include "refusal.h"

namespace soft_robot_lab {
namespace {

const char* valves =
    "device: /dev/null\n"
    "sensor: {full_pa: 100000}\n"
    "channels:\n"
    "  - {name: a, max_pa: 40000, valves: {deadband_pa: 1000}}\n"
    "  - {name: b, max_pa: 40000, valves: {deadband_pa: 1000}}\n";
const char* regulators =
    "device: /dev/null\n"
    "sensor: {full_pa: 100000}\n"
    "channels:\n"
    "  - {name: a, max_pa: 40000, regulator: {full_pa: 50000}}\n"
    "  - {name: b, max_pa: 40000, regulator: {full_pa: 50000}}\n";

std::string rig_file(const std::string& yaml) {
  std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
  std::replace(name.begin(), name.end(), '/', '_');
  const std::string path = testing::TempDir() + "pressure_rig_" + name + ".yaml";
  std::ofstream(path) << yaml;
  return path;
}

constexpr double tolerance_pa = 2000.0;
constexpr double report_limit_s = 0.5;

class PressureRig : public testing::TestWithParam<const char*> {
 protected:
  void start() { ASSERT_TRUE(session.run_until_ready()) << session.driver().link_failure(); }
  void hold(double a_pa, double b_pa) {
    session.run(0.01);
    session.command({"a", "b"}, {a_pa, b_pa});
    ASSERT_TRUE(session.run_until([&] { return near(0, a_pa) && near(1, b_pa); }, 3.0)) << truth(0) << " " << truth(1);
    session.run(0.3);
    EXPECT_TRUE(near(0, a_pa) && near(1, b_pa)) << truth(0) << " " << truth(1);
  }
  double truth(std::size_t channel) { return session.rig.pressures_pa().at(channel); }
  bool near(std::size_t channel, double pressure_pa) { return std::abs(truth(channel) - pressure_pa) < tolerance_pa; }
  // Of the channel that has one; how long it took is emulated time.
  void expect_fault(const std::string& words) {
    const double begin_s = session.rig.time_s();
    ASSERT_TRUE(session.run_until([&] { return contains(session.channel(0).fault, words); }, report_limit_s))
        << session.channel(0).fault << " at " << truth(0);
    std::cout << words << ": reported after " << session.rig.time_s() - begin_s << " s of the rig's time\n";
    EXPECT_EQ(session.channel(0).set_point_pa, 0.0);
    EXPECT_TRUE(contains(session.channel(1).fault, "a has a fault")) << session.channel(1).fault;
    EXPECT_TRUE(contains(refusal(session, {"b"}, {10000}), "a has a fault"));
    EXPECT_TRUE(session.run_until([&] { return near(0, 0.0) && near(1, 0.0); }, 3.0)) << truth(0) << " " << truth(1);
  }
  void clear() {
    session.driver().clear();
    ASSERT_TRUE(session.finish_operation());
    session.run(0.1);
  }

  PressureSession session{rig_file(GetParam()), 1, SOFT_ROBOT_LAB_RIG_EMULATOR};
};

INSTANTIATE_TEST_SUITE_P(All, PressureRig, testing::Values(valves, regulators),
                         [](const auto& rig) { return rig.param == valves ? "valves" : "regulators"; });

TEST_P(PressureRig, BringsChambersToThePressuresAskedFor) {
  start();
  EXPECT_EQ(session.channel(0).fault, "");
  hold(20000, 35000);
  EXPECT_NEAR(session.channel(0).pressure_pa, truth(0), 500.0);
  EXPECT_FALSE(session.channel(0).settling);
  EXPECT_EQ(session.channel(1).set_point_pa, 35000.0);
  hold(5000, 40000);
  hold(0, 0);
  EXPECT_EQ(session.driver().commands().acknowledged, 3);
  EXPECT_EQ(session.channel(0).fault, "");
}

TEST_P(PressureRig, ReportsABurstTube) {
  start();
  hold(20000, 30000);
  session.rig.ask("burst 0 on");
  expect_fault("burst tube");
  session.rig.ask("burst 0 off");
  clear();
  hold(20000, 30000);
}

// Its noise must not pass for a pressure that comes nearer.
TEST_P(PressureRig, ReportsFaultsByANoisySensor) {
  start();
  for (const char* noise_pa : {"100", "300", "600"}) {
    session.rig.ask(std::string("sensor_noise 0 ") + noise_pa);
    for (const double value_pa : {8000.0, 20000.0, 30000.0}) {
      hold(value_pa, 30000);
      session.rig.ask("burst 0 on");
      expect_fault("burst tube");
      session.rig.ask("burst 0 off");
      clear();
      hold(value_pa, 30000);
      session.rig.ask("stuck 0 fill");
      session.command({"a"}, {value_pa + 10000.0});
      expect_fault("stuck valve");
      session.rig.ask("stuck 0 off");
      clear();
    }
  }
}

TEST_P(PressureRig, ReportsATubeThatWasOffBefore) {
  start();
  session.rig.ask("burst 0 on");
  session.command({"a", "b"}, {20000, 10000});
  expect_fault("burst tube");
}

TEST_P(PressureRig, ReportsAValveThatDoesNotFill) {
  start();
  hold(20000, 30000);
  session.rig.ask("stuck 0 fill");
  session.command({"a"}, {35000});
  expect_fault("stuck valve");
  session.rig.ask("stuck 0 off");
  clear();
  hold(20000, 30000);
}

TEST_P(PressureRig, ReportsAValveThatDoesNotClose) {
  start();
  session.command({"a", "b"}, {38000, 10000});
  ASSERT_TRUE(session.run_until([&] { return truth(0) > 20000; }, 3.0));
  session.rig.ask("stuck 0 fill");
  session.run(0.01);
  session.command({"a"}, {5000});
  expect_fault(GetParam() == valves ? "stuck valve" : "beyond its limit");
}

TEST_P(PressureRig, ReportsAVentThatDoesNotOpen) {
  if (GetParam() == regulators) GTEST_SKIP() << "a regulator lets air out itself";
  start();
  hold(30000, 10000);
  session.rig.ask("stuck 0 vent");
  session.command({"a"}, {10000});
  expect_fault("stuck valve");
}

TEST_P(PressureRig, ReportsASilentSensor) {
  start();
  hold(20000, 30000);
  session.rig.ask("silent 0 on");
  expect_fault("silent sensor");
  EXPECT_FALSE(session.channel(0).known);
  session.rig.ask("silent 0 off");
  clear();
  hold(20000, 30000);
}

TEST_P(PressureRig, ReportsASilentSensorThatIsCleared) {
  start();
  session.rig.ask("silent 0 on");
  session.run(0.3);
  clear();
  EXPECT_TRUE(contains(session.channel(0).fault, "silent sensor")) << session.channel(0).fault;
}

TEST_P(PressureRig, ReportsAFrozenSensorWhenThePressureHasToChange) {
  start();
  hold(20000, 30000);
  session.rig.ask("freeze 0 on");
  session.command({"a"}, {35000});
  expect_fault("stuck valve");
}

TEST_P(PressureRig, LetsTheAirOutWhenTheHostDies) {
  start();
  hold(20000, 30000);
  session.stop_driver();
  session.run(0.4);
  EXPECT_GT(truth(1), 25000);
  session.run(2.0);
  EXPECT_TRUE(near(0, 0.0) && near(1, 0.0)) << truth(0) << " " << truth(1);

  // A new driver finds no set point, and fills nothing until it is asked to.
  session.start_driver();
  ASSERT_TRUE(session.run_until_ready());
  session.run(0.5);
  EXPECT_TRUE(near(0, 0.0) && near(1, 0.0)) << truth(0) << " " << truth(1);
  EXPECT_EQ(session.channel(1).set_point_pa, 0.0);
  EXPECT_NE(session.channel(1).flags & wire::flag_host_silent, 0);
  hold(20000, 30000);
}

// A host with another file, while the board still holds what the first one asked for.
TEST_P(PressureRig, LetsTheAirOutBeforeItIsConfiguredAnew) {
  start();
  hold(20000, 30000);
  session.stop_driver();
  std::string other = GetParam();
  other.replace(other.find("max_pa: 40000"), 13, "max_pa: 25000");
  PressureDriver second(parse_rig(other, "other"), DriverOptions{77, false}, session.rig.ports());
  while (!second.ready() && session.rig.time_s() < 60.0) {
    second.update(session.rig.time_s());
    session.rig.run(0.005);
  }
  ASSERT_TRUE(second.ready());
  EXPECT_EQ(second.channels()[1].set_point_pa, 0.0);
  for (int i = 0; i < 400; ++i) {
    second.update(session.rig.time_s());
    session.rig.run(0.005);
  }
  EXPECT_TRUE(near(0, 0.0) && near(1, 0.0)) << truth(0) << " " << truth(1);
  EXPECT_THROW(second.command({"a"}, {26000}, session.rig.time_s()), std::invalid_argument);
}

TEST_P(PressureRig, EmergencyStopLetsTheAirOutAndHoldsUntilCleared) {
  start();
  hold(20000, 30000);
  session.driver().emergency_stop();
  ASSERT_TRUE(session.run_until([&] { return near(0, 0.0) && near(1, 0.0); }, 3.0));
  EXPECT_TRUE(contains(refusal(session, {"a"}, {10000}), "emergency stop"));
  session.start_driver();  // that does not know of it
  ASSERT_TRUE(session.run_until_ready());
  EXPECT_TRUE(contains(refusal(session, {"a"}, {10000}), "emergency stop"));
  clear();
  hold(20000, 30000);
}

TEST_P(PressureRig, LetsTheAirOutWhenTheBoardIsResetOrLosesItsPower) {
  start();
  for (const char* command : {"reset 0.5", "brownout 0.5"}) {
    hold(20000, 30000);
    session.rig.ask(command);
    session.run(2.0);
    ASSERT_TRUE(session.run_until_ready());
    EXPECT_TRUE(near(0, 0.0) && near(1, 0.0)) << truth(0) << " " << truth(1);
    EXPECT_EQ(session.channel(1).set_point_pa, 0.0);
  }
}

TEST_P(PressureRig, RefusesWhatLiesBeyondItsLimits) {
  start();
  EXPECT_EQ(refusal(session, {"a"}, {41000}),
            "a: 41000.000000 is not in [0.000000, 40000.000000]; max_pa of its rig's file moves that limit");
  EXPECT_EQ(refusal(session, {"a"}, {-1}), "a: -1.000000 is not in [0.000000, 40000.000000]");
  EXPECT_TRUE(contains(refusal(session, {"a"}, {NAN}), "is not in"));
  EXPECT_EQ(refusal(session, {"c"}, {1}), "'c' is not one of a, b");
  EXPECT_EQ(session.channel(0).set_point_pa, 0.0);
}

// Small and large chambers, a sensor that is noisy or quiet, a leak: sound channels all, at every pressure.
TEST_P(PressureRig, ReportsNoFaultOfASoundChannel) {
  start();
  for (const char* volume_ml : {"15", "60", "200"}) {
    session.rig.ask(std::string("volume 0 ") + volume_ml);
    session.rig.ask("leak 1 0.0005");
    for (const char* noise_pa : {"0", "300"}) {
      session.rig.ask(std::string("sensor_noise 0 ") + noise_pa);
      for (const double value_pa : {20000.0, 40000.0, 1000.0, 39000.0, 25000.0, 0.0}) {
        session.command({"a", "b"}, {value_pa, 40000.0 - value_pa});
        session.run(1.5);
        ASSERT_EQ(session.channel(0).fault + session.channel(1).fault, "")
            << volume_ml << " " << noise_pa << " " << value_pa;
      }
    }
  }
}

// Every pin: the timers of the pulsed ones differ. Slow sensors' rounds, large chambers, the longest time to a fault.
class FourChannels : public testing::TestWithParam<std::pair<const char*, const char*>> {};

INSTANTIATE_TEST_SUITE_P(All, FourChannels,
                         testing::Values(std::pair("valves: {deadband_pa: 1000}", "regulator: {full_pa: 50000}"),
                                         std::pair("regulator: {full_pa: 50000}", "valves: {deadband_pa: 1000}")),
                         [](const auto& rig) { return rig.param.first[0] == 'v' ? "valves" : "regulators"; });

TEST_P(FourChannels, OfBothKindsReachTheirPressuresAndReportFaults) {
  const auto [odd, even] = GetParam();
  std::string yaml = "device: /dev/null\nsensor: {full_pa: 100000}\nwatch: {fault_s: 0.4}\nchannels:\n";
  for (int i = 0; i < 4; ++i)
    yaml +=
        "  - {name: " + std::string(1, static_cast<char>('a' + i)) + ", max_pa: 40000, " + (i % 2 ? odd : even) + "}\n";
  for (int broken = 0; broken < 4; ++broken) {
    PressureSession session(rig_file(yaml), 1, SOFT_ROBOT_LAB_RIG_EMULATOR);
    for (int i = 0; i < 4; ++i) session.rig.ask("volume " + std::to_string(i) + " 100");
    ASSERT_TRUE(session.run_until_ready());
    session.command({"a", "b", "c", "d"}, {10000, 15000, 20000, 25000});
    session.run(3.0);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(session.rig.pressures_pa().at(i), 10000.0 + 5000.0 * static_cast<double>(i), tolerance_pa) << i;
      EXPECT_EQ(session.channel(i).fault, "");
    }
    session.rig.ask("burst " + std::to_string(broken) + " on");
    const auto reported = [&] {
      return contains(session.channel(static_cast<std::size_t>(broken)).fault, "burst tube");
    };
    EXPECT_TRUE(session.run_until(reported, report_limit_s)) << broken;
    session.run(3.0);
    for (const double pressure_pa : session.rig.pressures_pa()) EXPECT_LT(pressure_pa, tolerance_pa) << broken;
  }
}

TEST(PressureRigCommands, AreAnsweredHoweverBadTheyAre) {
  Testbench rig(rig_file(valves), 1, SOFT_ROBOT_LAB_RIG_EMULATOR);
  for (const char* line :
       {"burst", "burst 2 on", "burst -1 on", "burst 0 maybe", "stuck 0", "stuck 0 on", "silent 0.5x on",
        "freeze nan on", "volume 0 0", "volume 0 nan", "leak 0 -1", "sensor_noise 0 1e9", "shafts", "stall 0 on"})
    EXPECT_THROW(rig.ask(line), std::invalid_argument) << line;
  EXPECT_EQ(rig.pressures_pa().size(), 2u);
}

// Commands at random; of the bytes, both ways, one in a hundred is lost, one corrupted, one doubled. What the board
// reports after it has taken a command on is that command, whole.
TEST_P(PressureRig, HoldsNoWrongSetPointOnANoisyLine) {
  start();
  session.rig.ask("noise 0.01 0.01 0.01");
  std::mt19937 random(7);
  constexpr int commands = 10000;
  int wrong = 0, reports = 0;
  for (int i = 0; i < commands; ++i) {
    const double a_pa = random() % 40001, b_pa = random() % 40001;
    const std::int64_t taken_before = session.driver().commands().acknowledged;
    ASSERT_EQ(refusal(session, {"a", "b"}, {a_pa, b_pa}), "") << i;
    ASSERT_TRUE(session.run_until([&] { return session.driver().commands().pending == 0; }, 2.0)) << i;
    ASSERT_EQ(session.driver().commands().acknowledged, taken_before + 1) << i;
    const double until_s = session.rig.time_s() + (i % 25 == 0 ? 0.045 : 0.003);  // sometimes two rounds of reports
    session.run_until([&] {
      ++reports;
      wrong += session.channel(0).set_point_pa != a_pa || session.channel(1).set_point_pa != b_pa;
      return session.rig.time_s() >= until_s;
    });
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(reports, commands);
  EXPECT_GT(session.driver().link_counts().resent, commands / 20);
  const LineFaults faults = session.rig.line_faults();
  EXPECT_GT(faults.corrupted, faults.passed / 200);
  EXPECT_GT(faults.lost, faults.passed / 200);
  EXPECT_GT(faults.doubled, faults.passed / 200);
}

const char* one_cable =
    "device: /dev/null\n"
    "motors:\n"
    "  - {name: left, cable: {rest_length_m: 0.1, min_contraction: 0.5, max_contraction: 1.2}}\n";

TEST(WrongBoard, IsRefusedByNameByADriverOfPressures) {
  const std::string file = rig_file(valves);
  Testbench motors(1, 1, SOFT_ROBOT_LAB_RIG_EMULATOR);
  PressureDriver driver(load_rig(file), {}, motors.ports());
  while (motors.time_s() < 0.5) {
    driver.update(motors.time_s());
    motors.run(0.005);
  }
  EXPECT_FALSE(driver.ready());
  EXPECT_EQ(driver.link_failure(),
            "the board runs the firmware for stepper motors, the rig's file lists pressure channels: take the right "
            "file or board, or flash the other firmware");
}

TEST(WrongBoard, IsRefusedByNameByADriverOfMotors) {
  Testbench air(rig_file(valves), 1, SOFT_ROBOT_LAB_RIG_EMULATOR);
  MotorDriver driver(parse_rig(one_cable, "test"), {}, air.ports());
  while (air.time_s() < 0.5) {
    driver.update(air.time_s());
    air.run(0.005);
  }
  EXPECT_FALSE(driver.ready());
  EXPECT_TRUE(contains(driver.link_failure(), "firmware for pressure channels, the rig's file lists stepper motors"))
      << driver.link_failure();
}

TEST(WrongDriver, RefusesTheOtherRigsFile) {
  const OpenPort none = []() -> std::unique_ptr<Port> { throw PortError("none"); };
  EXPECT_THROW(PressureDriver(parse_rig(one_cable, "test"), {}, none), std::invalid_argument);
  EXPECT_THROW(MotorDriver(parse_rig(valves, "test"), {}, none), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
