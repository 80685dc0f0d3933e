// SPDX-License-Identifier: BSD-3-Clause
// Bags of sessions, and the page about them.
#include "ros/recording/recorded_session.h"

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <sys/resource.h>
#include <rosbag/bag.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/Marker.h>

#include "ros/controller/fit_service.h"
#include "ros/messages/frames.h"
#include "ros/messages/image_messages.h"
#include "ros/report/session_report.h"
#include "ros/tracking/tracker_parameters.h"
#include "session/rest_periods.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

MarkerObservations observation(double time_s, double x_m, double hidden_x_m, uint8_t source) {
  MarkerObservations markers;
  markers.header.stamp = ros::Time(time_s);
  markers.names = {"tip", "middle"};
  markers.positions.resize(2);
  markers.positions[0].x = x_m;
  markers.positions[1].x = hidden_x_m;
  markers.covariances.assign(18, 0.0);
  markers.sources = {source, MarkerObservations::INTERPOLATED};
  return markers;
}

ActuatorCommand command(double time_s, double left) {
  ActuatorCommand message;
  message.header.stamp = ros::Time(time_s);
  message.names = {"left"};
  message.values = {left};
  return message;
}

// Three seconds at rest, a move of one second with commands all along, three seconds at rest, a move without rest.
double position_m(double time_s) {
  return time_s < 13.0 ? 0.0 : time_s < 14.0 ? 0.02 * (time_s - 13.0) : time_s < 17.0 ? 0.02 : 0.02 * (time_s - 16.0);
}

class Session : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("soft_robot_lab_recording_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write_bag(bool tracked) const {
    const std::string path = (folder_ / "session.bag").string();
    rosbag::Bag bag(path, rosbag::bagmode::Write);
    std_msgs::String scene;
    scene.data = scene_.empty() ? bar() : scene_;
    bag.write("/simulator/scene", ros::Time(10.0), scene);
    std::mt19937 random(1);
    std::normal_distribution<double> noise_m(0.0, 1e-4);
    for (int i = 0; i < 270; ++i) {
      const double time_s = 10.0 + i / 30.0;
      if (tracked)
        bag.write("/tracker/markers", ros::Time(time_s),
                  observation(time_s, position_m(time_s) + noise_m(random), 5.0, MarkerObservations::SEEN));
      bag.write("/simulator/markers", ros::Time(time_s),
                observation(time_s, position_m(time_s) + 0.003, 0.0, MarkerObservations::SIMULATED));
      if (time_s >= 13.0 && time_s < 14.0)
        bag.write("/actuators/command", ros::Time(time_s), command(time_s, 1.0 - 0.1 * (time_s - 13.0)));
    }
    bag.write("/actuators/command", ros::Time(14.0), command(14.0, 0.9));
    bag.write("/actuators/command", ros::Time(17.0), command(17.0, 0.8));
    return path;
  }

  static std::string bar() { return std::string(SOFT_ROBOT_LAB_SOURCE) + "/test/data/scenes/cable_bar.yaml"; }

  // The page about a recording that names this scene.
  std::string page_about(const std::string& recorded_scene, const std::string& given = "") {
    scene_ = recorded_scene;
    std::ifstream file(write_session_report(write_bag(true), (folder_ / "report").string(), given).page);
    std::ostringstream page;
    page << file.rdbuf();
    return page.str();
  }

  fs::path folder_;
  std::string scene_;  // that the recording names; empty: bar()
};

TEST_F(Session, FindsWhereTheRobotRested) {
  const RecordedSession recording = read_recorded_session(write_bag(true));
  EXPECT_NE(recording.scene.find("cable_bar.yaml"), std::string::npos);
  const std::vector<RestPeriod> periods = rest_periods(recording);
  ASSERT_EQ(periods.size(), 2u);
  EXPECT_TRUE(periods[0].pose.commands.empty());
  EXPECT_NEAR(periods[1].pose.commands.at("left"), 0.9, 1e-12);
  EXPECT_GE(periods[1].start_s, 14.0);
  EXPECT_LE(periods[1].end_s, 17.0);
  EXPECT_GT(periods[1].end_s - periods[1].start_s, 2.0);
  ASSERT_EQ(periods[1].pose.markers.size(), 1u) << "the hidden marker was estimated, not measured";
  const MeasuredMarker& tip = periods[1].pose.markers[0];
  EXPECT_EQ(tip.name, "tip");
  EXPECT_NEAR(tip.position_m.x(), 0.02, 5e-5);
  EXPECT_NEAR(std::sqrt(tip.covariance_m2(0, 0)), 1e-4 / std::sqrt(75.0), 4e-6);
  EXPECT_EQ(measured_poses(recording).size(), 3u) << "friction has to know of the last move too";
}

TEST_F(Session, FindsWhatFollowedEachMove) {
  const std::vector<MeasuredSwing> swings = measured_swings(read_recorded_session(write_bag(true)));
  ASSERT_EQ(swings.size(), 2u);
  EXPECT_TRUE(swings[0].from.empty());
  EXPECT_EQ(swings[0].commands.size(), 31u);
  EXPECT_NEAR(swings[0].commands.front().time_s, 13.0, 1e-9);
  EXPECT_EQ(swings[0].commands.back().commands.front(), (std::pair<std::string, double>{"left", 0.9}));
  EXPECT_GT(swings[0].seen.front().time_s, 13.0);
  EXPECT_LE(swings[0].seen.back().time_s, 17.0);
  EXPECT_EQ(swings[0].seen.size(), 120u);
  ASSERT_EQ(swings[0].seen[0].markers.size(), 1u) << "the hidden marker was estimated, not measured";
  EXPECT_EQ(swings[0].seen[0].markers[0].name, "tip");
  EXPECT_NEAR(swings[1].from.at("left"), 0.9, 1e-12);
  EXPECT_EQ(swings[1].commands.size(), 1u);
}

#ifdef SOFT_ROBOT_LAB_STUDY_PROGRAM
TEST_F(Session, IsFittedByTheTasksOfAStudy) {
  write_bag(true);
  std::ofstream(folder_ / "study.yaml")
      << "program: fit_model\nscene: " << bar()
      << "\narguments: [session.bag, --parameters, length_offset_m.left, --model-error, '0.1']\n"
         "parameters: {body.material.youngs_modulus_pa: {values: [2.0e+5, 3.0e+5]}}\n";
  const std::string found = folder_ / "found", command = SOFT_ROBOT_LAB_STUDY_PROGRAM " " +
                                                         (folder_ / "study.yaml").string() + " --output " + found +
                                                         " >" + (folder_ / "log").string() + " 2>&1";
  const int status = std::system(command.c_str());
  ASSERT_LT(WEXITSTATUS(status), 2) << "1: a fit that did not converge has a result too";
  std::ifstream file(found + "/results.csv");
  std::string header, first;
  std::getline(file, header);
  std::getline(file, first);
  for (const std::string name : {"values.length_offset_m.left.value", "after.rms_m", "converged"})
    EXPECT_NE(header.find("," + name), std::string::npos) << header;
  EXPECT_EQ(first.find(",failed,"), std::string::npos) << first;
}
#endif

TEST_F(Session, RefusesWhatIsNoRecordingOfASession) {
  const auto refusal = [](const std::string& path) {
    try {
      read_recorded_session(path);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string("nothing refused");
  };
  EXPECT_NE(refusal((folder_ / "none.bag").string()).find("cannot be read as a bag"), std::string::npos);
  std::ofstream(folder_ / "text.bag") << "no bag at all, just words that go on for a while";
  EXPECT_NE(refusal((folder_ / "text.bag").string()).find("cannot be read as a bag"), std::string::npos);
  EXPECT_NE(refusal("/dev/zero").find("no regular file"), std::string::npos);
  EXPECT_NE(refusal(write_bag(false)).find("no markers of a tracker"), std::string::npos);
}

// Grey pictures of a camera half a metre in front, recorded a tenth of a second after they were taken.
void add_images(const std::string& path, double until_s = 19.0) {
  rosbag::Bag bag(path, rosbag::bagmode::Append);
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  world_from_camera.translation().z() = -0.5;
  tf2_msgs::TFMessage tree;
  tree.transforms = {transform_message("world", optical_frame("camera_left"), world_from_camera)};
  bag.write("/tf_static", ros::Time(10.0), tree);
  for (double time_s = 10.0; time_s < until_s; time_s += 0.05) {
    const RgbdFrame frame{"camera_left", time_s, cv::Mat(36, 64, CV_8UC3, cv::Scalar(99, 99, 99)),
                          cv::Mat(36, 64, CV_32FC1, cv::Scalar(0.5)), 0.001};
    const FrameMessages messages = frame_messages(frame, d415_camera(64, 36), ros::Time(time_s));
    bag.write("/camera_left/color/camera_info", ros::Time(time_s + 0.1), messages.info);
    bag.write("/camera_left/color/image_raw", ros::Time(time_s + 0.1), messages.colour);
  }
}

// What `act` refuses, or "".
template <typename Act>
std::string refusal_of(const Act& act) {
  try {
    act();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

// A message of a topic that carries another type.
template <typename Message>
void expect_refused(const std::string& bag, const std::string& topic, const std::string& wanted, const Message& other) {
  rosbag::Bag(bag, rosbag::bagmode::Append).write(topic, ros::Time(12.0), other);
  const std::string folder = fs::path(bag).parent_path() / "refused";
  const std::string reason = refusal_of([&] { write_session_report(bag, folder); });
  for (const std::string& words :
       {topic, wanted, std::string(ros::message_traits::datatype<Message>()), std::string("record it again")})
    EXPECT_NE(reason.find(words), std::string::npos) << topic << ": " << reason;
}

TEST_F(Session, RefusesTopicsOfOtherTypes) {
  const std_msgs::String text;
  for (const std::string topic : {"/actuators/command", "/motor/state", "/tracker/markers", "/simulator/markers"})
    expect_refused(write_bag(true), topic, "must hold soft_robot_lab/", text);
  expect_refused(write_bag(true), "/simulator/scene", "must hold std_msgs/String", command(12.0, 1.0));
  expect_refused(write_bag(true), "/tf", "must hold tf2_msgs/TFMessage", text);
  expect_refused(write_bag(true), "/simulator/surface", "must hold visualization_msgs/Marker", text);
  expect_refused(write_bag(true), "/left/color/camera_info", "must hold sensor_msgs/CameraInfo", text);
  const std::string bag = write_bag(true);
  add_images(bag, 11.0);  // none yet for the first rest
  expect_refused(bag, "/camera_left/color/image_raw", "must hold sensor_msgs/Image", text);
}

// Of some type as the recording says, but with these bytes.
template <typename Message>
void add_bytes(const std::string& bag, const std::string& md5, const std::string& bytes) {
  const auto header = boost::make_shared<ros::M_string>();
  (*header)["type"] = ros::message_traits::datatype<Message>();
  (*header)["md5sum"] = md5;
  (*header)["message_definition"] = "string data";
  const auto text = boost::make_shared<std_msgs::String>();
  text->data = bytes;
  rosbag::Bag(bag, rosbag::bagmode::Append).write("/motor/state", ros::Time(12.0), *text, header);
}

TEST_F(Session, RefusesAnOlderVersionOfAMessage) {
  const std::string bag = write_bag(true), md5 = "0123456789abcdef0123456789abcdef";
  add_bytes<MotorState>(bag, md5, "old");
  const std::string reason = refusal_of([&] { read_recorded_session(bag); });
  for (const std::string& words :
       {bag, std::string("/motor/state"), std::string("another version"), md5, std::string("rosbag fix")})
    EXPECT_NE(reason.find(words), std::string::npos) << reason;
}

TEST_F(Session, RefusesADamagedMessage) {
  const std::string bag = write_bag(true);
  add_bytes<MotorState>(bag, ros::message_traits::md5sum<MotorState>(), std::string(40, '\xff'));
  const std::string reason = refusal_of([&] { read_recorded_session(bag); });
  EXPECT_NE(reason.find("/motor/state holds a damaged soft_robot_lab/MotorState"), std::string::npos) << reason;
}

// roscpp takes the memory of a list before it reads it.
TEST_F(Session, RefusesAListThatIsLongerThanItsMessage) {
  const std::string bag = write_bag(true);
  std::string bytes(14, '\0');  // behind the sequence number: stamp, no frame, linked, emergency_stop
  bytes += "\xff\xff\xff\x0f";
  add_bytes<MotorState>(bag, ros::message_traits::md5sum<MotorState>(), bytes);
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  const std::string reason = refusal_of([&] { read_recorded_session(bag); });
  getrusage(RUSAGE_SELF, &after);
  EXPECT_NE(reason.find("holds a damaged soft_robot_lab/MotorState"), std::string::npos) << reason;
  EXPECT_NE(reason.find(" items, more than there are bytes"), std::string::npos) << reason;
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 500000) << "kB";
}

TEST_F(Session, DoesNotPassOnFilesThatItsRecordingNames) {
  const std::string own = folder_ / "own.yaml", text = folder_ / "text", link = folder_ / "link.yaml";
  fs::copy_file(bar(), own);
  fs::create_symlink("/etc/passwd", link);
  std::ofstream(text) << "root: hidden words\n";
  EXPECT_NE(page_about("/etc/passwd").find("shown only where --scene names it: /etc/passwd"), std::string::npos);
  for (const std::string& scene : {std::string("/etc/passwd"), link, folder_.string() + "/../../etc/passwd", text})
    EXPECT_EQ(page_about(scene).find("root:"), std::string::npos) << scene;
  EXPECT_EQ(page_about(bar()).find("youngs_modulus_pa"), std::string::npos);  // a scene, but elsewhere
  EXPECT_NE(page_about(own).find("youngs_modulus_pa"), std::string::npos);
  EXPECT_NE(page_about("/etc/passwd", bar()).find("youngs_modulus_pa"), std::string::npos);
}

TEST_F(Session, DrawsWhatCamerasSawOnceAtEachRest) {
  const std::string bag = write_bag(true);
  add_images(bag);
  const SessionReport report = write_session_report(bag, (folder_ / "report").string());
  int pictures = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "report")) pictures += entry.path().extension() == ".jpg";
  EXPECT_EQ(pictures, report.rest_periods);
  std::ifstream file(report.page);
  std::ostringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find("Configuration 1: camera_left at 1."), std::string::npos);
  EXPECT_NE(page.str().find("Configuration 2: camera_left at 5."), std::string::npos);
}

TEST_F(Session, IsToldOnOnePage) {
  const SessionReport report = write_session_report(write_bag(true), (folder_ / "report").string(), bar());
  EXPECT_EQ(report.rest_periods, 2);
  EXPECT_NEAR(report.rest_rms_m, 0.003, 1e-4);
  std::ifstream file(report.page);
  std::ostringstream page;
  page << file.rdbuf();
  for (const std::string words : {"Gap by configuration", "left 0.9", "data:image/png;base64,", "youngs_modulus_pa",
                                  "soft_robot_lab</td>", "no images with lens"})
    EXPECT_NE(page.str().find(words), std::string::npos) << words;
}

// A skin of one triangle, which moves to the right as time goes on.
void add_skin(const std::string& path) {
  rosbag::Bag bag(path, rosbag::bagmode::Append);
  visualization_msgs::Marker skin;
  skin.type = visualization_msgs::Marker::TRIANGLE_LIST;
  skin.points.resize(3);
  skin.colors.resize(3);
  for (auto& colour : skin.colors) colour.g = colour.a = 1.0f;
  skin.points[1].z = skin.points[2].z = -0.05;
  for (double time_s = 10.0; time_s < 19.0; time_s += 0.1) {
    for (std::size_t i = 0; i < 3; ++i) skin.points[i].x = 0.01 * (time_s - 10.0) + (i == 2 ? 0.03 : 0.0);
    skin.header.stamp = ros::Time(time_s);
    bag.write("/simulator/surface", skin.header.stamp, skin);
  }
}

// Where green is, in the middle.
double green_at(const cv::Mat& frame) {
  cv::Mat mask;
  cv::inRange(frame, cv::Scalar(0, 60, 0), cv::Scalar(60, 255, 60), mask);
  const cv::Moments moments = cv::moments(mask, true);
  return moments.m00 > 100.0 ? moments.m10 / moments.m00 : -1.0;
}

TEST_F(Session, IsFilmed) {
  const std::string bag = write_bag(true);
  add_skin(bag);
  const SessionReport report = write_session_report(bag, (folder_ / "report").string());
  cv::VideoCapture film((folder_ / "report" / "session.mp4").string());
  std::vector<double> places_px;
  for (cv::Mat frame; film.read(frame);) places_px.push_back(green_at(frame));
  ASSERT_NEAR(static_cast<double>(places_px.size()), 9.0 * 15.0, 2.0);
  EXPECT_GT(places_px.front(), 0.0);
  EXPECT_GT(places_px.back(), places_px.front() + 100.0);
  std::ifstream file(report.page);
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  EXPECT_NE(page.find("data:video/mp4;base64,"), std::string::npos);
}

TEST_F(Session, BeginsWithWhatHappened) {
  const std::string page = page_about("");
  const std::size_t head = page.find(" a robot was recorded for 8.967 s while its commands changed ");
  ASSERT_NE(head, std::string::npos);
  EXPECT_LT(head, page.find("<table>"));
  for (const std::string words : {" UTC, a robot", "At rest, in 2 configurations, tracked and simulated markers were 3",
                                  "No event of the motors disturbed it."})
    EXPECT_NE(page.find(words), std::string::npos) << words;
}

TEST_F(Session, GivesEachConfigurationAPageWhereAsked) {
  const std::string bag = write_bag(true), folder = folder_ / "report";
  write_session_report(bag, folder);
  EXPECT_FALSE(fs::exists(folder + "/configuration_1.html"));
  write_session_report(bag, folder, "", true);
  EXPECT_TRUE(fs::exists(folder + "/configuration_1.html"));
  EXPECT_FALSE(fs::exists(folder + "/configuration_3.html"));
  std::ifstream file(folder + "/configuration_2.html");
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  for (const std::string words : {"Configuration 2: left 0.9", "tracked x [mm]", "<td>tip</td>", ">23</td>"})
    EXPECT_NE(page.find(words), std::string::npos) << words;
}

TEST_F(Session, ShowsWhatDisturbedIt) {
  const std::string bag = write_bag(true);
  MotorState motors;
  motors.names = {"left"};
  motors.position_steps = motors.target_steps = motors.pull_m = motors.values = {0.0};
  motors.moving = {0};
  motors.fault = {""};
  {
    rosbag::Bag opened(bag, rosbag::bagmode::Append);
    for (const double time_s : {17.5, 18.0}) {  // after commands were given
      motors.header.stamp = ros::Time(time_s);
      motors.known = {static_cast<std::uint8_t>(time_s < 18.0)};
      opened.write("/motor/state", motors.header.stamp, motors);
    }
    TrackerSettings tracker;
    for (const double time_s : {10.0, 12.0, 12.5}) {  // the last says nothing new
      tracker.motion.gate = time_s < 12.0 ? 25.0 : 16.0;
      opened.write(std::string("/") + tracker_updates, ros::Time(time_s), config_message(tracker));
    }
  }
  std::ifstream file(write_session_report(bag, (folder_ / "report").string()).page);
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  EXPECT_NE(page.find("1 event of the motors disturbed it, the first at 8 s: left does not know where it is"),
            std::string::npos);
  EXPECT_NE(page.find("tracker: motion_gate 25 -&gt; 16"), std::string::npos);
  EXPECT_EQ(read_recorded_session(bag).settings.size(), 1u);
}

TEST(MotorReadings, RefuseListsOfOtherLengths) {
  MotorState motors;
  motors.names = {"left"};
  motors.values = {1.0};
  motors.moving = {0};
  EXPECT_THROW(motor_readings(motors), std::runtime_error);
  motors.known = {1};
  EXPECT_EQ(motor_readings(motors).at(0).name, "left");
}

TEST(ObservedMarkers, RefuseWhatIsNotWholeOrNotFinite) {
  MarkerObservations markers = observation(10.0, 0.001, 5.0, MarkerObservations::SEEN);
  EXPECT_TRUE(observed_markers(markers).markers.at(0).seen);
  EXPECT_FALSE(observed_markers(markers).markers.at(1).seen);
  markers.covariances.pop_back();
  EXPECT_THROW(observed_markers(markers), std::invalid_argument);
  markers = observation(10.0, std::nan(""), 5.0, MarkerObservations::SEEN);
  EXPECT_THROW(observed_markers(markers), std::invalid_argument);
}

TEST(FitRequest, RefusesListsOfOtherLengths) {
  FitModel::Request request;
  request.parameters = {"youngs_modulus_pa", "compliance_m_n"};
  request.starts = {2e5};
  EXPECT_THROW(fit_request(request), std::invalid_argument);
  request.starts = {2e5, 1e-5};
  EXPECT_EQ(fit_request(request).parameters[1].start, 1e-5);
  EXPECT_FALSE(fit_request(request).mass_kg);
  request.mass_kg = 0.036;
  EXPECT_EQ(fit_request(request).mass_kg, 0.036);
  request.model_error_m = -1.0;
  EXPECT_THROW(fit_request(request), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
