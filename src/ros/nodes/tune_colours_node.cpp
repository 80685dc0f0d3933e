// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/highgui.hpp>
#include <opencv2/imgproc.hpp>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include "read_parameter.h"
#include "run_node.h"
#include "ros/messages/image_messages.h"
#include "ros/tracking/tracking_input.h"
#include "settings/write_file.h"
#include "perception/tracking/colour_tuning.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kTuneColoursAbout =
    R"(A window to tune the ranges of a marker's colour by: the image of a running camera
(or of a bag that is played) beside the mask. Sliders set the range; a click on a marker takes its colour, more clicks
widen it. Keys: s saves, c forgets the clicks, q ends.

Parameters: ~camera (first part of its topics), ~tracker (path of the settings to start from), ~output (path to save
to; default: ~tracker itself), ~colour (name; a new one is added; default: the first), ~range (its place in the
colour's list, default 0).)";

constexpr char window[] = "tune_colours";
constexpr int window_width_px = 1200, window_height_px = 560;  // at first: two pictures and six sliders
constexpr char help[] = "click: take the colour   c: forget the clicks   s: save   q: end";
constexpr int sample_radius_px = 2;

struct Slider {
  const char* name;
  double HsvRange::*value;
  int steps;  // of the slider
  double full_scale;
};
const std::array<Slider, 6> sliders{{{"hue min [deg]", &HsvRange::hue_min_deg, 360, 360},
                                     {"hue max [deg]", &HsvRange::hue_max_deg, 360, 360},
                                     {"saturation min [%]", &HsvRange::saturation_min, 100, 1},
                                     {"saturation max [%]", &HsvRange::saturation_max, 100, 1},
                                     {"value min [%]", &HsvRange::value_min, 100, 1},
                                     {"value max [%]", &HsvRange::value_max, 100, 1}}};

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw std::runtime_error(path + ": cannot be read");
  return text.str();
}

void write(const std::string& text, const cv::Point& place, cv::Mat& view) {
  cv::putText(view, text, place, cv::FONT_HERSHEY_SIMPLEX, 0.6, {255, 255, 255}, 1, cv::LINE_AA);
}

class ColourTuner {
 public:
  explicit ColourTuner(const ros::NodeHandle& options);
  void run();

 private:
  HsvRange& range() { return settings_.detector.colours[colour_].ranges[range_]; }
  void show_range();
  void read_sliders();
  void click(const cv::Point& place);
  void save();
  static void on_mouse(int event, int x, int y, int, void* tuner);

  std::string tracker_, output_;
  TrackerSettings settings_;
  std::size_t colour_ = 0, range_ = 0;
  std::string message_ = help;  // below the picture
  cv::Mat rgb_;
  std::vector<cv::Vec3b> samples_;
  ros::NodeHandle node_;
  ros::Subscriber images_;
};

ColourTuner::ColourTuner(const ros::NodeHandle& options) {
  int place = 0;
  const std::string camera = required_text(options, "camera", "its name");
  tracker_ = required_text(options, "tracker", "the path of the tracker's settings");
  output_ = text_parameter(options, "output", tracker_);
  settings_ = load_tracker(tracker_);
  std::vector<MarkerColour>& colours = settings_.detector.colours;
  const std::string colour = text_parameter(options, "colour", colours.empty() ? "marker" : colours.front().name);
  read_parameter(options, "range", place);
  colour_ = static_cast<std::size_t>(
      std::find_if(colours.begin(), colours.end(), [&](const MarkerColour& one) { return one.name == colour; }) -
      colours.begin());
  if (colour_ == colours.size()) colours.push_back({colour, {}});
  const int ranges = static_cast<int>(colours[colour_].ranges.size());
  if (place < 0 || place > ranges)
    throw std::invalid_argument("range: " + std::to_string(place) + " of " + colour + "; allowed: [0, " +
                                std::to_string(ranges) + "]");
  range_ = static_cast<std::size_t>(place);
  if (place == ranges) colours[colour_].ranges.emplace_back();
  images_ = node_.subscribe<sensor_msgs::Image>(
      colour_topic(camera), 1, boost::function<void(const sensor_msgs::Image::ConstPtr&)>([this](const auto& message) {
        try {
          rgb_ = colour_image(*message);
        } catch (const std::invalid_argument& error) {
          ROS_WARN_THROTTLE(1.0, "%s", error.what());
        }
      }));
}

void ColourTuner::run() {
  cv::namedWindow(window, cv::WINDOW_NORMAL | cv::WINDOW_KEEPRATIO);
  cv::resizeWindow(window, window_width_px, window_height_px);
  for (const Slider& slider : sliders) cv::createTrackbar(slider.name, window, nullptr, slider.steps);
  cv::setMouseCallback(window, &ColourTuner::on_mouse, this);
  show_range();
  cv::Mat view(120, 640, CV_8UC3, cv::Scalar::all(0));
  write("waits for " + images_.getTopic(), {16, 64}, view);
  while (ros::ok()) {
    ros::spinOnce();
    read_sliders();
    if (!rgb_.empty()) {
      cv::cvtColor(tuning_view(rgb_, settings_.detector, colour_), view, cv::COLOR_RGB2BGR);
      write(message_, {16, view.rows - 16}, view);
    }
    cv::imshow(window, view);
    const int key = cv::waitKey(30);
    if (key == 's') save();
    if (key == 'c') samples_.clear();
    if (key == 'q' || key == 27 || cv::getWindowProperty(window, cv::WND_PROP_VISIBLE) < 1) return;
  }
}

void ColourTuner::show_range() {
  for (const Slider& slider : sliders)
    cv::setTrackbarPos(slider.name, window,
                       static_cast<int>(std::lround(range().*slider.value / slider.full_scale * slider.steps)));
}

void ColourTuner::read_sliders() {
  for (const Slider& slider : sliders)
    range().*slider.value = cv::getTrackbarPos(slider.name, window) * slider.full_scale / slider.steps;
}

void ColourTuner::click(const cv::Point& place) {
  message_ = help;
  const std::vector<cv::Vec3b> pixels = sample(rgb_, place, sample_radius_px);
  samples_.insert(samples_.end(), pixels.begin(), pixels.end());
  try {
    range() = range_of(samples_);
    show_range();
  } catch (const std::invalid_argument& error) {
    samples_.resize(samples_.size() - pixels.size());
    message_ = error.what();
    ROS_WARN("%s", error.what());
  }
}

void ColourTuner::on_mouse(int event, int x, int y, int, void* tuner) {
  auto& self = *static_cast<ColourTuner*>(tuner);
  if (event == cv::EVENT_LBUTTONDOWN && !self.rgb_.empty()) self.click({x % self.rgb_.cols, y});
}

void ColourTuner::save() {
  try {
    write_file(output_, with_colours(text_of(tracker_), settings_.detector.colours));
    message_ = "saved to " + output_;
    ROS_INFO("%s", message_.c_str());
  } catch (const std::exception& error) {
    message_ = std::string("not saved: ") + error.what();
    ROS_ERROR("%s", message_.c_str());
  }
}

}  // namespace

int tune_colours_node(int argc, char** argv) {
  return run_node(argc, argv, "tune_colours", kTuneColoursAbout, [] { ColourTuner(ros::NodeHandle("~")).run(); });
}

}  // namespace soft_robot_lab
