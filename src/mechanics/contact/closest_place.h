// SPDX-License-Identifier: BSD-3-Clause
// The place on a face of the skin that is closest to a point, and the gap there.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace soft_robot_lab {

using FaceNodes = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 6>;  // three corners, and three midside nodes or none

// A face as a polynomial of its coordinates, of terms 1, r, s, r^2, r s, s^2.
class FacePolynomial {
 public:
  explicit FacePolynomial(const FaceNodes& nodes);

  Eigen::Vector3d at(double r, double s) const { return corner_ + r * (r_ + r * rr_ + s * rs_) + s * (s_ + s * ss_); }
  Eigen::Vector3d along_r(double r, double s) const { return r_ + 2.0 * r * rr_ + s * rs_; }
  Eigen::Vector3d along_s(double r, double s) const { return s_ + r * rs_ + 2.0 * s * ss_; }
  // Second derivatives along a direction: by r, by s, by both.
  Eigen::Vector3d bends(const Eigen::Vector3d& along) const {
    return {2.0 * rr_.dot(along), 2.0 * ss_.dot(along), rs_.dot(along)};
  }

 private:
  Eigen::Vector3d corner_, r_, s_, rr_, rs_, ss_;
};

// A place on a face as a point sees it.
struct SeenPlace {
  SeenPlace(const FacePolynomial& face, const Eigen::Vector2d& coordinates, const Eigen::Vector3d& point_m);

  Eigen::Vector2d local;   // coordinates
  Eigen::Vector3d normal;  // of the face; not finite where it has none
  Eigen::Vector3d off_m;   // from there to the point
  double gap_m;            // along the normal
};

// A place at an edge that the point is beyond. It moves along that edge alone, in coordinates by `along` times
//   by_way_per_m . (motion of the point - of the place) + by_nodes_per_m_a . (motion of the face's node a)
struct PlaceAtEdge {
  PlaceAtEdge(const FaceNodes& nodes, const SeenPlace& place);

  Eigen::Vector2d along;  // zero at a corner
  Eigen::Vector3d by_way_per_m;
  FaceNodes by_nodes_per_m;
  Eigen::Matrix<double, 3, 2> dual_per_m;  // of the tangents there: d coordinate / d position
  Eigen::Matrix2d curvature_m;             // n . d2y
  Eigen::Vector3d beyond_m;                // from the place to the point, along the face
};

// Coordinates of the closest place; and of a point that is above or below the face, none where it is clearly more than
// `most_m` beside that.
Eigen::Vector2d closest(const FacePolynomial& face, const Eigen::Vector3d& point_m);
std::optional<Eigen::Vector2d> closest_above(const FacePolynomial& face, const Eigen::Vector3d& point_m, double most_m);

// The closest place from one at an edge on, beyond which the face goes on by a tenth; none where it would be farther.
std::optional<SeenPlace> closest_beyond(const FacePolynomial& face, const Eigen::Vector3d& point_m,
                                        Eigen::Vector2d local);

}  // namespace soft_robot_lab
