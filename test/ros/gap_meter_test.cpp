// SPDX-License-Identifier: BSD-3-Clause
#include "ros/tracking/gap_meter.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

// Two markers that move along x by one metre a second, the second of them one metre above the first.
MarkerObservations markers_at(double stamp_s, std::uint8_t source, double off_m = 0.0) {
  MarkerObservations markers;
  markers.header.stamp = ros::Time(stamp_s);
  markers.names = {"low", "high"};
  markers.positions.resize(2);
  for (auto& position : markers.positions) position.x = stamp_s - 100.0 + off_m;
  markers.positions[1].z = 1.0;
  markers.sources = {source, source};
  return markers;
}

class Gaps : public testing::Test {
 protected:
  void simulate(double stamp_s) { meter.add_simulated(markers_at(stamp_s, MarkerObservations::SIMULATED)); }
  void see(double stamp_s, double off_m) { meter.add_measured(markers_at(stamp_s, MarkerObservations::SEEN, off_m)); }

  std::vector<RealityGap> gaps;
  GapMeter meter{[this](const RealityGap& gap) { gaps.push_back(gap); }};
};

TEST_F(Gaps, InterpolateTheSimulationAtTheStampOfWhatWasSeen) {
  simulate(100.0);
  see(100.25, 0.003);
  EXPECT_TRUE(gaps.empty());  // the simulation is not there yet
  simulate(101.0);
  ASSERT_EQ(gaps.size(), 1u);
  EXPECT_EQ(gaps[0].header.stamp, ros::Time(100.25));
  EXPECT_EQ(gaps[0].names, (std::vector<std::string>{"low", "high"}));
  EXPECT_NEAR(gaps[0].gaps[1].x, 0.003, 1e-12);
  EXPECT_NEAR(gaps[0].gaps[1].z, 0.0, 1e-12);
  EXPECT_NEAR(gaps[0].distances_m[0], 0.003, 1e-12);
  EXPECT_NEAR(gaps[0].rms_m, 0.003, 1e-12);
}

TEST_F(Gaps, GoOnWhereTheClockIsSetBack) {
  for (const double start_s : {4.0e9, 0.0, 100.0, 4.0e9}) {
    const auto after = [start_s](double time_s, std::uint8_t source) {
      MarkerObservations markers = markers_at(100.0 + time_s, source);
      markers.header.stamp = ros::Time(start_s + time_s);
      return markers;
    };
    gaps.clear();
    meter.add_measured(after(2.0, MarkerObservations::SEEN));  // is never compared where the clock goes back
    meter.add_simulated(after(0.0, MarkerObservations::SIMULATED));
    meter.add_measured(after(0.25, MarkerObservations::SEEN));
    meter.add_simulated(after(0.5, MarkerObservations::SIMULATED));
    ASSERT_EQ(gaps.size(), 1u) << start_s;
    EXPECT_EQ(gaps[0].header.stamp, ros::Time(start_s + 0.25));
  }
}

TEST_F(Gaps, GoOnThoughOneStampIsFarAhead) {
  simulate(100.0);
  MarkerObservations ahead = markers_at(100.05, MarkerObservations::SEEN);
  ahead.header.stamp = ros::Time(4.0e9);
  meter.add_simulated(ahead);
  meter.add_measured(ahead);
  gaps.clear();
  simulate(100.1);
  see(100.15, 0.003);
  simulate(100.2);
  ASSERT_EQ(gaps.size(), 1u);
  EXPECT_NEAR(gaps[0].rms_m, 0.003, 1e-9);
}

TEST_F(Gaps, RefuseMarkersThatAreNotWhole) {
  MarkerObservations bad = markers_at(100.0, MarkerObservations::SEEN);
  bad.positions.pop_back();
  EXPECT_THROW(meter.add_measured(bad), std::invalid_argument);
  bad = markers_at(100.0, MarkerObservations::SEEN, 1e300);
  EXPECT_THROW(meter.add_simulated(bad), std::invalid_argument);
}

TEST_F(Gaps, AreTheSameToTheLastDigitInWhateverOrderTheTopicsCame) {
  std::vector<RealityGap> others;
  GapMeter other([&](const RealityGap& gap) { others.push_back(gap); });
  other.add_measured(markers_at(100.1, MarkerObservations::SEEN, 0.001));
  for (int i = 0; i <= 6; ++i) {
    simulate(100.0 + i / 30.0);
    other.add_simulated(markers_at(100.0 + i / 30.0, MarkerObservations::SIMULATED));
  }
  see(100.1, 0.001);
  ASSERT_EQ(gaps.size(), 1u);
  ASSERT_EQ(others.size(), 1u);
  EXPECT_EQ(gaps[0].distances_m, others[0].distances_m);
  EXPECT_EQ(gaps[0].rms_m, others[0].rms_m);
}

TEST_F(Gaps, OfARecordingAreKnownHoweverLateItsTrackerWas) {
  std::vector<MarkerObservations> simulated;
  for (int i = 0; i < 20; ++i) simulated.push_back(markers_at(100.0 + i, MarkerObservations::SIMULATED));
  const auto found = gaps_between({markers_at(101.5, MarkerObservations::SEEN, 0.001)}, simulated);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].rms_m, 0.001, 1e-12);
}

TEST_F(Gaps, CountOnlyMarkersThatWereSeenAndSimulated) {
  simulate(100.0);
  MarkerObservations measured = markers_at(100.0, MarkerObservations::SEEN, 0.002);
  measured.sources[1] = MarkerObservations::INTERPOLATED;
  measured.positions[1].y = 1.0;
  measured.names.push_back("unknown");
  measured.positions.emplace_back();
  measured.sources.push_back(MarkerObservations::SEEN);
  meter.add_measured(measured);
  ASSERT_EQ(gaps.size(), 1u);
  EXPECT_EQ(gaps[0].names.size(), 2u);
  EXPECT_EQ(gaps[0].seen, (std::vector<std::uint8_t>{1, 0}));
  EXPECT_NEAR(gaps[0].rms_m, 0.002, 1e-12);
  EXPECT_GT(gaps[0].distances_m[1], 0.9);
}

TEST_F(Gaps, SayNothingWhereNothingWasSeen) {
  simulate(100.0);
  meter.add_measured(markers_at(100.0, MarkerObservations::INTERPOLATED, 0.002));
  EXPECT_TRUE(gaps.empty());
}

}  // namespace
}  // namespace soft_robot_lab
