// SPDX-License-Identifier: BSD-3-Clause
// The triangles of an OFF file as surface_file.h has them made.
#pragma once

#include <string>

#include <Eigen/Core>

namespace soft_robot_lab {

struct OffFile {
  Eigen::Matrix3Xd vertices_m, normals;  // the latter: of the geometry at the triangles' centres, 0 where it is flat
  Eigen::Matrix3Xi triangles;            // turned as the file has them
};

// Throws std::invalid_argument where it is none.
OffFile read_off_file(const std::string& path);

}  // namespace soft_robot_lab
