// SPDX-License-Identifier: BSD-3-Clause
#include "perception/calibration/calibration_session.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "ball_scene.h"

namespace soft_robot_lab {
namespace {

// Five balls before the small camera, none of them like another by its distances.
BallPlacement placement() {
  BallPlacement placement;
  placement.balls = {{"a", {-0.12, 0, 0.06}},
                     {"b", {0.13, 0.04, 0.05}},
                     {"c", {0.01, -0.03, 0.02}},
                     {"d", {-0.09, 0.06, -0.06}},
                     {"e", {0.09, 0.02, -0.05}}};
  return placement;
}

class CalibrationSessionTest : public ::testing::Test {
 protected:
  CalibrationSessionTest() : session(placement(), {}, 2) { session.set_camera({"camera", camera.model, {}}); }

  void film(const std::vector<Ball>& balls) {
    for (const RgbdFrame& frame : film_balls(camera, dark_room(), balls, 1, 2).with) session.add(frame);
  }
  static std::vector<Ball> balls(std::size_t count = 5) {
    std::vector<Ball> all;
    for (const PlacedBall& ball : placement().balls)
      if (all.size() < count) all.push_back(ball_at(ball.position_m.x(), ball.position_m.y(), ball.position_m.z()));
    return all;
  }
  std::string refusal() {
    try {
      session.calibrate();
    } catch (const CalibrationError& error) {
      return error.what();
    }
    return "not refused";
  }

  const RigCamera camera = small_ball_camera(SensorModel::d415());
  CalibrationSession session;
};

TEST_F(CalibrationSessionTest, CalibratesFromPicturesWithoutAndWithBalls) {
  film({});
  session.remember_without_balls();
  EXPECT_EQ(refusal(), "camera has sent 0 pictures; needed: 2");  // the old ones show no balls
  film(balls());
  const std::vector<CameraCalibration> calibrations = session.calibrate();
  ASSERT_EQ(calibrations.size(), 1u);
  EXPECT_EQ(calibrations[0].pose.name, "camera");
  const Eigen::Isometry3d miss = camera.pose.world_from_camera.inverse() * calibrations[0].pose.world_from_camera;
  EXPECT_LT(miss.translation().norm(), 0.0005);
  EXPECT_LT(Eigen::AngleAxisd(miss.linear()).angle(), 0.1 * M_PI / 180);
}

TEST_F(CalibrationSessionTest, SaysWhatElseItSaw) {
  film({});
  session.remember_without_balls();
  std::vector<Ball> four = balls(4);
  four.push_back(ball_at(0.09, 0.02, -0.05, 0.026));
  film(four);
  EXPECT_NE(refusal().find("sees 4 balls"), std::string::npos) << refusal();
  EXPECT_NE(refusal().find("has a radius of"), std::string::npos) << refusal();
}

TEST_F(CalibrationSessionTest, RefusesTheWrongOrder) {
  EXPECT_THROW(session.remember_without_balls(), CalibrationError);
  film(balls());
  EXPECT_NE(refusal().find("film those first"), std::string::npos);
  EXPECT_THROW(CalibrationSession(placement(), {}, 0), std::invalid_argument);
  EXPECT_THROW(CalibrationSession(placement(), {}).calibrate(), CalibrationError);
}

}  // namespace
}  // namespace soft_robot_lab
