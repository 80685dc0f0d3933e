// SPDX-License-Identifier: BSD-3-Clause
// controller/fit_model on a recording of a bar that is softer than its model.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <soft_robot_lab/FitModel.h>
#include <std_msgs/String.h>
#include <unistd.h>

#include "session_ears.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "ros/messages/conversions.h"
#include "ros/base/topics.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

const std::string scenes = SOFT_ROBOT_LAB_SOURCE "/test/data/scenes/";
constexpr double model_pa = 264200, soft_pa = 224570;  // of cable_bar.yaml and cable_bar_soft.yaml

class FitModelService : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = fs::temp_directory_path() / ("soft_robot_lab_fit_" + std::to_string(getpid()));
    fs::create_directories(folder);
    write_bag();
    std::ofstream(folder / "empty.bag");
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }

  FitModel::Request request() const {
    FitModel::Request request;
    request.bag = folder / "session.bag";
    request.parameters = {"youngs_modulus_pa"};
    return request;
  }
  FitModel::Response fit(const FitModel::Request& request) { return ask<FitModel>(node_, topics::fit_model, request); }
  std::future<FitModel::Response> fit_meanwhile(const FitModel::Request& request) {
    return std::async(std::launch::async, [this, request] { return fit(request); });
  }

  static fs::path folder;
  ros::NodeHandle node_;

 private:
  // Two seconds at rest under each of some commands.
  static void write_bag() {
    SceneOptions options;
    options.actuator_factory = make_actuator;
    const auto robot = std::move(load_scene(scenes + "cable_bar_soft.yaml", options).simulation);
    rosbag::Bag bag((folder / "session.bag").string(), rosbag::bagmode::Write);
    std_msgs::String scene;
    scene.data = scenes + "cable_bar.yaml";
    bag.write("/simulator/scene", ros::Time(10.0), scene);
    double time_s = 10.0;
    for (const std::vector<double>& values :
         {std::vector{1.0, 1.0}, {1.0, 0.97}, {1.0, 0.94}, {0.97, 0.97}, {0.95, 1.0}}) {
      ActuatorCommand command;
      command.header.stamp = ros::Time(time_s);
      command.names = {"left", "right"};
      command.values = values;
      bag.write("/actuators/command", command.header.stamp, command);
      apply_command(command, *robot);
      robot->solve_equilibrium();
      for (int i = 0; i < 20; ++i, time_s += 0.1) {
        MarkerObservations seen = marker_observations(*robot, ros::Time(time_s));
        seen.sources.assign(seen.names.size(), MarkerObservations::SEEN);
        bag.write("/tracker/markers", seen.header.stamp, seen);
      }
    }
  }
};
fs::path FitModelService::folder;

TEST_F(FitModelService, FindsHowSoftTheRobotIsAndWritesItsScene) {
  FitModel::Request request = this->request();
  request.file = folder / "fitted.yaml";
  const auto fitted = fit(request);
  ASSERT_TRUE(fitted.success) << fitted.message;
  EXPECT_EQ(fitted.poses, 5);
  ASSERT_EQ(fitted.names, std::vector<std::string>{"youngs_modulus_pa"});
  EXPECT_NEAR(fitted.starts[0], model_pa, 1.0);
  EXPECT_NEAR(fitted.values[0], soft_pa, 0.01 * soft_pa);
  EXPECT_GT(fitted.deviations[0], 0.0);
  EXPECT_LT(fitted.lows[0], soft_pa);
  EXPECT_GT(fitted.highs[0], soft_pa);
  EXPECT_TRUE(fitted.identifiable[0]);
  EXPECT_LT(fitted.rms_after_m, 0.1 * fitted.rms_before_m);

  request.scene = request.file;  // what was written is what was found
  request.file.clear();          // it would include itself
  const auto again = fit(request);
  ASSERT_TRUE(again.success) << again.message;
  EXPECT_NEAR(again.starts[0], fitted.values[0], 1.0);
  EXPECT_NEAR(again.rms_before_m, fitted.rms_after_m, 1e-7);
}

TEST_F(FitModelService, RefusesBadRequests) {
  struct Case {
    const char* words;  // expected in the message
    void (*spoil)(FitModel::Request&);
  };
  const Case cases[] = {
      {"parameters: none", [](auto& r) { r.parameters.clear(); }},
      {"parameters: 'delassus' is not one of youngs_modulus_pa", [](auto& r) { r.parameters = {"delassus"}; }},
      {"starts: 2 given, must be none or 1",
       [](auto& r) {
         r.starts = {1.0e5, 2.0e5};
       }},
      {"start 10 is not in [", [](auto& r) { r.starts = {10.0}; }},
      {"model_error_m", [](auto& r) { r.model_error_m = -1.0; }},
      {"empty.bag: cannot be read as a bag", [](auto& r) { r.bag = folder / "empty.bag"; }},
      {"no_such.bag: cannot be read as a bag", [](auto& r) { r.bag = folder / "no_such.bag"; }},
      {"nothing to fit to: no markers came", [](auto& r) { r.bag.clear(); }},
      {"no_such_scene.yaml", [](auto& r) { r.scene = "/no_such_scene.yaml"; }},
      {"scene: 'bar.yaml' is no whole path", [](auto& r) { r.scene = "bar.yaml"; }},
      {"bag: 'session.bag' is no whole path", [](auto& r) { r.bag = "session.bag"; }},
      {"file: 'fitted.yaml' is no whole path", [](auto& r) { r.file = "fitted.yaml"; }},
      {"File name too long", [](auto& r) { r.file = "/" + std::string(300, 'a'); }},
      {"File name too long", [](auto& r) { r.bag = "/" + std::string(300, 'a'); }},
      {"mass_kg must be in [1e-06, 1e+06]", [](auto& r) { r.mass_kg = 1e-300; }},
      {"file: ", [](auto& r) { r.file = folder / "no_such_folder/fitted.yaml"; }},
      {"file: ", [](auto& r) { r.file = folder; }},
  };
  for (const Case& wrong : cases) {
    FitModel::Request request = this->request();
    wrong.spoil(request);
    const auto response = fit(request);
    EXPECT_FALSE(response.success) << wrong.words;
    EXPECT_NE(response.message.find(wrong.words), std::string::npos) << response.message;
    EXPECT_EQ(response.message.find("filesystem error"), std::string::npos) << response.message;
    EXPECT_TRUE(response.values.empty()) << wrong.words;
  }
}

TEST_F(FitModelService, RefusesASecondRequestWhileOneRuns) {
  FitModel::Request slow = request();
  slow.parameters = {"youngs_modulus_pa", "friction_coefficient", "compliance_m_n", "length_offset_m",
                     "camera_to_base"};
  auto one = fit_meanwhile(slow), other = fit_meanwhile(slow);  // whichever comes first
  const auto answers = {one.get(), other.get()};
  const auto done = std::count_if(answers.begin(), answers.end(), [](const auto& a) { return !a.values.empty(); });
  const auto refused = std::count_if(answers.begin(), answers.end(), [](const auto& a) {
    return !a.success && a.message == "busy with another fit; ask again when it ended";
  });
  EXPECT_EQ(done, 1);
  EXPECT_EQ(refused, 1);
  EXPECT_TRUE(fit(request()).success);
}

}  // namespace
}  // namespace soft_robot_lab
