#include "soft_robot_lab/ros/surface_marker.h"

#include <Eigen/Geometry>

#include "soft_robot_lab/ros/conversions.h"
#include "soft_robot_lab/ros/topics.h"

namespace soft_robot_lab {
namespace {

constexpr double visible_motion_m = 2.0e-5;

//         2
//        / \          a face with mid-edge nodes 3 (01), 4 (12), 5 (20)
//       5---4         becomes four triangles
//      / \ / \        .
//     0---3---1
constexpr int quarters[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};

// Shaded here and not by rviz, whose light leaves the far side of a translucent skin black and its triangles patchy.
std_msgs::ColorRGBA shaded(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d towards_light = Eigen::Vector3d(-0.4, -0.7, 0.6).normalized();
  const double length = normal.norm();
  const double light = length > 0.0 ? 0.75 + 0.25 * normal.dot(towards_light) / length : 0.75;
  std_msgs::ColorRGBA rgba;
  rgba.r = static_cast<float>(0.62 * light);
  rgba.g = static_cast<float>(0.80 * light);
  rgba.b = static_cast<float>(0.95 * light);
  rgba.a = 0.6f;  // cables inside shall be seen
  return rgba;
}

}  // namespace

SurfaceMarker::SurfaceMarker(const TetMesh& mesh) {
  for (int f = 0; f < mesh.faces.cols(); ++f) {
    const auto face = mesh.faces.col(f);
    if (face.size() == 3) {
      triangles_.push_back({face(0), face(1), face(2)});
    } else {
      for (const auto& q : quarters) triangles_.push_back({face(q[0]), face(q[1]), face(q[2])});
    }
  }
}

bool SurfaceMarker::moved(const Eigen::Matrix3Xd& positions_m) const {
  if (drawn_positions_m_.cols() != positions_m.cols()) return true;
  return (positions_m - drawn_positions_m_).cwiseAbs().maxCoeff() > visible_motion_m;
}

visualization_msgs::Marker SurfaceMarker::message(const Eigen::Matrix3Xd& positions_m, const ros::Time& stamp) {
  drawn_positions_m_ = positions_m;
  visualization_msgs::Marker marker;
  marker.header.stamp = stamp;
  marker.header.frame_id = topics::robot_frame;
  marker.ns = "surface";
  marker.type = visualization_msgs::Marker::TRIANGLE_LIST;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color = shaded(Eigen::Vector3d::UnitZ());  // rviz sees by its alpha that the skin is translucent
  marker.points.reserve(3 * triangles_.size());
  marker.colors.reserve(triangles_.size());
  for (const auto& [a, b, c] : triangles_) {
    for (const int node : {a, b, c}) marker.points.push_back(to_message(positions_m.col(node)));
    const Eigen::Vector3d edge_m = positions_m.col(b) - positions_m.col(a);
    marker.colors.push_back(shaded(edge_m.cross(positions_m.col(c) - positions_m.col(a))));
  }
  return marker;
}

}  // namespace soft_robot_lab
