// SPDX-License-Identifier: BSD-3-Clause
// What a simulator would say of two triangles with a side in common and of a marker.
#pragma once

#include <string>

#include <visualization_msgs/Marker.h>

#include "ros/messages/messages.h"

namespace soft_robot_lab {

inline geometry_msgs::Point point(double x, double y, double z) {
  geometry_msgs::Point p;
  p.x = x, p.y = y, p.z = z;
  return p;
}

// `x` off its place.
inline visualization_msgs::Marker surface(double stamp_s, double x = 0) {
  visualization_msgs::Marker marker;
  marker.header.stamp = ros::Time(stamp_s);
  marker.header.frame_id = "robot_base";
  marker.type = visualization_msgs::Marker::TRIANGLE_LIST;
  marker.points = {point(x, 0, 0),         point(x + 0.1, 0, 0), point(x + 0.1, 0, 0.1),
                   point(x + 0.1, 0, 0.1), point(x, 0, 0.1),     point(x, 0, 0)};
  return marker;
}

inline MarkerObservations markers(double stamp_s, double x = 0) {
  MarkerObservations message;
  message.header.stamp = ros::Time(stamp_s);
  message.header.frame_id = "robot_base";
  message.names = {"tip"};
  message.positions = {point(x, 0, 0)};
  return message;
}

}  // namespace soft_robot_lab
