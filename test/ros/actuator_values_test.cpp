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
  EXPECT_EQ(left().measured, "0 Pa, 1.25 N");
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
  EXPECT_EQ(values_.rows().size(), 2u);  // the old ones stay
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
