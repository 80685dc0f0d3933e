// SPDX-License-Identifier: BSD-3-Clause
#include "least_determinant.h"

#include <algorithm>
#include <vector>

#include <Eigen/LU>

#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {

double least_determinant(const TetMesh& mesh, const Eigen::Matrix3Xd& positions_m) {
  const auto per_element = static_cast<int>(mesh.tets.rows());
  std::vector<Eigen::Matrix<double, Eigen::Dynamic, 3>> slopes;
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0),
                                       Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.25, 0.25, 0.25)})
    slopes.emplace_back(shape_functions(per_element, place).gradients.transpose());
  double least = 1.0;
  Eigen::Matrix3Xd rest_m(3, per_element), now_m(3, per_element);
  for (Eigen::Index element = 0; element < mesh.tets.cols(); ++element) {
    for (int node = 0; node < per_element; ++node) {
      rest_m.col(node) = mesh.nodes_m.col(mesh.tets(node, element));
      now_m.col(node) = positions_m.col(mesh.tets(node, element));
    }
    for (const auto& slope : slopes) {
      const Eigen::Matrix3d rest = rest_m * slope, now = now_m * slope;
      least = std::min(least, now.determinant() / rest.determinant());
    }
  }
  return least;
}

}  // namespace soft_robot_lab
