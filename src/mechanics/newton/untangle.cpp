// SPDX-License-Identifier: BSD-3-Clause
#include "untangle.h"

#include <algorithm>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>

#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {
namespace {

// Of one quadrature point.
struct RestPoint {
  double weight_m3;
  Eigen::Matrix<double, 3, Eigen::Dynamic> gradients;  // 3 x nodes [1/m]
};

class RestElements {
 public:
  explicit RestElements(const TetMesh& mesh) : mesh_(mesh) {
    if (mesh.quadratic()) {
      for (const auto& point : tet_quadrature_points()) shapes_.push_back(shape_functions(10, point));
    } else {
      shapes_.push_back(shape_functions(4, Eigen::Vector3d::Constant(0.25)));
    }
  }
  std::vector<RestPoint> points(int element) const {
    std::vector<RestPoint> all;
    const Eigen::Matrix3Xd nodes_m = of(element, mesh_.nodes_m);
    for (const ShapeFunctions& shape : shapes_) {
      const Eigen::Matrix3d jacobian = nodes_m * shape.gradients.transpose();
      all.push_back({jacobian.determinant() / (6.0 * static_cast<double>(shapes_.size())),
                     jacobian.inverse().transpose() * shape.gradients});
    }
    return all;
  }
  bool inverted(int element, const Eigen::Matrix3Xd& positions_m) const {
    const Eigen::Matrix3Xd nodes_m = of(element, positions_m);
    const std::vector<RestPoint> all = points(element);
    return std::any_of(all.begin(), all.end(), [&](const RestPoint& point) {
      return !((nodes_m * point.gradients.transpose()).determinant() > 0.0);
    });
  }

 private:
  Eigen::Matrix3Xd of(int element, const Eigen::Matrix3Xd& positions_m) const {
    Eigen::Matrix3Xd nodes_m(3, mesh_.tets.rows());
    for (Eigen::Index a = 0; a < nodes_m.cols(); ++a) nodes_m.col(a) = positions_m.col(mesh_.tets(a, element));
    return nodes_m;
  }

  const TetMesh& mesh_;
  std::vector<ShapeFunctions> shapes_;
};

// Per element, whether it lies within that many elements of an inverted one.
std::vector<bool> near_inverted(const TetMesh& mesh, const RestElements& rest, int rings,
                                const Eigen::Matrix3Xd& positions_m) {
  std::vector<bool> chosen(mesh.tet_count());
  for (int e = 0; e < mesh.tet_count(); ++e) chosen[e] = rest.inverted(e, positions_m);
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<bool> touched(mesh.node_count());
    for (int e = 0; e < mesh.tet_count(); ++e)
      if (chosen[e])
        for (const int node : mesh.tets.col(e)) touched[node] = true;
    for (int e = 0; e < mesh.tet_count(); ++e)
      chosen[e] = std::any_of(mesh.tets.col(e).begin(), mesh.tets.col(e).end(), [&](int n) { return touched[n]; });
  }
  return chosen;
}

// The turn that takes the nodes' rest shape nearest to where they are (Kabsch 1976).
Eigen::Matrix3d turn_of(const std::vector<int>& nodes, const TetMesh& mesh, const Eigen::Matrix3Xd& positions_m) {
  if (nodes.size() < 3) return Eigen::Matrix3d::Identity();
  Eigen::Matrix3Xd from(3, nodes.size()), to(3, nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = mesh.nodes_m.col(nodes[i]);
    to.col(static_cast<Eigen::Index>(i)) = positions_m.col(nodes[i]);
  }
  return Eigen::umeyama(from, to, false).topLeftCorner<3, 3>();
}

}  // namespace

Untangled untangle(const Body& body, int rings, Eigen::Matrix3Xd& positions_m) {
  const TetMesh& mesh = body.mesh();
  const RestElements rest(mesh);
  const std::vector<bool> chosen = near_inverted(mesh, rest, rings, positions_m);
  std::vector<bool> in_patch(mesh.node_count()), stays(mesh.node_count());
  Untangled done;
  for (int e = 0; e < mesh.tet_count(); ++e) {
    if (chosen[e]) done.elements.push_back(e);
    for (const int node : mesh.tets.col(e)) (chosen[e] ? in_patch : stays)[node] = true;
  }
  std::vector<int> rim, place(mesh.node_count(), -1);
  for (int node = 0; node < mesh.node_count(); ++node) {
    if (!in_patch[node]) continue;
    if (stays[node] || body.fixed().col(node).any()) {
      rim.push_back(node);
    } else {
      place[node] = static_cast<int>(done.nodes.size());
      done.nodes.push_back(node);
    }
  }
  if (done.nodes.empty()) return {};

  // x = R X + u, where u is harmonic and known on the rim.
  const Eigen::Matrix3Xd turned = turn_of(rim, mesh, positions_m) * mesh.nodes_m;
  const auto count = static_cast<Eigen::Index>(done.nodes.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(count, 3);
  for (const int e : done.elements) {
    for (const RestPoint& point : rest.points(e)) {
      const Eigen::MatrixXd laplacian = point.weight_m3 * point.gradients.transpose() * point.gradients;
      for (Eigen::Index a = 0; a < laplacian.rows(); ++a) {
        const int row = place[mesh.tets(a, e)];
        if (row < 0) continue;
        for (Eigen::Index b = 0; b < laplacian.cols(); ++b) {
          const int node = mesh.tets(b, e);
          if (place[node] >= 0)
            entries.emplace_back(row, place[node], laplacian(a, b));
          else
            right.row(row) -= laplacian(a, b) * (positions_m.col(node) - turned.col(node)).transpose();
        }
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
  if (factor.info() != Eigen::Success) return {};
  const Eigen::MatrixX3d motion = factor.solve(right);
  if (!motion.allFinite()) return {};
  for (Eigen::Index i = 0; i < count; ++i)
    positions_m.col(done.nodes[static_cast<std::size_t>(i)]) =
        turned.col(done.nodes[static_cast<std::size_t>(i)]) + motion.row(i).transpose();
  return done;
}

}  // namespace soft_robot_lab
