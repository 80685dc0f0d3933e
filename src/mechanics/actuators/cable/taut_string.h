// SPDX-License-Identifier: BSD-3-Clause
// A massless string, pulled tight between two points, that keeps out of rigid obstacles and slides on them: the
// shortest way on its side of each obstacle. It is a chain of equal pieces; where the chain presses on an obstacle its
// joints lie on that. What the ends feel is then the derivative of the length.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/obstacle.h"

namespace soft_robot_lab {

class TautString {
 public:
  using Way = Eigen::Matrix3Xd;  // its joints, with both ends

  // On each obstacle's side where a line from end to end lies that is led over these points. `length_m` is about that
  // of the string, and decides on the number of joints.
  TautString(std::vector<ObstacleShape> obstacles, std::vector<Eigen::Vector3d> led_over_m, double length_m);

  // Of a string between two points; the last answer is kept for each thread. Not finite where no way was found.
  struct Shape {
    Way way_m;
    double length_m;
    Eigen::Vector3d first, last;          // derivative by the ends: nearly unit vectors, out of the string
    Eigen::Matrix<double, 6, 6> hessian;  // by first and last [1/m]
    double turned_rad;                    // sum of the angles at the joints that press
    Eigen::Matrix<double, 6, 1> turned_gradient;

    // Where it is nearest to a place, as a share of the length.
    double share_at(const Eigen::Vector3d& position_m) const;
  };
  std::shared_ptr<const Shape> between(const Eigen::Vector3d& first_m, const Eigen::Vector3d& last_m) const;

  const std::vector<Eigen::Vector3d>& led_over_m() const { return led_over_m_; }

 private:
  class Tightening;

  Way led(const Eigen::Vector3d& first_m, const Eigen::Vector3d& last_m) const;
  bool free(const Way& way) const;
  Way tight(const Eigen::Vector3d& first_m, const Eigen::Vector3d& last_m) const;
  Shape shape(const Way& way) const;

  std::vector<ObstacleShape> obstacles_;
  std::vector<Eigen::Vector3d> led_over_m_;
  double smallest_m_;  // radius at which an obstacle is round
  Eigen::Index joints_;
  long id_;  // unlike all others'
};

}  // namespace soft_robot_lab
