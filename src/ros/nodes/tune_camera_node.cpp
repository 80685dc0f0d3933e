// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <csignal>
#include <functional>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <message_filters/subscriber.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include "read_parameter.h"
#include "run_node.h"
#include "ros/cameras/camera_driver.h"
#include "ros/messages/image_messages.h"
#include "ros/tracking/tracking_input.h"
#include "perception/calibration/ball_finder.h"
#include "perception/calibration/camera_tuning.h"
#include "settings/require_in_range.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kTuneCameraAbout =
    R"(Sets a camera's exposure and gain by white balls in its dark box: films the empty
box, waits until balls hang in it, and then tries settings until the balls are crisp and the box is dark. What was set
before is set again where it fails. The answer stands in the log and, for realsense2_camera's launch file, in a file.

Parameters: ~camera (first part of its topics), ~radius_m (of the balls), ~output (path of the file; default: none),
~timeout_s (for the driver, for pictures, and for somebody to hang up the balls), ~settle_frames (after a change,
that may still be of the setting before), ~max_exposure [0.1 ms].)";

std::atomic<bool> interrupted{false};

struct Options {
  std::string camera, output;
  double timeout_s = 60;
  int settle_frames = 10;  // a D415's driver was seen to take 6
  BallFinderSettings finder;
  TuningOptions tuning;

  void validate() const {
    require_in_range("timeout_s", timeout_s, {0.0, 3600.0, true});
    require_in_range("settle_frames", settle_frames, {0.0, 1000.0});
    finder.validate();
    tuning.validate();
  }
};

Options read_tune_camera_options(const ros::NodeHandle& node) {
  Options options;
  options.camera = required_text(node, "camera", "its name");
  read_parameter(node, "output", options.output);
  read_parameter(node, "timeout_s", options.timeout_s);
  read_parameter(node, "settle_frames", options.settle_frames);
  read_parameter(node, "radius_m", options.finder.radius_m);
  read_parameter(node, "max_exposure", options.tuning.limits.max_exposure);
  options.validate();
  return options;
}

class CameraTuner {
 public:
  explicit CameraTuner(const Options& options);
  CameraTuning run();

 private:
  static constexpr int pictures_a_search = 5;

  RgbdFrame next_frame();
  std::vector<RgbdFrame> next_frames();
  void set(const CameraSetting& setting);
  std::vector<BallPlace> wait_for_balls();
  CameraTuning tune();

  Options options_;
  ros::NodeHandle node_;
  CameraDriver driver_;
  message_filters::Subscriber<sensor_msgs::Image> colour_, depth_;
  ImagePair pairs_{waiting_images};
  ros::Subscriber info_;
  std::optional<CameraModel> model_;
  std::optional<RgbdFrame> frame_;
  std::string problem_;  // with the last picture
};

CameraTuner::CameraTuner(const Options& options)
    : options_(options), driver_(node_, options.camera, options.timeout_s) {
  CameraSettingLimits& limits = options_.tuning.limits;
  limits.min_exposure = driver_.limits().min_exposure;
  limits.max_exposure = std::min(limits.max_exposure, driver_.limits().max_exposure);
  limits.min_gain = driver_.limits().min_gain;
  limits.max_gain = driver_.limits().max_gain;
  const auto attempt = [this](const auto& action) {
    try {
      action();
    } catch (const std::invalid_argument& error) {
      problem_ = std::string("; the last: ") + error.what();
    }
  };
  info_ = node_.subscribe<sensor_msgs::CameraInfo>(
      info_topic(options_.camera), 5,
      boost::function<void(const sensor_msgs::CameraInfo::ConstPtr&)>(
          [this, attempt](const auto& info) { attempt([&] { model_ = camera_model(*info); }); }));
  colour_.subscribe(node_, colour_topic(options_.camera), waiting_images);
  depth_.subscribe(node_, depth_topic(options_.camera), waiting_images);
  pairs_.connectInput(colour_, depth_);
  pairs_.registerCallback(boost::bind<void>(
      [this, attempt](const sensor_msgs::Image::ConstPtr& colour, const sensor_msgs::Image::ConstPtr& depth) {
        attempt([&] { frame_ = rgbd_frame(options_.camera, *colour, *depth); });
      },
      boost::placeholders::_1, boost::placeholders::_2));
}

RgbdFrame CameraTuner::next_frame() {
  frame_.reset();
  const ros::SteadyTime limit = ros::SteadyTime::now() + ros::WallDuration(options_.timeout_s);
  while (!frame_ || !model_) {
    if (interrupted) throw std::runtime_error("interrupted");
    if (!ros::ok() || ros::SteadyTime::now() > limit)
      throw std::runtime_error(options_.camera + ": no pictures of colour, aligned depth and lens came within " +
                               std::to_string(std::lround(options_.timeout_s)) + " s" + problem_);
    ros::spinOnce();
    ros::WallDuration(0.002).sleep();
  }
  return *frame_;
}

std::vector<RgbdFrame> CameraTuner::next_frames() {
  std::vector<RgbdFrame> frames;
  while (frames.size() < pictures_a_search) frames.push_back(next_frame());
  return frames;
}

void CameraTuner::set(const CameraSetting& setting) {
  driver_.set(setting);
  for (int i = 0; i < options_.settle_frames; ++i) next_frame();
}

// Still ones: found twice in the same places.
std::vector<BallPlace> CameraTuner::wait_for_balls() {
  const std::vector<RgbdFrame> empty_box = next_frames();
  ROS_INFO("the empty box is filmed; now hang up white balls, and leave");
  const ros::SteadyTime limit = ros::SteadyTime::now() + ros::WallDuration(options_.timeout_s);
  std::vector<BallPlace> before;
  while (true) {
    const BallSearch search = find_balls(empty_box, next_frames(), *model_, options_.finder);
    std::vector<BallPlace> places;
    for (const FoundBall& ball : search.balls) places.push_back(place_of(ball, *model_));
    bool still = !places.empty() && places.size() == before.size() && search.rejected.empty();
    for (std::size_t i = 0; still && i < places.size(); ++i)
      still = (places[i].centre_px - before[i].centre_px).norm() < 1;
    if (still) return places;
    before = places;
    if (ros::SteadyTime::now() < limit) continue;
    std::string why;
    for (const std::string& rejected : search.rejected) why += "; " + rejected;
    throw std::runtime_error(options_.camera + ": no ball found that hangs still within " +
                             std::to_string(std::lround(options_.timeout_s)) + " s" + why);
  }
}

CameraTuning CameraTuner::tune() {
  set({});  // automatic: whatever was set, balls can be seen
  const std::vector<BallPlace> balls = wait_for_balls();
  ROS_INFO("%zu found", balls.size());
  const CameraTuning tuning = tune_camera(options_.tuning, [&](const CameraSetting& setting) {
    set(setting);
    return measure_balls(next_frame().colour, balls);
  });
  if (tuning.end != TuningEnd::crisp) throw std::runtime_error(options_.camera + ": " + tuning.message);
  driver_.set(tuning.setting);
  return tuning;
}

CameraTuning CameraTuner::run() {
  const CameraSetting original = driver_.setting();
  try {
    return tune();
  } catch (const std::exception& error) {
    try {
      driver_.set(original);
    } catch (const std::exception& second) {
      throw std::runtime_error(std::string(error.what()) +
                               "; nor could the old setting be set again: " + second.what());
    }
    throw std::runtime_error(std::string(error.what()) + "; the camera is set as it was");
  }
}

void write(const std::string& path, const CameraSetting& setting) {
  if (path.empty()) return;
  std::ostringstream text;
  text << "enable_auto_exposure: false\nexposure: " << setting.exposure << "\ngain: " << setting.gain << "\n";
  try {
    write_file(path, text.str());
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string(error.what()) + "; the camera is set all the same");
  }
}

}  // namespace

int tune_camera_node(int argc, char** argv) {
  return run_node(argc, argv, "tune_camera", kTuneCameraAbout, [] {
    const Options options = read_tune_camera_options(ros::NodeHandle("~"));
    CameraTuner tuner(options);
    // ROS would close the way to the driver at once, on which the old setting is set again.
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { interrupted = true; });
    const CameraTuning tuning = tuner.run();
    ROS_INFO("%s: exposure %d, gain %d, after %d pictures: %s", options.camera.c_str(), tuning.setting.exposure,
             tuning.setting.gain, tuning.pictures, tuning.message.c_str());
    write(options.output, tuning.setting);
  });
}

}  // namespace soft_robot_lab
