// SPDX-License-Identifier: BSD-3-Clause
// What an eye sees of a skin of triangles: those that face it, the farthest first, so that a translucent skin shows one
// layer after the other; its edges; and how much each corner turns away. Knows no window.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

class SeenSkin {
 public:
  // Three corners a triangle, counter-clockwise from without; equal places are one corner. A triangle without an area
  // is never seen.
  void set_corners(std::vector<Eigen::Vector3f> corners_m);

  const std::vector<Eigen::Vector3f>& corners_m() const { return corners_m_; }
  int triangle_count() const { return static_cast<int>(corners_m_.size() / 3); }

  bool faces(int triangle, const Eigen::Vector3f& eye_m) const;
  // Of those that face the eye, the farthest first, by their middles.
  std::vector<int> sorted_from(const Eigen::Vector3f& eye_m) const;

  // Cosine between a corner's smooth normal and the way to the eye; 0 where it turns away.
  float facing(int corner, const Eigen::Vector3f& eye_m) const;

  // A place of the skin, which goes along with it.
  struct Place {
    int triangle = 0;
    Eigen::Vector3f weights = Eigen::Vector3f::UnitX();
  };
  Place nearest(const Eigen::Vector3f& point_m) const;  // there is a triangle
  Eigen::Vector3f at(const Place& place) const;

  struct Edge {
    int from, to;                  // corners
    std::array<int, 2> triangles;  // beside it; the same twice at a border
    bool crease;                   // turns by more than 40 degrees, or ends here
  };
  const std::vector<Edge>& edges() const { return edges_; }
  // A crease of which a side faces the eye, or where the skin turns away from it.
  bool is_drawn(const Edge& edge, const Eigen::Vector3f& eye_m) const;

 private:
  bool is_welded() const;
  void weld();
  void find_edges();
  void compute_normals();

  std::vector<Eigen::Vector3f> corners_m_, face_normals_, normals_;  // normals_: one a corner
  std::vector<int> places_;                                          // of each corner its place's number
  std::vector<std::vector<int>> corners_at_;                         // of each place
  std::vector<Edge> edges_;
};

}  // namespace soft_robot_lab
