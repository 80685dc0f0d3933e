// SPDX-License-Identifier: BSD-3-Clause
// The body's skin as triangles for rviz, smoothly shaded, chambers coloured by their pressure.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <ros/time.h>
#include <std_msgs/ColorRGBA.h>
#include <visualization_msgs/Marker.h>

#include "session/report/smooth_skin.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// Shaded here and not by rviz, which gives each triangle one normal and leaves the far side of a translucent skin
// black: light from above and all round, as far as the body leaves it open, a lamp, and its gloss towards who stands in
// front of the robot.
// `openness` in [0, 1]: the share of the sky that is seen.
std_msgs::ColorRGBA shaded(const Eigen::Vector3d& normal, double openness, const Eigen::Vector3d& colour,
                           double opacity);

class SurfaceMarker {
 public:
  explicit SurfaceMarker(const TetMesh& mesh, double opacity = 1.0);  // (0, 1]

  // Whether a node of the skin moved visibly since the last `message`; true at first, and once after `forget`.
  bool moved(const Eigen::Matrix3Xd& positions_m) const;
  void forget() { drawn_positions_m_.resize(3, 0); }
  // Forgets where the clock was set back: who sees the skin waits for a new one then.
  void follow_clock(const ros::Time& stamp);

  // Gauge pressures by the name of the surface they act on; the largest so far sets the scale of their colours.
  visualization_msgs::Marker message(const Eigen::Matrix3Xd& positions_m, const ros::Time& stamp,
                                     const std::map<std::string, double>& gauge_pressures_pa = {});

 private:
  SmoothSkin skin_;
  double opacity_;
  double full_gauge_pressure_pa_ = 1000.0;
  std::vector<int> face_surface_;  // as in TetMesh
  std::vector<std::string> surface_names_;
  Eigen::Matrix3Xd drawn_positions_m_;  // as in the last message; empty at first
  ros::Time followed_;                  // the last stamp
};

// 1, or less where an opaque skin would hide a chamber, or a cable for most of its length. Of a robot in its rest
// shape.
double fitting_opacity(const Simulation& robot);

// The skin of a robot that is not there yet: one colour, translucent.
visualization_msgs::Marker ghost_of(visualization_msgs::Marker surface);      // where a policy leads
visualization_msgs::Marker preview_of(visualization_msgs::Marker surface);    // where the present commands lead
visualization_msgs::Marker twin_skin_of(visualization_msgs::Marker surface);  // under the loads that the twin has found
// Takes away what a marker of this name shows.
visualization_msgs::Marker no_skin(const std::string& ns);
visualization_msgs::Marker no_ghost();
visualization_msgs::Marker no_preview();
visualization_msgs::Marker no_twin_skin();

}  // namespace soft_robot_lab
