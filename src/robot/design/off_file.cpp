// SPDX-License-Identifier: BSD-3-Clause
#include "off_file.h"

#include <fstream>
#include <stdexcept>

namespace soft_robot_lab {

OffFile read_off_file(const std::string& path) {
  std::ifstream file(path);
  std::string word;
  long vertices = 0, triangles = 0, unused = 0;
  if (!(file >> word >> vertices >> triangles >> unused) || word != "OFF" || vertices < 0 || triangles < 0)
    throw std::invalid_argument(path + ": is no OFF file");
  OffFile off{Eigen::Matrix3Xd(3, vertices), Eigen::Matrix3Xd(3, triangles), Eigen::Matrix3Xi(3, triangles)};
  for (Eigen::Index i = 0; i < off.vertices_m.size(); ++i) file >> off.vertices_m(i);
  for (long t = 0; t < triangles; ++t) {
    file >> unused >> off.triangles(0, t) >> off.triangles(1, t) >> off.triangles(2, t) >> unused;
    file >> off.normals(0, t) >> off.normals(1, t) >> off.normals(2, t);
  }
  if (!file) throw std::invalid_argument(path + ": ends too early");
  if (triangles > 0 && (off.triangles.minCoeff() < 0 || off.triangles.maxCoeff() >= vertices))
    throw std::invalid_argument(path + ": a triangle names a vertex beyond the last");
  return off;
}

}  // namespace soft_robot_lab
