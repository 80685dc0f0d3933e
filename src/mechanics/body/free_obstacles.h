// SPDX-License-Identifier: BSD-3-Clause
// The obstacles of a body that are free: rigid things with six unknowns of motion each. What never changes of them, and
// where a state puts them.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "soft_robot_lab/mechanics/obstacle.h"

namespace soft_robot_lab {

// That of a solid of this shape, evenly filled, about its centre; rounded edges count as sharp.
Eigen::Matrix3d solid_inertia_kg_m2(const ObstacleShape& shape, double mass_kg);

double volume_m3(const ObstacleShape& shape);  // likewise; infinite of a plane

double size_m(const ObstacleShape& shape);  // half its least extent; of a mesh half its thickness

// Axis times angle of the turn that leads from one quaternion (x, y, z, w) to another; and the way back.
Eigen::Vector3d turned_rad(const Eigen::Vector4d& from, const Eigen::Vector4d& to);
Eigen::Vector4d turn_by(const Eigen::Vector3d& rotation_rad, const Eigen::Vector4d& from);

class FreeObstacles {
 public:
  FreeObstacles() = default;  // none
  FreeObstacles(const std::vector<Obstacle>& obstacles, const Eigen::Vector3d& gravity_m_s2);

  int count() const { return static_cast<int>(masses_kg_.size()); }
  int index_of(int obstacle) const;  // among the free; -1: it is not
  int obstacle(int free) const { return obstacle_of_[static_cast<std::size_t>(free)]; }
  double mass_kg(int free) const { return masses_kg_[static_cast<std::size_t>(free)]; }
  double size_m(int free) const { return sizes_m_[static_cast<std::size_t>(free)]; }
  const Eigen::Vector3d& gravity_m_s2() const { return gravity_m_s2_; }
  double weight_n() const;  // of all

  FreePoses at_start() const;
  FreeVelocities velocities_at_start() const;

  // From the shape as stated to where it stands.
  Eigen::Isometry3d pose(int free, const FreePoses& poses) const;
  Eigen::Matrix3d inertia_kg_m2(int free, const Eigen::Vector4d& turn) const;  // along robot_base's axes

 private:
  std::vector<int> of_obstacle_, obstacle_of_;
  std::vector<double> masses_kg_, sizes_m_;
  std::vector<Eigen::Matrix3d> inertias_kg_m2_;
  FreePoses start_;
  FreeVelocities velocities_;
  Eigen::Vector3d gravity_m_s2_ = Eigen::Vector3d::Zero();
};

// Columns of a motion, or of what works on it: of a free obstacle its centre's way or a force, and after it its turn or
// a torque about its centre.
using FreeColumns = Eigen::Matrix3Xd;

// Where a motion of free obstacles leads.
FreePoses moved(const FreePoses& from, const FreeColumns& motion);

}  // namespace soft_robot_lab
