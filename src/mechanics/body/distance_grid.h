// SPDX-License-Identifier: BSD-3-Clause
// Signed distances to a closed surface on a grid, and cubic B-splines over them: twice continuously differentiable
// everywhere. Planes come out exactly where no other side is within two steps; edges, inner ones too, are rounded by
// about a step, and a round side of radius R stands back by step^2 / (3 R).
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "closed_surface.h"
#include "gap.h"

namespace soft_robot_lab {

// Of the spline, in the grid's frame and in its steps.
struct SplineValue {
  double value;
  Eigen::Vector3d slope;
  Eigen::Matrix3d bend;
};

class DistanceGrid {
 public:
  // Its nodes lie in the surface's own frame, one of them at the centroid.
  DistanceGrid(const ClosedSurface& surface, double step_m);
  // How many nodes there would be; no grid is needed for that.
  static double node_count(const ClosedSurface& surface, double step_m);

  double step_m() const { return step_m_; }
  Eigen::Vector3d to_steps(const Eigen::Vector3d& point_m) const {
    return frame_.transpose() * (point_m - centroid_m_) / step_m_ + centroid_;
  }
  Eigen::Vector3d to_metres(const Eigen::Vector3d& at) const {
    return centroid_m_ + step_m_ * (frame_ * (at - centroid_));
  }
  const Eigen::Matrix3d& frame() const { return frame_; }

  // Where the spline is known nearest to a place.
  Eigen::Vector3d within(const Eigen::Vector3d& at) const { return at.cwiseMax(1.0).cwiseMin(last_); }
  SplineValue spline(const Eigen::Vector3d& at) const;  // at a place within
  // The gap at a place within, in steps, by the nearest node, where that is far from the surface; else none. Outside it
  // is no more than the distance.
  std::optional<Gap> far(const Eigen::Vector3d& at) const;
  Eigen::Vector3d deepest() const;  // the node with the least value

 private:
  std::size_t index(const Eigen::Array3i& node) const {
    return static_cast<std::size_t>(node[0]) +
           static_cast<std::size_t>(size_[0]) *
               (static_cast<std::size_t>(node[1]) +
                static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(node[2]));
  }
  void measure_near(const ClosedSurface& surface);
  void measure_near(const ClosedSurface& surface, Eigen::Index triangle);
  void fill_far();
  void fill_far(const Eigen::Array3i& way);
  void fill(const Eigen::Array3i& node);

  double step_m_;
  Eigen::Matrix3d frame_;
  Eigen::Vector3d centroid_m_, centroid_, last_;  // where the centroid is in steps
  Eigen::Array3i size_;
  std::vector<double> values_;  // distances in steps, positive outside
};

}  // namespace soft_robot_lab
