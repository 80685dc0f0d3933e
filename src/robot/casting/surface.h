// SPDX-License-Identifier: BSD-3-Clause
// A closed surface of triangles, outward, with what the casting rules ask of it. Metres, frame: robot_base.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

struct Surface {
  Eigen::Matrix3Xd vertices_m;
  Eigen::Matrix3Xi triangles;     // outward
  Eigen::Matrix3Xd normals;       // unit; zero where a triangle has no area
  Eigen::Matrix3Xd true_normals;  // at the triangles' centres, of the geometry that they follow, where that is known
  Eigen::VectorXd areas_m2;
  // How far a triangle may stand off the round face that it follows; empty: true normals say it.
  Eigen::VectorXd sags_m;
  Eigen::Matrix3Xi neighbours;           // across the edges 01, 12, 20
  std::vector<int> shell;                // of each triangle: which connected part of the surface it belongs to
  std::vector<double> shell_volumes_m3;  // signed: negative for a cavity that is closed all round

  int triangle_count() const { return static_cast<int>(triangles.cols()); }
  Eigen::Vector3d corner(int triangle, int i) const { return vertices_m.col(triangles(i, triangle)); }
  Eigen::Vector3d centre(int triangle) const {
    return (corner(triangle, 0) + corner(triangle, 1) + corner(triangle, 2)) / 3;
  }
  bool is_curved(int triangle) const;  // it follows a round face with some neighbour
  // For triangles without true normals, as those of an STL file: `sags_m`, from the angles between neighbours.
  void estimate_sags();
  double volume_m3() const;
  double size_m() const;  // diagonal of its box
};

// Vertices at the same place become one. Throws std::invalid_argument, with a place, where the triangles are not
// closed, are not oriented alike or enclose no volume.
Surface make_surface(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles);

// Of an OFF file as robot/design/surface_file.h makes it. Throws std::invalid_argument.
Surface read_off(const std::string& path);

// A right-handed frame whose third axis is the unit vector `axis`.
Eigen::Matrix3d frame_along(const Eigen::Vector3d& axis);

std::string place_text(const Eigen::Vector3d& at_m);  // "(12.5, 0, -3) mm"

}  // namespace soft_robot_lab
