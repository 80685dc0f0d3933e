// SPDX-License-Identifier: BSD-3-Clause
#include "session/report/frame_recorder.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "robot/scene/scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

Scene robot(const std::string& name) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return load_scene(SOFT_ROBOT_LAB_SOURCE "/config/robots/" + name + "/robot.yaml", options);
}

SimulationState bent(Scene& scene, const std::string& cable, double contraction) {
  scene.simulation->reset();
  scene.simulation->set_command(cable, contraction);
  EXPECT_TRUE(scene.simulation->solve_equilibrium().converged);
  return scene.simulation->state();
}

CameraSetup box() { return read_camera_setup(SOFT_ROBOT_LAB_SOURCE "/config/cameras/box.yaml"); }

// How many cameras see the marker's middle.
int witnesses(const Capture& capture, int marker) {
  int count = 0;
  for (const auto& views : capture.views) count += views[static_cast<std::size_t>(marker)].centre_seen;
  return count;
}

// Of what is blue about a place.
Eigen::Vector2d centre_of_blue(const cv::Mat& colour, const Eigen::Vector2d& about) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int v = static_cast<int>(about.y()) - 7; v <= about.y() + 8; ++v)
    for (int u = static_cast<int>(about.x()) - 7; u <= about.x() + 8; ++u) {
      const auto& pixel = colour.at<cv::Vec3b>(v, u);
      sum += std::max(0, pixel[2] - pixel[0]) * Eigen::Vector3d(u, v, 1);
    }
  return sum.head<2>() / sum.z();
}

TEST(FrameRecorder, ShowsStickersWhereTheMarkersAre) {
  Scene scene = robot("spinebot");
  const SimulationState state = bent(scene, "left", 0.9);
  FrameRecorder film(*scene.simulation, box(), {SensorModel{}, 1});
  const Capture capture = film.take(state, state, 2.5);
  ASSERT_EQ(capture.frames.size(), 2u);
  int compared = 0;
  for (std::size_t camera = 0; camera < capture.frames.size(); ++camera)
    for (int marker = 0; marker < capture.markers_m.cols(); ++marker) {
      SCOPED_TRACE(capture.frames[camera].camera + " " +
                   scene.simulation->markers()[static_cast<std::size_t>(marker)].name());
      EXPECT_EQ(capture.markers_m.col(marker), scene.simulation->marker_position(marker));
      const MarkerView& view = capture.views[camera][static_cast<std::size_t>(marker)];
      if (view.share_seen < 1) continue;
      ++compared;
      EXPECT_LT((centre_of_blue(capture.frames[camera].colour, view.pixel) - view.pixel).norm(), 0.1);
      const float depth_m = capture.frames[camera].depth_m.at<float>(static_cast<int>(std::lround(view.pixel.y())),
                                                                     static_cast<int>(std::lround(view.pixel.x())));
      EXPECT_NEAR(depth_m, view.depth_m, 0.001);  // rounded to 1 mm, and up to half a pixel beside it on a slope
    }
  EXPECT_GE(compared, 8);
  EXPECT_EQ(capture.frames[1].stamp_s, 2.5);
}

TEST(FrameRecorder, DrawsTheSkinThroughTheMarkers) {
  Scene scene = robot("spinebot");
  const SimulationState state = bent(scene, "left", 0.8);
  const TetMesh& mesh = scene.simulation->body().mesh();
  const Skin skin(mesh);
  EXPECT_GE(skin.triangles().cols(), 16 * mesh.faces.cols());
  RayScene rays({}, {skin.triangles(), {1, 1, 1}, {}}, {skin.vertices_m(state.positions_m), {}});
  for (const Marker& marker : scene.simulation->markers()) {
    const Eigen::Vector3f at_m = marker.position(state.positions_m).cast<float>();
    const Eigen::Vector3f inward = marker.name() == "tip" ? Eigen::Vector3f(0, 0, 1) : Eigen::Vector3f(0, 1, 0);
    const float above_m = 0.01f;
    EXPECT_NEAR(rays.cast_at_robot(at_m - above_m * inward, inward, 0).depth, above_m, 2e-5) << marker.name();
  }
}

// The names of those that no camera sees, one after another.
std::string hidden(Scene& scene, const std::string& cable, double contraction) {
  const SimulationState state = bent(scene, cable, contraction);
  const Capture capture = FrameRecorder(*scene.simulation, box(), {SensorModel{}, 1}).take(state, state, 0);
  std::string names;
  for (int marker = 0; marker < capture.markers_m.cols(); ++marker)
    if (witnesses(capture, marker) == 0)
      names += scene.simulation->markers()[static_cast<std::size_t>(marker)].name() + " ";
  return names;
}

TEST(FrameRecorder, SeesEveryMarkerOfSpinebotInTheBox) {
  Scene scene = robot("spinebot");
  EXPECT_EQ(hidden(scene, "left", 1), "");
  EXPECT_EQ(hidden(scene, "left", 0.8), "");
  EXPECT_EQ(hidden(scene, "right", 0.8), "");
}

TEST(FrameRecorder, LosesTheEndOfHammerbotsHeadThatIsPulledUp) {
  Scene scene = robot("hammerbot");
  EXPECT_EQ(hidden(scene, "left", 1), "");
  EXPECT_EQ(hidden(scene, "left", 0.8), "head_left ");
  EXPECT_EQ(hidden(scene, "right", 0.8), "head_right ");
}

TEST(FrameRecorder, RepeatsItsNoiseFrameByFrame) {
  Scene scene = robot("spinebot");
  const SimulationState state = scene.simulation->state();
  FrameRecorder first(*scene.simulation, box(), {{}, 3}), second(*scene.simulation, box(), {{}, 3});
  const Capture one = first.take(state, state, 0), two = first.take(state, state, 0.1);
  EXPECT_EQ(cv::norm(one.frames[0].colour, second.take(state, state, 0).frames[0].colour, cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(one.frames[0].colour, two.frames[0].colour, cv::NORM_INF), 0);
}

TEST(FrameRecorder, RefusesStatesThatAreNotTheSimulations) {
  Scene scene = robot("spinebot");
  const SimulationState good = scene.simulation->state();
  FrameRecorder film(*scene.simulation, box(), {SensorModel{}, 1});
  SimulationState wrong = good;
  wrong.positions_m.conservativeResize(3, 5);
  EXPECT_THROW(film.take(good, wrong, 0), std::invalid_argument);
  EXPECT_THROW(film.take(wrong, good, 0), std::invalid_argument);
  wrong = good;
  wrong.positions_m(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(film.take(good, wrong, 0), std::invalid_argument);
  wrong = good;
  wrong.time_s = 1;
  EXPECT_THROW(film.take(wrong, good, 0), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
