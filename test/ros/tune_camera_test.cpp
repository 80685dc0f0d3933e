// SPDX-License-Identifier: BSD-3-Clause
// A rendered camera behind its driver's dynamic_reconfigure, and the program that tunes it as it would a real one.
#include <future>
#include <string>

#include <Eigen/Geometry>
#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/Image.h>
#include <std_srvs/SetBool.h>

#include "session_ears.h"
#include "run_program.h"
#include "perception/render/camera_setup.h"
#include "ros/cameras/camera_driver.h"
#include "ros/messages/image_messages.h"
#include "ros/base/topics.h"
#include "ros/tracking/tracking_input.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "perception/calibration/camera_tuning.h"

namespace soft_robot_lab {
namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigDescription;
using dynamic_reconfigure::Reconfigure;

class TuneCamera : public testing::Test {
 protected:
  ~TuneCamera() override { show_balls(false); }

  void show_balls(bool shown) {
    std_srvs::SetBool::Request request;
    request.data = shown;
    EXPECT_TRUE(ask<std_srvs::SetBool>(node_, topics::show_balls, request).success);
  }

  CameraSetting reconfigure(const Config& config) {
    Reconfigure::Request request;
    request.config = config;
    return camera_setting(ask<Reconfigure>(node_, set_parameters_service("eye"), request).config);
  }

  // What is hung up as soon as the program asks for it.
  Outcome tune(const std::string& arguments, bool with_balls) {
    bool asked = false;
    const ros::Subscriber log = node_.subscribe<rosgraph_msgs::Log>(
        "/rosout", 100, boost::function<void(const rosgraph_msgs::Log::ConstPtr&)>([&](const auto& message) {
          asked = asked || message->msg.find("now hang up white balls") != std::string::npos;
        }));
    static int runs = 0;  // the parameters of a run stay with its name
    const std::string name = "tune_camera_" + std::to_string(++runs);
    auto outcome = std::async(std::launch::async, [&] {
      return run_program(SOFT_ROBOT_LAB_TUNE_CAMERA, folder_, "__name:=" + name + " _settle_frames:=2 " + arguments);
    });
    const auto ended = [&] { return outcome.wait_for(std::chrono::seconds(0)) == std::future_status::ready; };
    EXPECT_TRUE(spin_until([&] { return asked || ended(); }, 60));
    if (asked && with_balls) show_balls(true);
    EXPECT_TRUE(spin_until(ended, 90));
    return outcome.get();
  }

  // Of the rig's ball, by a picture taken from now on.
  BallMeasure measure() {
    const CameraSetup rig = read_camera_setup(SOFT_ROBOT_LAB_SOURCE "/test/data/cameras/overexposed.yaml");
    const RigCamera& camera = rig.cameras.front();
    FoundBall ball;
    ball.radius_m = rig.calibration_balls.front().radius_m;
    ball.center_m = camera.pose.world_from_camera.inverse() * rig.calibration_balls.front().center_m;
    for (int i = 0; i < 2; ++i) hear<sensor_msgs::Image>(node_, colour_topic("eye"));
    const auto image = hear<sensor_msgs::Image>(node_, colour_topic("eye"));
    return measure_balls(colour_image(*image), {place_of(ball, camera.model)});
  }

  ros::NodeHandle node_;
  SceneFolder folder_;
};

TEST_F(TuneCamera, FindsAnAutomaticCameraAndCutsWhatIsOutOfRange) {
  EXPECT_TRUE(reconfigure(config_message({})).automatic);
  const CameraSetting cut = reconfigure(config_message({false, 20000, -3}));
  EXPECT_FALSE(cut.automatic);
  EXPECT_EQ(cut.exposure, 10000);
  EXPECT_EQ(cut.gain, 0);
  const auto update = hear<Config>(node_, parameter_updates_topic("eye"));
  EXPECT_EQ(camera_setting(*update).exposure, 10000);
  const auto description = hear<ConfigDescription>(node_, parameter_descriptions_topic("eye"));
  EXPECT_EQ(camera_setting_limits(*description).max_gain, 128);
  Config gain_only;
  gain_only.ints = config_message({false, 1, 77}).ints;
  gain_only.ints.erase(gain_only.ints.begin());
  const CameraSetting changed = reconfigure(gain_only);
  EXPECT_EQ(changed.exposure, 10000);
  EXPECT_EQ(changed.gain, 77);
}

TEST_F(TuneCamera, MakesTheBallCrispAndTheBoxDark) {
  EXPECT_TRUE(reconfigure(config_message({})).automatic);
  show_balls(true);
  const BallMeasure before = measure();
  EXPECT_GT(before.saturated_share, 0.5);
  EXPECT_GT(before.box_level, 0.12);
  show_balls(false);
  const std::string file = folder_.path("eye.yaml");
  const Outcome outcome = tune("_camera:=eye _output:=" + file, true);
  ASSERT_EQ(outcome.exit_status, 0) << outcome.out << outcome.err;
  const CameraSetting setting = reconfigure({});
  EXPECT_FALSE(setting.automatic);
  const BallMeasure after = measure();
  EXPECT_LE(after.saturated_share, 0.01);
  EXPECT_GE(after.darkest_level, 0.5);
  EXPECT_LE(after.brightest_level, 0.92);
  EXPECT_LE(after.box_level, 0.125);
  ASSERT_TRUE(after.edge_width_px);
  EXPECT_LT(*after.edge_width_px, 4);
  const YamlNode saved = YamlNode::load_file(file);
  EXPECT_FALSE(saved.boolean("enable_auto_exposure"));
  EXPECT_EQ(saved.integer("exposure", 1, 10000), setting.exposure);
  EXPECT_EQ(saved.integer("gain", 0, 128), setting.gain);
}

TEST_F(TuneCamera, RefusesWithoutABallAndSetsTheOldSettingAgain) {
  reconfigure(config_message({false, 123, 45}));
  const Outcome outcome = tune("_camera:=eye _timeout_s:=4", false);
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE((outcome.out + outcome.err).find("eye: no ball found"), std::string::npos) << outcome.out << outcome.err;
  const CameraSetting setting = reconfigure({});
  EXPECT_FALSE(setting.automatic);
  EXPECT_EQ(setting.exposure, 123);
  EXPECT_EQ(setting.gain, 45);
}

TEST_F(TuneCamera, RefusesWhereThereIsNoDriver) {
  const Outcome outcome = tune("_camera:=nobody _timeout_s:=1", false);
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE((outcome.out + outcome.err).find("no service /nobody/rgb_camera/set_parameters"), std::string::npos)
      << outcome.out << outcome.err;
}

TEST_F(TuneCamera, RefusesBadOptionsByName) {
  const Outcome outcome = tune("_camera:=eye _max_exposure:=0", false);
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE((outcome.out + outcome.err).find("max_exposure is 0"), std::string::npos) << outcome.out << outcome.err;
}

// Drivers that answer, but not as they should.
class OddDriver {
 public:
  OddDriver(ros::NodeHandle& node, const Config& answer) {
    descriptions_ = node.advertise<ConfigDescription>(parameter_descriptions_topic("odd"), 1, true);
    descriptions_.publish(description_message({}, {}));
    service_ = node.advertiseService<Reconfigure::Request, Reconfigure::Response>(set_parameters_service("odd"),
                                                                                  [answer](auto&, auto& response) {
                                                                                    response.config = answer;
                                                                                    return true;
                                                                                  });
  }

 private:
  ros::Publisher descriptions_;
  ros::ServiceServer service_;
};

TEST_F(TuneCamera, RefusesADriverThatDoesNotTakeAValue) {
  const OddDriver driver(node_, config_message({false, 50, 64}));
  const Outcome outcome = tune("_camera:=odd _timeout_s:=5", false);
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE((outcome.out + outcome.err).find("enable_auto_exposure: the camera's driver was asked for 1 and has 0"),
            std::string::npos)
      << outcome.out << outcome.err;
}

TEST_F(TuneCamera, RefusesADriverWithoutGain) {
  Config answer = config_message({false, 50, 64});
  answer.ints.pop_back();
  const OddDriver driver(node_, answer);
  const Outcome outcome = tune("_camera:=odd _timeout_s:=5", false);
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE((outcome.out + outcome.err).find("no parameter 'gain' of its type, only exposure"), std::string::npos)
      << outcome.out << outcome.err;
}

}  // namespace
}  // namespace soft_robot_lab
