// The body's skin as triangles for rviz.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <ros/time.h>
#include <visualization_msgs/Marker.h>

#include "soft_robot_lab/sim/tet_mesh.h"

namespace soft_robot_lab {

class SurfaceMarker {
 public:
  explicit SurfaceMarker(const TetMesh& mesh);

  // Whether a node of the skin moved visibly since the last `message`; true at first.
  bool moved(const Eigen::Matrix3Xd& positions_m) const;

  visualization_msgs::Marker message(const Eigen::Matrix3Xd& positions_m, const ros::Time& stamp);

 private:
  std::vector<std::array<int, 3>> triangles_;  // node indices; four for a face with mid-edge nodes
  Eigen::Matrix3Xd drawn_positions_m_;         // as in the last message; empty at first
};

}  // namespace soft_robot_lab
