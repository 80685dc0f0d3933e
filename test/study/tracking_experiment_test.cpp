// SPDX-License-Identifier: BSD-3-Clause
// Rendered cameras film Spinebot, and the tracker finds its markers.
#include "study/experiments/tracking_score.h"

#include <cmath>

#include <gtest/gtest.h>

#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

const std::string kConfig = SOFT_ROBOT_LAB_SOURCE "/config/";

TrackingScore track_spinebot(const SensorModel& sensor, const DepthSettings& depth = {}) {
  constexpr double kRate_hz = 30;
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  options.overrides.set({"solver", "time_step_s"}, 0.0166667);
  const Scene scene = load_scene(kConfig + "robots/spinebot/robot.yaml", options);
  Simulation& simulation = *scene.simulation;
  const auto moments = move_through(simulation, {{0.8, 1.1}, {1, 1}}, 4 / kRate_hz + 1e-9, kRate_hz);
  CameraSetup rig = read_camera_setup(kConfig + "cameras/box.yaml");
  for (RigCamera& camera : rig.cameras) camera.sensor = sensor;
  TrackerSettings settings = load_tracker(kConfig + "robots/spinebot/tracker.yaml");
  settings.readout_s = sensor.readout_time_s;
  settings.depth = depth;
  return track(moments, simulation, rig, settings, [](double) {});
}

TEST(Tracking, FollowsSpinebotThroughExactImagesWithinATenthOfAMillimetre) {
  SensorModel exact;
  exact.depth_step_m = 0;
  DepthSettings known;
  known.noise_per_m = 1e-6;
  known.quantisation_m = 0;
  const TrackingScore score = track_spinebot(exact, known);
  EXPECT_EQ(score.frames, 8);
  EXPECT_GT(score.visible, 40);
  EXPECT_EQ(score.missed, 0);
  EXPECT_EQ(score.swaps, 0);
  for (std::size_t i = 0; i < score.marker_seen.size(); ++i)
    EXPECT_LT(std::sqrt(score.marker_squared_error_m2[i] / score.marker_seen[i]), 1e-4) << i;
}

TEST(Tracking, FollowsSpinebotThroughAD415sImagesWithinAMillimetre) {
  const TrackingScore score = track_spinebot(SensorModel::d415());
  EXPECT_LE(score.missed, 1);
  EXPECT_EQ(score.swaps, 0);
  EXPECT_EQ(score.wrong, 0);
  EXPECT_LT(score.rms_m(), 1e-3);
}

}  // namespace
}  // namespace soft_robot_lab
