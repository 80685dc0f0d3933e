// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/body.h"

#include <cmath>
#include <set>
#include <stdexcept>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "mechanics/contact/overlap.h"
#include "shape_functions.h"

namespace soft_robot_lab {
namespace {

bool inside(const Eigen::Vector3d& point, const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  return (point.array() >= min.array()).all() && (point.array() <= max.array()).all();
}

double rest_volume(const TetMesh& mesh, int element) {
  double sum = 0.0;
  for (const Eigen::Vector3d& point : tet_quadrature_points()) {
    const ShapeFunctions shape = shape_functions(static_cast<int>(mesh.tets.rows()), point);
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
    for (Eigen::Index a = 0; a < mesh.tets.rows(); ++a)
      jacobian += mesh.nodes_m.col(mesh.tets(a, element)) * shape.gradients.col(a).transpose();
    sum += jacobian.determinant() / 24.0;
  }
  return sum;
}

// Integrals of a face's shape functions over its rest area, by the six-point rule of degree 4 (Dunavant 1985).
Eigen::VectorXd face_areas(const TetMesh& mesh, Eigen::Index face) {
  constexpr double kPoints[6][3] = {{0.445948490915965, 0.445948490915965, 0.223381589678011},
                                    {0.445948490915965, 0.108103018168070, 0.223381589678011},
                                    {0.108103018168070, 0.445948490915965, 0.223381589678011},
                                    {0.091576213509771, 0.091576213509771, 0.109951743655322},
                                    {0.091576213509771, 0.816847572980459, 0.109951743655322},
                                    {0.816847572980459, 0.091576213509771, 0.109951743655322}};
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.faces.rows());
  for (const auto& point : kPoints) {
    const FaceShape shape = face_shape(mesh.faces.rows(), point[0], point[1]);
    Eigen::Vector3d along_r = Eigen::Vector3d::Zero(), along_s = Eigen::Vector3d::Zero();
    for (Eigen::Index a = 0; a < mesh.faces.rows(); ++a) {
      along_r += shape.slopes(0, a) * mesh.nodes_m.col(mesh.faces(a, face));
      along_s += shape.slopes(1, a) * mesh.nodes_m.col(mesh.faces(a, face));
    }
    areas += 0.5 * point[2] * along_r.cross(along_s).norm() * shape.values;
  }
  return areas;
}

}  // namespace

Body::Body(TetMesh mesh, const Material& material) : mesh_(std::move(mesh)), material_(material) {
  material_.validate();
  check_mesh(mesh_);
  complete_boundary(mesh_);
  fixed_ = FixedAxes::Constant(3, mesh_.node_count(), false);
  dead_loads_n_ = Eigen::Matrix3Xd::Zero(3, mesh_.node_count());
  node_masses_kg_ = Eigen::VectorXd::Zero(mesh_.node_count());
  for (int e = 0; e < mesh_.tet_count(); ++e) {
    const double mass = material_.density_kg_m3 * rest_volume(mesh_, e);
    for (Eigen::Index a = 0; a < mesh_.tets.rows(); ++a) {
      const double fraction = !mesh_.quadratic() ? 0.25 : a < 4 ? 1.0 / 36.0 : 4.0 / 27.0;
      node_masses_kg_[mesh_.tets(a, e)] += fraction * mass;
    }
  }
}

int Body::fix_nodes(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m,
                    const Eigen::Matrix<bool, 3, 1>& axes) {
  int count = 0;
  for (int node = 0; node < mesh_.node_count(); ++node) {
    if (!inside(mesh_.nodes_m.col(node), box_min_m, box_max_m)) continue;
    fixed_.col(node) = fixed_.col(node).array() || axes.array();
    ++count;
  }
  return count;
}

double Body::add_traction(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m,
                          const Eigen::Vector3d& traction_pa) {
  double loaded = 0.0;
  for (Eigen::Index face = 0; face < mesh_.faces.cols(); ++face) {
    bool all_inside = true;
    for (int corner = 0; corner < 3; ++corner)
      all_inside = all_inside && inside(mesh_.nodes_m.col(mesh_.faces(corner, face)), box_min_m, box_max_m);
    if (!all_inside) continue;
    const Eigen::VectorXd areas = face_areas(mesh_, face);
    for (Eigen::Index a = 0; a < areas.size(); ++a) dead_loads_n_.col(mesh_.faces(a, face)) += areas[a] * traction_pa;
    loaded += areas.sum();
  }
  return loaded;
}

void Body::add_force(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m,
                     const Eigen::Vector3d& force_n) {
  const double area = add_traction(box_min_m, box_max_m, Eigen::Vector3d::Zero());
  if (!(area > 0.0)) throw std::invalid_argument("force_n: no boundary face lies inside the load's box");
  add_traction(box_min_m, box_max_m, force_n / area);
}

void Body::set_linear_volume(LinearVolume volume) {
  if (volume == LinearVolume::vertex_averaged && mesh_.quadratic())
    throw std::invalid_argument("linear_volume: vertex_averaged is for element: linear, not quadratic");
  linear_volume_ = volume;
}

void Body::set_viscosity(const Viscosity& viscosity) {
  viscosity.validate();
  viscosity_ = viscosity;
}

void Body::set_obstacles(std::vector<Obstacle> obstacles) {
  std::set<std::string> names;
  for (const Obstacle& obstacle : obstacles) {
    if (!names.insert(obstacle.name).second)
      throw std::invalid_argument("two obstacles are named '" + obstacle.name + "'");
    try {
      obstacle.validate();
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("obstacle '" + obstacle.name + "': " + error.what());
    }
  }
  refuse_overlap(*this, obstacles);
  obstacles_ = std::move(obstacles);
}

int Body::fixed_node_count() const {
  int count = 0;
  for (Eigen::Index node = 0; node < fixed_.cols(); ++node) count += fixed_.col(node).any() ? 1 : 0;
  return count;
}

Eigen::Matrix3Xd Body::external_forces_n() const { return dead_loads_n_ + gravity_m_s2_ * node_masses_kg_.transpose(); }

double Body::size_m() const { return (mesh_.nodes_m.rowwise().maxCoeff() - mesh_.nodes_m.rowwise().minCoeff()).norm(); }

}  // namespace soft_robot_lab
