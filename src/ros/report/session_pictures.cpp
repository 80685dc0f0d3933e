// SPDX-License-Identifier: BSD-3-Clause
#include "session_pictures.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <tuple>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>

#include "ros/display/camera_overlay.h"
#include "ros/messages/frames.h"
#include "ros/messages/image_messages.h"
#include "ros/recording/recorded_topics.h"
#include "ros/base/topics.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

struct Camera {
  std::optional<CameraModel> lens;
  size_t next = 0;  // of the times that has no picture yet
  CloseUp close_up;
};

// What stands before `end`, where that is how the text ends.
std::optional<std::string> before(const std::string& text, const std::string& end) {
  if (text.size() <= end.size() || text.compare(text.size() - end.size(), end.size(), end) != 0) return std::nullopt;
  return text.substr(0, text.size() - end.size());
}

std::optional<RealityGap> nearest(const std::vector<RealityGap>& gaps, double time_s) {
  const auto found = std::min_element(gaps.begin(), gaps.end(), [&](const RealityGap& a, const RealityGap& b) {
    return std::abs(a.header.stamp.toSec() - time_s) < std::abs(b.header.stamp.toSec() - time_s);
  });
  if (found == gaps.end() || std::abs(found->header.stamp.toSec() - time_s) > 0.5) return std::nullopt;
  return *found;
}

class Painter {
 public:
  Painter(const std::vector<RealityGap>& gaps, std::vector<double> times_s, std::string folder)
      : gaps_(gaps), times_s_(std::move(times_s)), folder_(std::move(folder)) {}

  void add(const rosbag::MessageInstance& message) {
    const std::string topic = relative(message.getTopic());
    if (topic == "tf" || topic == "tf_static") {
      const auto tree = read_message<tf2_msgs::TFMessage>(message);
      for (const auto& transform : tree->transforms) place(transform);
    } else if (topic == topics::simulator_surface) {
      surface_ = *read_message<visualization_msgs::Marker>(message);
      if (!surface_.header.frame_id.empty()) session_ = prefix_of_robot(surface_.header.frame_id);
    } else if (const auto of_lens = before(topic, "/color/camera_info")) {
      cameras_[*of_lens].lens = camera_model(*read_message<sensor_msgs::CameraInfo>(message));
    } else if (const auto camera = before(topic, "/color/image_raw")) {
      if (wanted(*camera, message.getTime().toSec())) draw(*camera, *read_message<sensor_msgs::Image>(message));
    }
  }

  std::vector<SessionPicture> pictures() {
    std::stable_sort(pictures_.begin(), pictures_.end(), [](const SessionPicture& a, const SessionPicture& b) {
      return std::tie(a.asked, a.camera) < std::tie(b.asked, b.camera);
    });
    return std::move(pictures_);
  }

 private:
  void place(const geometry_msgs::TransformStamped& transform) {
    const std::string parent = relative(transform.header.frame_id), child = relative(transform.child_frame_id);
    poses_[child] = {parent, isometry(transform.transform)};
  }

  // By when it was recorded, which is after it was taken.
  bool wanted(const std::string& camera, double time_s) const {
    const auto found = cameras_.find(camera);
    return found != cameras_.end() && found->second.lens && world_from(optical_frame(camera, session_)) &&
           found->second.next < times_s_.size() && time_s >= times_s_[found->second.next];
  }

  std::optional<Eigen::Isometry3d> world_from(const std::string& frame) const {
    const auto found = poses_.find(frame);
    if (found == poses_.end() || found->second.first != world_frame(session_)) return std::nullopt;
    return found->second.second;
  }

  void draw(const std::string& name, const sensor_msgs::Image& image) {
    Camera& camera = cameras_[name];
    const double time_s = image.header.stamp.toSec();
    if (time_s < times_s_[camera.next]) return;
    while (camera.next < times_s_.size() && times_s_[camera.next] <= time_s) ++camera.next;
    const size_t asked = camera.next - 1;
    const Eigen::Isometry3d world_from_robot =
        world_from(robot_frame(session_)).value_or(Eigen::Isometry3d::Identity());
    const Eigen::Isometry3d camera_from_robot =
        world_from(optical_frame(name, session_)).value().inverse() * world_from_robot;
    const CloseUp::View view = camera.close_up.of(colour_image(image), *camera.lens, camera_from_robot, surface_);
    const cv::Mat drawn = draw_robot(view.image, view.model, camera_from_robot, surface_, nearest(gaps_, time_s));
    cv::Mat bgr;
    cv::cvtColor(drawn, bgr, cv::COLOR_RGB2BGR);
    const std::string file = folder_ + "/" + name + "_" + std::to_string(asked) + ".jpg";
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", bgr, bytes);
    write_file(file, {bytes.begin(), bytes.end()});
    pictures_.push_back({file, name, asked, time_s});
  }

  const std::vector<RealityGap>& gaps_;
  std::vector<double> times_s_;
  std::string folder_;
  std::map<std::string, Camera> cameras_;
  std::map<std::string, std::pair<std::string, Eigen::Isometry3d>> poses_;  // and in which frame, by frame
  std::string session_;                                                     // with what its frames begin
  visualization_msgs::Marker surface_;
  std::vector<SessionPicture> pictures_;
};

}  // namespace

std::vector<SessionPicture> draw_session(const std::string& bag, const std::vector<RealityGap>& gaps,
                                         const std::vector<double>& times_s, const std::string& folder) {
  Painter painter(gaps, times_s, folder);
  const rosbag::Bag opened = open_bag(bag);
  for (const rosbag::MessageInstance& message : rosbag::View(opened)) painter.add(message);
  return painter.pictures();
}

}  // namespace soft_robot_lab
