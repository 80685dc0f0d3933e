// SPDX-License-Identifier: BSD-3-Clause
// A silicone body: what never changes while it is simulated.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "material.h"
#include "obstacle.h"
#include "tet_mesh.h"
#include "viscosity.h"

namespace soft_robot_lab {

// What linear tetrahedra keep nearly constant: each its own volume, which locks in silicone, or the mean around each
// vertex.
enum class LinearVolume { element, vertex_averaged };

using FixedAxes = Eigen::Matrix<bool, 3, Eigen::Dynamic>;

// Dead loads are per undeformed area or volume and keep their direction. Frame: robot_base; SI units.
class Body {
 public:
  // Checks the mesh (check_mesh) and the material; nothing is fixed, no gravity.
  Body(TetMesh mesh, const Material& material);

  // Holds the listed axes of every node whose rest position lies in the box; returns how many nodes.
  int fix_nodes(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m,
                const Eigen::Matrix<bool, 3, 1>& axes);

  // Boundary faces whose corners all lie in the box; returns the loaded rest area [m^2].
  double add_traction(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m,
                      const Eigen::Vector3d& traction_pa);
  // The same with a total force spread evenly over the area. Throws std::invalid_argument where there is none.
  void add_force(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m, const Eigen::Vector3d& force_n);

  // Throws std::invalid_argument for vertex_averaged on a quadratic mesh.
  void set_linear_volume(LinearVolume volume);

  void set_viscosity(const Viscosity& viscosity);  // throws std::invalid_argument: Viscosity::validate

  // What the skin touches, where each stands at the start of its motion. Throws std::invalid_argument for a shape or
  // motion out of range, two of one name, and one that is inside the body, with depth and place.
  void set_obstacles(std::vector<Obstacle> obstacles);

  void set_gravity(const Eigen::Vector3d& gravity_m_s2) { gravity_m_s2_ = gravity_m_s2; }

  const TetMesh& mesh() const { return mesh_; }
  const Material& material() const { return material_; }
  const Viscosity& viscosity() const { return viscosity_; }
  LinearVolume linear_volume() const { return linear_volume_; }
  const FixedAxes& fixed() const { return fixed_; }
  int fixed_node_count() const;
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }
  const Eigen::VectorXd& node_masses_kg() const { return node_masses_kg_; }
  const Eigen::Vector3d& gravity_m_s2() const { return gravity_m_s2_; }
  Eigen::Matrix3Xd external_forces_n() const;  // gravity and dead loads, 3 x nodes
  double size_m() const;                       // diagonal of the rest bounding box

 private:
  TetMesh mesh_;
  Material material_;
  Viscosity viscosity_;
  LinearVolume linear_volume_ = LinearVolume::element;
  FixedAxes fixed_;
  Eigen::VectorXd node_masses_kg_;
  Eigen::Matrix3Xd dead_loads_n_;
  std::vector<Obstacle> obstacles_;
  Eigen::Vector3d gravity_m_s2_ = Eigen::Vector3d::Zero();
};

}  // namespace soft_robot_lab
