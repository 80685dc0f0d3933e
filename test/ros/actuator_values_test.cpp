// SPDX-License-Identifier: BSD-3-Clause
#include "ros/panel/actuator_values.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

ActuatorRanges cable_and_chamber() {
  ActuatorRanges ranges;
  ranges.names = {"left", "main"};
  ranges.units = {"1", "ml"};
  ranges.rests = {1.0, 0.0};
  ranges.mins = {0.7, -5.0};
  ranges.maxs = {1.3, 120.0};
  return ranges;
}

ActuatorState state_of(double left, double main) {
  ActuatorState state;
  state.names = {"left", "main"};
  state.commands = {left, main};
  state.actuated_commands = {left, main};
  state.cables.resize(1);
  state.cables[0].name = "left";
  state.cables[0].tension_n = 1.25;
  state.chambers.resize(1);
  state.chambers[0].name = "main";
  state.chambers[0].gauge_pressure_pa = 3400.0;
  state.chambers[0].volume_m3 = 12.5e-6;
  return state;
}

class ShownActuators : public testing::Test {
 protected:
  ShownActuators() { values_.set_ranges(cable_and_chamber()); }

  const ActuatorRow& left() const { return values_.rows()[0]; }

  ActuatorValues values_;
};

TEST(ActuatorUnits, AreThoseThatPeopleSay) {
  ActuatorRanges ranges;
  ranges.names = {"length", "air", "whiff", "gas"};
  ranges.units = {"m", "Pa", "Pa", "1"};
  ranges.rests = {0.1, 0.0, 0.0, 1.0};
  ranges.mins = {0.08, -20000.0, 0.0, 0.5};
  ranges.maxs = {0.12, 50000.0, 500.0, 2.0};
  ActuatorValues values;
  values.set_ranges(ranges);
  const auto row = [&](std::size_t i) { return values.rows()[i]; };
  EXPECT_EQ(row(0).unit, "mm");
  EXPECT_EQ(row(0).max, 120.0);
  EXPECT_EQ(row(1).unit, "kPa");
  EXPECT_EQ(row(1).min, -20.0);
  EXPECT_EQ(row(2).unit, "Pa");
  EXPECT_EQ(row(3).unit, "");
  ActuatorState state;
  state.names = ranges.names;
  state.commands = {0.1042, 12345.0, 20.0, 1.0};
  state.actuated_commands = {0.1, 0.0, 20.0, 1.0};
  values.add_state(state, 0.0);
  EXPECT_EQ(row(0).shown, 104.2);
  EXPECT_EQ(row(0).measured, "100.0 mm");
  EXPECT_EQ(row(1).shown, 12.35);
  EXPECT_EQ(row(1).measured, "0.0 kPa");
  values.edit("air", 30.0, 0.0);
  values.edit("length", 90.0, 0.0);
  const ActuatorCommand command = values.take_command();
  ASSERT_EQ(command.names, (std::vector<std::string>{"air", "length"}));
  EXPECT_EQ(command.values[0], 30000.0);
  EXPECT_NEAR(command.values[1], 0.09, 1e-15);
  state.commands = {command.values[1], command.values[0], 20.0, 1.0};
  state.commands[1] = 30000.0;
  values.add_state(state, 0.1);
  state.commands[1] = 10000.0;  // of another, as its own holds
  values.add_state(state, 0.2);
  EXPECT_EQ(row(1).shown, 10.0);
  values.edit_all_to_reached(0.3);
  EXPECT_NEAR(values.take_command().values.back(), 0.1, 1e-15);
}

TEST_F(ShownActuators, StartAtTheModelsRestAndThenAtItsCommands) {
  EXPECT_EQ(left().shown, 1.0);
  values_.add_state(state_of(0.9, 20.0), 0.0);
  EXPECT_EQ(left().shown, 0.9);
  EXPECT_EQ(values_.rows()[1].shown, 20.0);
}

TEST_F(ShownActuators, SendNothingForWhatOthersCommand) {
  values_.add_state(state_of(0.9, 20.0), 0.0);
  values_.add_state(state_of(0.8333333, 21.0), 0.1);
  EXPECT_TRUE(values_.take_command().names.empty());
}

TEST_F(ShownActuators, SendExactlyWhatTheyShowAndOnce) {
  values_.edit("left", 0.87654321, 0.0);
  const ActuatorCommand command = values_.take_command();
  ASSERT_EQ(command.names, std::vector<std::string>{"left"});
  EXPECT_EQ(command.values[0], left().shown);
  EXPECT_NEAR(command.values[0], 0.8765, 1e-12);
  EXPECT_TRUE(values_.take_command().names.empty());
}

TEST_F(ShownActuators, SendOnlyTheLastOfManyEdits) {
  for (int i = 0; i <= 100; ++i) values_.edit("left", 1.0 - 0.001 * i, 0.01 * i);
  const ActuatorCommand command = values_.take_command();
  ASSERT_EQ(command.values.size(), 1u);
  EXPECT_NEAR(command.values[0], 0.9, 1e-12);
}

TEST_F(ShownActuators, DoNotJumpBackWhileACommandIsOnItsWay) {
  values_.add_state(state_of(1.0, 0.0), 0.0);
  values_.edit("left", 0.8, 1.0);
  values_.take_command();
  values_.add_state(state_of(1.0, 0.0), 1.1);
  EXPECT_EQ(left().shown, 0.8);
  values_.add_state(state_of(0.8, 0.0), 1.2);  // it holds; from here on others count again
  values_.add_state(state_of(0.95, 0.0), 1.3);
  EXPECT_EQ(left().shown, 0.95);
}

TEST_F(ShownActuators, ShowWhatHoldsWhereACommandWasRefused) {
  values_.edit("left", 0.8, 0.0);
  values_.take_command();
  values_.add_state(state_of(1.0, 0.0), ActuatorValues::timeout_s + 0.1);
  EXPECT_EQ(left().shown, 1.0);
  EXPECT_TRUE(values_.take_command().names.empty());
}

TEST_F(ShownActuators, StayWithinTheirLimitsAndRefuseWhatIsNoNumber) {
  values_.edit("left", 7.0, 0.0);
  EXPECT_EQ(left().shown, 1.3);
  values_.edit("left", std::numeric_limits<double>::quiet_NaN(), 0.0);
  EXPECT_EQ(left().shown, 1.3);
  values_.edit("tail", 1.0, 0.0);
  EXPECT_EQ(values_.take_command().names.size(), 1u);
}

TEST_F(ShownActuators, ShowNoNegativeZero) {
  ActuatorState state = state_of(0.9, 20.0);
  state.chambers[0].gauge_pressure_pa = -4.0;
  values_.add_state(state, 0.0);
  EXPECT_EQ(values_.rows()[1].measured, "20.0 ml, 0.00 kPa, 12.50 ml");
}

TEST_F(ShownActuators, ShowTheirMeasurementsInUnits) {
  values_.add_state(state_of(0.9, 20.0), 0.0);
  EXPECT_EQ(left().measured, "0.900, 1.25 N");
  EXPECT_EQ(values_.rows()[1].measured, "20.0 ml, 3.40 kPa, 12.50 ml");
}

TEST_F(ShownActuators, ShowWholeNumbersWhereTheRangeIsWide) {
  ActuatorRanges ranges = cable_and_chamber();
  ranges.units = {"Pa", "N"};
  ranges.rests = {0.0, 0.0};
  ranges.mins = {-20000.0, 0.0};
  ranges.maxs = {50000.0, 1e6};
  values_.set_ranges(ranges);
  values_.add_state(state_of(0.0, 123456.0), 0.0);
  EXPECT_EQ(left().measured, "0.0 kPa, 1.25 N");
  EXPECT_EQ(values_.rows()[1].measured.substr(0, 9), "123456 N,");
}

TEST_F(ShownActuators, HoldWhereTheDrivesAre) {
  ActuatorState state = state_of(0.8, 0.0);
  state.actuated_commands[0] = 0.93;
  values_.add_state(state, 0.0);
  values_.edit_all_to_reached(0.1);
  const ActuatorCommand command = values_.take_command();
  EXPECT_EQ(command.names, std::vector<std::string>{"left"});
  EXPECT_EQ(command.values, std::vector<double>{0.93});
}

TEST_F(ShownActuators, GoBackToRest) {
  values_.add_state(state_of(0.8, 30.0), 0.0);
  values_.edit_all_to_rest(0.1);
  EXPECT_EQ(values_.take_command().values, (std::vector<double>{1.0, 0.0}));
}

TEST_F(ShownActuators, HaveASliderWhoseEndsAreTheLimits) {
  EXPECT_EQ(left().value_at(0), 0.7);
  EXPECT_EQ(left().value_at(left().positions() - 1), 1.3);
  for (const ActuatorRow& row : values_.rows()) {
    EXPECT_GE(row.positions(), 200);
    EXPECT_LE(row.positions(), 2001);
  }
}

TEST_F(ShownActuators, BeginAnewWithAnotherScene) {
  values_.edit("left", 0.8, 0.0);
  const int before = values_.revision();
  values_.set_ranges(cable_and_chamber());
  EXPECT_GT(values_.revision(), before);
  EXPECT_EQ(left().shown, 1.0);
  EXPECT_TRUE(values_.take_command().names.empty());
}

TEST_F(ShownActuators, RefuseRangesThatAreNone) {
  ActuatorRanges ranges = cable_and_chamber();
  ranges.maxs[0] = ranges.mins[0];
  EXPECT_THROW(values_.set_ranges(ranges), std::invalid_argument);
  ranges = cable_and_chamber();
  ranges.mins[1] = -std::numeric_limits<double>::infinity();
  EXPECT_THROW(values_.set_ranges(ranges), std::invalid_argument);
  ranges = cable_and_chamber();
  ranges.units.pop_back();
  EXPECT_THROW(values_.set_ranges(ranges), std::invalid_argument);
  EXPECT_TRUE(values_.rows().empty());  // the old ones were another robot's
}

TEST_F(ShownActuators, LeaveOutStatesThatAreNotWhole) {
  ActuatorState state = state_of(0.9, 20.0);
  state.actuated_commands.pop_back();
  EXPECT_FALSE(values_.add_state(state, 0.0));
  state = state_of(std::nan(""), 20.0);
  values_.add_state(state, 0.0);
  EXPECT_EQ(left().shown, 1.0);
}

}  // namespace
}  // namespace soft_robot_lab
