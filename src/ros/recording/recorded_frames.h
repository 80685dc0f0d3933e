// SPDX-License-Identifier: BSD-3-Clause
// Colour and depth images of a recording of bare cameras, paired by their stamps, and what became of them.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Image.h>

#include "soft_robot_lab/perception/tracking/rgbd_frame.h"

namespace soft_robot_lab {

// Which depth goes with which colour: that of the same stamp, else the nearest within a tolerance that no other has.
std::map<double, double> pair_stamps(std::vector<double> colour_s, std::vector<double> depth_s, double tolerance_s);

// Of one camera.
class RecordedFrames {
 public:
  RecordedFrames(const rosbag::Bag& bag, std::string camera, double tolerance_s);

  // The frame that this message completes goes to `take`; a bad one is left out, and counted.
  void add(const rosbag::MessageInstance& message, const std::function<void(const RgbdFrame&)>& take);
  void refuse(const std::string& why) { ++refusals_[why]; }

  // What a reader should know: empty where all is well, or nothing could have come of it for this reason.
  std::string note() const;
  std::string why_nothing() const;  // empty where frames were made and none refused

 private:
  using Waiting = std::map<double, sensor_msgs::Image::ConstPtr>;

  std::string camera_, others_;  // topics of images that it has
  double tolerance_s_;
  std::size_t colour_ = 0, depth_ = 0;
  double apart_s_ = 0.0;                           // of what was paired, at most; of what was not, mostly
  std::map<double, double> depth_of_, colour_of_;  // by stamp
  Waiting waiting_colour_, waiting_depth_;
  std::map<std::string, long> refusals_;
};

}  // namespace soft_robot_lab
