// SPDX-License-Identifier: BSD-3-Clause
// Where the robot of a recording rested, and which part of it can be used.
#include "session/rest_periods.h"

#include <algorithm>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

// The tip there, as cameras see it, and a hidden marker.
ObservedMarkers seen_at(double time_s, double x_m) {
  const Eigen::Matrix3d unknown = Eigen::Matrix3d::Zero();
  return {time_s, {{"tip", {x_m, 0.0, 0.0}, unknown, true}, {"middle", {5.0, 0.0, 0.0}, unknown, false}}};
}

void command(Recording& recording, double left, double time_s) { recording.add_commands({"left"}, {left}, time_s); }

TEST(RestPeriods, AreFoundHoweverFewFramesASecondCame) {
  for (const double rate_hz : {30.0, 5.0, 3.0}) {
    Recording recording;
    for (int i = 0; i < static_cast<int>(12.0 * rate_hz); ++i)
      recording.add_measured(seen_at(10.0 + i / rate_hz, 0.001));
    command(recording, 1.0, 10.0);
    command(recording, 0.9, 16.0);
    EXPECT_EQ(rest_periods(recording).size(), 2u) << rate_hz;
  }
}

TEST(RestPeriods, AreFoundWhereAMarkerIsSeenBadly) {
  Recording recording;
  std::mt19937 random(1);
  std::normal_distribution<double> noise_m(0.0, 1e-3), little_m(0.0, 5e-5);
  // Two markers at five frames a second: at rest for 5 s, one of them badly seen; then both move by 1 mm a second.
  for (int i = 0; i < 50; ++i) {
    const double moved_m = 0.001 * std::max(0.0, 0.2 * i - 5.0);
    const double middle_m = moved_m + little_m(random);
    ObservedMarkers markers = seen_at(10.0 + 0.2 * i, moved_m + noise_m(random));
    markers.markers[1].position_m.x() = middle_m;
    markers.markers[1].seen = true;
    recording.add_measured(markers);
  }
  command(recording, 1.0, 10.0);
  command(recording, 0.9, 15.0);
  const std::vector<RestPeriod> periods = rest_periods(recording);
  ASSERT_EQ(periods.size(), 1u);
  EXPECT_EQ(periods[0].pose.commands.at("left"), 1.0);
  EXPECT_GT(periods[0].end_s - periods[0].start_s, 4.0);
}

TEST(RestPeriods, AreFoundThoughAFrameMissed) {
  Recording recording;
  for (int i = 0; i < 20; ++i)  // four seconds; now and then one frame of three is 3 mm off
    recording.add_measured(seen_at(10.0 + 0.2 * i, i % 5 == 2 ? 0.004 : 0.001));
  command(recording, 1.0, 10.0);
  EXPECT_EQ(rest_periods(recording).size(), 1u);
}

TEST(RestPeriods, BeginAfterAMarkerJumped) {
  for (int jump = 7; jump < 16; ++jump) {
    Recording recording;
    std::mt19937 random(1);
    std::normal_distribution<double> noise_m(0.0, 5e-5);
    for (int i = 0; i < 21; ++i)  // seven seconds at three frames a second
      recording.add_measured(seen_at(10.0 + i / 3.0, (i < jump ? 0.0 : 0.001) + noise_m(random)));
    const std::vector<RestPeriod> periods = rest_periods(recording);
    ASSERT_EQ(periods.size(), 1u) << jump;
    EXPECT_NEAR(periods[0].pose.markers.at(0).position_m.x(), 0.001, 2.5e-4) << jump;
  }
}

TEST(RestPeriods, SayWhyAHoldHasNone) {
  Recording recording;
  for (int i = 0; i < 60; ++i) recording.add_measured(seen_at(10.0 + 0.1 * i, 0.001 * i));  // 10 mm a second
  for (int i = 60; i < 120; ++i) {
    ObservedMarkers markers = seen_at(10.0 + 0.1 * i, 0.06);
    markers.markers[0].seen = false;
    recording.add_measured(markers);
  }
  command(recording, 1.0, 10.0);
  command(recording, 0.9, 16.0);
  const std::vector<MeasuredPose> poses = measured_poses(recording);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].left_out, "in the 6 s of it no marker came to rest within 0.5 mm; hold longer");
  EXPECT_EQ(poses[1].left_out, "no marker was seen 3 times in its last 0.5 s");
}

MotorReading motor(double left, bool moving, bool known) { return {"left", left, 0.0, known, moving, ""}; }

TEST(RestPeriods, StandWhereTheMotorsStood) {
  Recording recording;
  for (int i = 0; i < 120; ++i) recording.add_measured(seen_at(10.0 + 0.1 * i, 0.001));
  command(recording, 0.9, 13.0);
  command(recording, 0.8, 16.0);
  command(recording, 0.7, 19.0);
  const struct {
    double time_s, left;
    bool moving, known;
  } reports[] = {{10.0, 1.0, false, true},    {13.1, 0.95, true, true}, {14.0, 0.8998, false, true},
                 {15.99, 0.8998, true, true}, {17.0, 0.79, true, true}, {19.1, 0.7, false, false}};
  for (const auto& one : reports) recording.add_motors({motor(one.left, one.moving, one.known)}, one.time_s);
  const std::vector<MeasuredPose> poses = measured_poses(recording);
  ASSERT_EQ(poses.size(), 4u);
  EXPECT_EQ(poses[0].reached.at("left"), 1.0);
  EXPECT_EQ(poses[1].commands.at("left"), 0.9);
  EXPECT_EQ(poses[1].reached.at("left"), 0.8998);
  EXPECT_TRUE(poses[2].reached.empty()) << "it still moved";
  EXPECT_TRUE(poses[3].reached.empty()) << "it did not know where it was";
}

// Twenty seconds: commands at 3, 8 and 13 s; `event` changes what the motor says from 10 s on.
template <typename Event>
Recording with_event(const Event& event) {
  Recording recording;
  for (int i = 0; i < 200; ++i) recording.add_measured(seen_at(10.0 + 0.1 * i, 0.001));
  recording.add_motors({motor(1.0, false, false)}, 10.0);  // as before a link
  for (int i = 0; i < 3; ++i) command(recording, 0.9 - 0.1 * i, 13.0 + 5.0 * i);
  for (int i = 1; i < 200; ++i) {
    MotorReading reading = motor(0.9, false, true);
    reading.position_steps = 120.0;
    if (i >= 100) event(reading);
    recording.add_motors({reading}, 10.0 + 0.1 * i);
  }
  return recording;
}

std::size_t usable_poses(const Recording& recording, std::optional<double> from_s = {},
                         std::optional<double> to_s = {}) {
  std::size_t count = 0;
  for (const MeasuredPose& pose : measured_poses(usable_part(recording, from_s, to_s).recording))
    count += pose.markers.empty() ? 0 : 1;
  return count;
}

TEST(UsablePart, EndsWhereAMotorIsSetToZero) {
  const Recording recording = with_event([](MotorReading& motor) { motor.position_steps = 0.0; });
  EXPECT_EQ(measured_poses(recording).size(), 4u);
  EXPECT_EQ(usable_poses(recording), 3u);
  const std::string note = usable_part(recording).note;
  EXPECT_NE(note.find("used from 0.0 s to 10.0 s of 19.9 s; at 10.0 s: left was set to zero"), std::string::npos)
      << note;
  EXPECT_EQ(usable_poses(recording, 11.0), 2u) << "what comes after the event can be asked for";
}

TEST(UsablePart, EndsWhereAMotorStalls) {
  const Recording recording = with_event([](MotorReading& motor) {
    motor.known = false;
    motor.fault = "stalled; motor/clear";
  });
  EXPECT_EQ(usable_poses(recording), 3u);
  const std::string note = usable_part(recording).note;
  EXPECT_NE(note.find("left does not know where it is: stalled; motor/clear"), std::string::npos) << note;
}

TEST(UsablePart, IsAllWhereNothingHappened) {
  const Recording recording = with_event([](MotorReading& motor) { motor.position_steps = 121.0; });
  EXPECT_EQ(usable_part(recording).note, "");
  EXPECT_EQ(usable_poses(recording), 4u);
  EXPECT_EQ(usable_poses(recording, 4.0, 12.0), 2u);
  EXPECT_THROW(usable_part(recording, 40.0), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
