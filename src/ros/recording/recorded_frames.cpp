// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_frames.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include "ros/messages/image_messages.h"
#include "ros/messages/image_stamp.h"
#include "recorded_topics.h"
#include "settings/quantile.h"
#include "ros/tracking/tracking_input.h"

namespace soft_robot_lab {
namespace {

using sensor_msgs::Image;

std::vector<double> stamps_of(const rosbag::Bag& bag, const std::string& topic) {
  std::vector<double> stamps_s;
  for (const rosbag::MessageInstance& message : only(bag, {topic}))
    stamps_s.push_back(read_message<ImageStamp>(message)->header.stamp.toSec());
  return stamps_s;
}

std::optional<double> nearest(const std::set<double>& all, double to) {
  const auto after = all.lower_bound(to);
  if (after == all.end()) return all.empty() ? std::nullopt : std::optional(*all.rbegin());
  if (after == all.begin()) return *after;
  const auto before = std::prev(after);
  return to - *before < *after - to ? *before : *after;
}

// By how much depth is from colour, mostly.
double usual_distance_s(const std::vector<double>& colour_s, const std::vector<double>& depth_s) {
  const std::set<double> all(depth_s.begin(), depth_s.end());
  std::vector<double> distances_s;
  for (const double stamp_s : colour_s)
    if (const auto depth = nearest(all, stamp_s)) distances_s.push_back(std::abs(*depth - stamp_s));
  return distances_s.empty() ? 0.0 : median(std::move(distances_s));
}

std::string milliseconds(double time_s) {
  std::ostringstream text;
  text.precision(3);
  text << 1e3 * time_s << " ms";
  return text.str();
}

std::string image_topics(const rosbag::Bag& bag) {
  std::string topics;
  for (const rosbag::ConnectionInfo* connection : rosbag::View(bag).getConnections())
    if (connection->datatype == "sensor_msgs/Image" || connection->datatype == "sensor_msgs/CompressedImage")
      topics += (topics.empty() ? "" : ", ") + connection->topic + " (" + connection->datatype + ")";
  return topics.empty() ? "none" : topics;
}

}  // namespace

std::map<double, double> pair_stamps(std::vector<double> colour_s, std::vector<double> depth_s, double tolerance_s) {
  std::set<double> free(depth_s.begin(), depth_s.end());
  std::map<double, double> pairs;
  std::sort(colour_s.begin(), colour_s.end());
  for (const double stamp_s : colour_s)
    if (free.erase(stamp_s) > 0) pairs[stamp_s] = stamp_s;
  for (const double stamp_s : colour_s) {
    if (pairs.count(stamp_s) > 0) continue;
    const auto depth = nearest(free, stamp_s);
    if (!depth || std::abs(*depth - stamp_s) > tolerance_s) continue;
    pairs[stamp_s] = *depth;
    free.erase(*depth);
  }
  return pairs;
}

RecordedFrames::RecordedFrames(const rosbag::Bag& bag, std::string camera, double tolerance_s)
    : camera_(std::move(camera)), others_(image_topics(bag)), tolerance_s_(tolerance_s) {
  const std::vector<double> colour_s = stamps_of(bag, colour_topic(camera_)),
                            depth_s = stamps_of(bag, depth_topic(camera_));
  colour_ = colour_s.size();
  depth_ = depth_s.size();
  depth_of_ = pair_stamps(colour_s, depth_s, tolerance_s);
  if (depth_of_.empty()) apart_s_ = usual_distance_s(colour_s, depth_s);
  for (const auto& [colour, depth] : depth_of_) {
    colour_of_[depth] = colour;
    apart_s_ = std::max(apart_s_, std::abs(depth - colour));
  }
}

void RecordedFrames::add(const rosbag::MessageInstance& message, const std::function<void(const RgbdFrame&)>& take) {
  const std::string topic = relative(message.getTopic());
  const bool is_colour = topic == colour_topic(camera_);
  if (!is_colour && topic != depth_topic(camera_)) return;
  const Image::ConstPtr image = read_message<Image>(message);
  const double stamp_s = image->header.stamp.toSec();
  const auto& partner_of = is_colour ? depth_of_ : colour_of_;
  const auto partner = partner_of.find(stamp_s);
  if (partner == partner_of.end()) return;
  Waiting& others = is_colour ? waiting_depth_ : waiting_colour_;
  const auto other = others.find(partner->second);
  if (other == others.end()) {
    (is_colour ? waiting_colour_ : waiting_depth_)[stamp_s] = image;
    return;
  }
  try {
    take(is_colour ? rgbd_frame(camera_, *image, *other->second) : rgbd_frame(camera_, *other->second, *image));
  } catch (const std::invalid_argument& error) {
    refuse(error.what());
  }
  others.erase(other);
}

std::string RecordedFrames::why_nothing() const {
  std::string text;
  for (const std::string& topic : {colour_topic(camera_), depth_topic(camera_)})
    if ((topic == colour_topic(camera_) ? colour_ : depth_) == 0)
      text += (text.empty() ? "" : " and ") + ("no images on " + topic);
  if (!text.empty()) return text + "; images of the recording: " + others_;
  if (depth_of_.empty())
    return std::to_string(colour_) + " colour and " + std::to_string(depth_) +
           " depth images, none at the same time: they are " + milliseconds(apart_s_) + " apart, and at most " +
           milliseconds(tolerance_s_) + " are paired";
  for (const auto& [why, count] : refusals_)
    text += (text.empty() ? "" : "; ") + std::to_string(count) + " times: " + why;
  return text;
}

std::string RecordedFrames::note() const {
  if (const std::string why = why_nothing(); !why.empty()) return why;
  std::string text;
  if (apart_s_ > 0.0) text = "colour and depth that are up to " + milliseconds(apart_s_) + " apart were paired";
  const std::size_t alone = colour_ + depth_ - 2 * depth_of_.size();
  if (alone > 0) text += (text.empty() ? "" : "; ") + std::to_string(alone) + " images have no partner";
  return text;
}

}  // namespace soft_robot_lab
