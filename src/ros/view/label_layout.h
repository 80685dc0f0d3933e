// SPDX-License-Identifier: BSD-3-Clause
// Where labels stand in a window: beside what they name, apart from one another, and off the body. In pixels, x to the
// right and y down. Knows no window.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

namespace soft_robot_lab {

// The part of a window that a body covers, by squares.
class CoveredCells {
 public:
  explicit CoveredCells(const Eigen::Vector2d& window_px);

  // Corners may lie outside of the window; of a triangle with a corner that is not finite nothing is taken.
  void add_triangle(const Eigen::Vector2d& a_px, const Eigen::Vector2d& b_px, const Eigen::Vector2d& c_px);

  double share_of(const Eigen::AlignedBox2d& box_px) const;  // [0, 1] of the box's squares

 private:
  bool covered(int column, int row) const;

  int columns_, rows_;
  std::vector<bool> covered_;
};

struct Label {
  Eigen::Vector2d anchor_px;  // what it names
  Eigen::Vector2d size_px;
  std::optional<Eigen::Vector2d> offset_px;  // of its centre from the anchor, where it stood before
};

// One centre a label. Labels overlap only where the window has no room for all. A label stays where it stood unless
// another place is much better.
std::vector<Eigen::Vector2d> place_labels(const std::vector<Label>& labels, const CoveredCells& body,
                                          const Eigen::Vector2d& window_px);

}  // namespace soft_robot_lab
