// SPDX-License-Identifier: BSD-3-Clause
// The robot as cameras see it, put together from what the simulator publishes about skin and markers.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <ros/time.h>
#include <visualization_msgs/Marker.h>

#include "perception/render/rendered_camera.h"
#include "ros/messages/messages.h"

namespace soft_robot_lab {

// Triangles that share their corners, from a list of three points each. A quadratic face comes as four flat ones.
class JoinedSkin {
 public:
  explicit JoinedSkin(const std::vector<geometry_msgs::Point>& points);

  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  // nullopt where the points are not those of this skin, bent: corners that were one are apart.
  std::optional<Eigen::Matrix3Xd> vertices_m(const std::vector<geometry_msgs::Point>& points) const;

 private:
  Eigen::Matrix3Xi triangles_;
  Eigen::Index vertex_count_ = 0;
};

struct SeenMoment {
  ros::Time stamp;
  SeenMotion motion;
};

// Frame of both topics: robot_base, which is the world. The simulator sends a skin only when it moved visibly, and less
// often than markers.
class SeenRobotStates {
 public:
  // Throw std::invalid_argument: another frame, sizes that do not match, numbers that are not finite; nothing changes.
  void add_markers(const MarkerObservations& markers);
  void add_surface(const visualization_msgs::Marker& surface);

  // The newest moment that both topics report: a skin with the markers of its stamp, or, while these stand still, newer
  // markers with the skin that they had. nullopt until there is one.
  std::optional<SeenMoment> newest() const;

  // Of the newest moment. A scene made for another `version` does not fit.
  const Eigen::Matrix3Xi& triangles() const { return skin_->triangles(); }
  const std::vector<std::string>& marker_names() const { return present_->names; }
  int version() const { return version_; }

 private:
  struct Markers {
    ros::Time stamp;
    std::vector<std::string> names;
    Eigen::Matrix3Xd positions_m;
  };
  struct Moment {
    ros::Time stamp;
    std::vector<std::string> names;
    SeenState state;
  };
  void match();
  void forget();

  std::deque<Markers> markers_;  // the latest, by their stamps
  std::optional<JoinedSkin> skin_;
  ros::Time surface_stamp_;
  std::optional<Eigen::Matrix3Xd> surface_m_;  // not matched yet
  std::optional<Moment> before_, present_;     // matched, of the present skin
  int version_ = 0;
};

}  // namespace soft_robot_lab
