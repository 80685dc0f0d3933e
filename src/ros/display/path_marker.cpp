// SPDX-License-Identifier: BSD-3-Clause
#include "path_marker.h"

#include <ros/time.h>

#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "surface_marker.h"

namespace soft_robot_lab {
namespace {

constexpr double kWidth_m = 4.0e-4;

std_msgs::ColorRGBA colour(float red, float green, float blue) {
  std_msgs::ColorRGBA rgba;
  rgba.r = red;
  rgba.g = green;
  rgba.b = blue;
  rgba.a = 1.0f;
  return rgba;
}

const std_msgs::ColorRGBA in_reach = colour(0.10f, 0.60f, 0.20f);
const std_msgs::ColorRGBA out_of_reach = colour(0.85f, 0.10f, 0.10f);
const std_msgs::ColorRGBA predicted = colour(0.35f, 0.35f, 0.35f);

void add_piece(visualization_msgs::Marker& lines, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
               const std_msgs::ColorRGBA& rgba) {
  lines.points.push_back(to_message(from_m));
  lines.points.push_back(to_message(to_m));
  lines.colors.insert(lines.colors.end(), 2, rgba);
}

}  // namespace

visualization_msgs::Marker path_marker(const PathPlan& plan, double tolerance_m) {
  visualization_msgs::Marker lines;
  lines.header.frame_id = robot_frame();
  lines.header.stamp = ros::Time::now();
  lines.ns = no_path().ns;
  lines.type = visualization_msgs::Marker::LINE_LIST;
  lines.pose.orientation.w = 1.0;
  lines.scale.x = kWidth_m;
  for (std::size_t k = 1; k < plan.samples.size(); ++k) {
    const PathSample &before = plan.samples[k - 1], &now = plan.samples[k];
    add_piece(lines, before.predicted_m, now.predicted_m, predicted);
    const bool reached = std::max(before.unreachable_m, now.unreachable_m) <= tolerance_m;
    add_piece(lines, before.target_m, now.target_m, reached ? in_reach : out_of_reach);
  }
  return lines;
}

visualization_msgs::Marker no_path() { return no_skin("path"); }

}  // namespace soft_robot_lab
