#include "soft_robot_lab/experiment/film.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "scene/scene_files.h"
#include "soft_robot_lab/actuators/factory.h"
#include "soft_robot_lab/scene/scene.h"

namespace soft_robot_lab {
namespace {

Scene robot(const std::string& name) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return load_scene(SOFT_ROBOT_LAB_SOURCE "/config/robots/" + name + ".yaml", options);
}

SimulationState bent(Scene& scene, const std::string& cable, double contraction) {
  scene.simulation->reset();
  scene.simulation->set_command(cable, contraction);
  EXPECT_TRUE(scene.simulation->solve_equilibrium().converged);
  return scene.simulation->state();
}

CameraRig box() { return read_camera_rig(SOFT_ROBOT_LAB_SOURCE "/config/cameras/box.yaml"); }

// How many cameras see the marker's middle.
int witnesses(const Shot& shot, int marker) {
  int count = 0;
  for (const auto& views : shot.views) count += views[static_cast<std::size_t>(marker)].centre_seen;
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

TEST(Film, ShowsStickersWhereTheMarkersAre) {
  Scene scene = robot("spinebot");
  const SimulationState state = bent(scene, "left", 0.9);
  Film film(*scene.simulation, box(), {SensorModel{}, 1});
  const Shot shot = film.take(state, state, 2.5);
  ASSERT_EQ(shot.frames.size(), 2u);
  int compared = 0;
  for (std::size_t camera = 0; camera < shot.frames.size(); ++camera)
    for (int marker = 0; marker < shot.markers_m.cols(); ++marker) {
      SCOPED_TRACE(shot.frames[camera].camera + " " +
                   scene.simulation->markers()[static_cast<std::size_t>(marker)].name());
      EXPECT_EQ(shot.markers_m.col(marker), scene.simulation->marker_position(marker));
      const MarkerView& view = shot.views[camera][static_cast<std::size_t>(marker)];
      if (view.share_seen < 1) continue;
      ++compared;
      EXPECT_LT((centre_of_blue(shot.frames[camera].colour, view.pixel) - view.pixel).norm(), 0.1);
      const float depth_m = shot.frames[camera].depth_m.at<float>(static_cast<int>(std::lround(view.pixel.y())),
                                                                  static_cast<int>(std::lround(view.pixel.x())));
      EXPECT_NEAR(depth_m, view.depth_m, 0.001);  // rounded to 1 mm, and up to half a pixel beside it on a slope
    }
  EXPECT_GE(compared, 8);
  EXPECT_EQ(shot.frames[1].stamp_s, 2.5);
}

TEST(Film, DrawsTheSkinThroughTheMarkers) {
  Scene scene = robot("spinebot");
  const SimulationState state = bent(scene, "left", 0.8);
  const TetMesh& mesh = scene.simulation->body().mesh();
  const Skin skin(mesh);
  EXPECT_GE(skin.triangles().cols(), 16 * mesh.faces.cols());
  Stage stage({}, {skin.triangles(), {1, 1, 1}, {}}, {skin.vertices_m(state.positions_m), {}});
  for (const Marker& marker : scene.simulation->markers()) {
    const Eigen::Vector3f at_m = marker.position(state.positions_m).cast<float>();
    const Eigen::Vector3f inward = marker.name() == "tip" ? Eigen::Vector3f(0, 0, 1) : Eigen::Vector3f(0, 1, 0);
    const float above_m = 0.01f;
    EXPECT_NEAR(stage.glance_at_robot(at_m - above_m * inward, inward, 0).depth, above_m, 2e-5) << marker.name();
  }
}

// The names of those that no camera sees, one after another.
std::string hidden(Scene& scene, const std::string& cable, double contraction) {
  const SimulationState state = bent(scene, cable, contraction);
  const Shot shot = Film(*scene.simulation, box(), {SensorModel{}, 1}).take(state, state, 0);
  std::string names;
  for (int marker = 0; marker < shot.markers_m.cols(); ++marker)
    if (witnesses(shot, marker) == 0)
      names += scene.simulation->markers()[static_cast<std::size_t>(marker)].name() + " ";
  return names;
}

TEST(Film, SeesEveryMarkerOfSpinebotInTheBox) {
  Scene scene = robot("spinebot");
  EXPECT_EQ(hidden(scene, "left", 1), "");
  EXPECT_EQ(hidden(scene, "left", 0.8), "");
  EXPECT_EQ(hidden(scene, "right", 0.8), "");
}

TEST(Film, LosesTheEndOfHammerbotsHeadThatIsPulledUp) {
  Scene scene = robot("hammerbot");
  EXPECT_EQ(hidden(scene, "left", 1), "");
  EXPECT_EQ(hidden(scene, "left", 0.8), "head_left ");
  EXPECT_EQ(hidden(scene, "right", 0.8), "head_right ");
}

TEST(Film, RepeatsItsNoiseFrameByFrame) {
  Scene scene = robot("spinebot");
  const SimulationState state = scene.simulation->state();
  Film first(*scene.simulation, box(), {{}, 3}), second(*scene.simulation, box(), {{}, 3});
  const Shot one = first.take(state, state, 0), two = first.take(state, state, 0.1);
  EXPECT_EQ(cv::norm(one.frames[0].colour, second.take(state, state, 0).frames[0].colour, cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(one.frames[0].colour, two.frames[0].colour, cv::NORM_INF), 0);
}

TEST(Film, RefusesStatesThatAreNotTheSimulations) {
  Scene scene = robot("spinebot");
  const SimulationState good = scene.simulation->state();
  Film film(*scene.simulation, box(), {SensorModel{}, 1});
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
