// SPDX-License-Identifier: BSD-3-Clause
#include "seen_skin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace soft_robot_lab {
namespace {

const float kCrease = std::cos(40.0f * static_cast<float>(M_PI) / 180.0f);

std::size_t index(int i) { return static_cast<std::size_t>(i); }

bool is_before(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

}  // namespace

void SeenSkin::set_corners(std::vector<Eigen::Vector3f> corners_m) {
  corners_m.resize(corners_m.size() / 3 * 3);
  corners_m_ = std::move(corners_m);
  const bool known = is_welded();
  if (!known) weld();
  compute_normals();
  if (!known) find_edges();
  for (Edge& edge : edges_)
    edge.crease = edge.triangles[0] == edge.triangles[1] ||
                  face_normals_[index(edge.triangles[0])].dot(face_normals_[index(edge.triangles[1])]) < kCrease;
}

// Whether the places of the last message are those of this one: of another robot they seldom are.
bool SeenSkin::is_welded() const {
  if (places_.size() != corners_m_.size()) return false;
  return std::all_of(corners_at_.begin(), corners_at_.end(), [&](const std::vector<int>& corners) {
    return std::all_of(corners.begin(), corners.end(),
                       [&](int corner) { return corners_m_[index(corner)] == corners_m_[index(corners.front())]; });
  });
}

void SeenSkin::weld() {
  std::vector<int> order(corners_m_.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return is_before(corners_m_[index(a)], corners_m_[index(b)]); });
  places_.assign(corners_m_.size(), 0);
  corners_at_.clear();
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || corners_m_[index(order[i])] != corners_m_[index(order[i - 1])]) corners_at_.emplace_back();
    places_[index(order[i])] = static_cast<int>(corners_at_.size()) - 1;
    corners_at_.back().push_back(order[i]);
  }
}

void SeenSkin::compute_normals() {
  std::vector<Eigen::Vector3f> areas(index(triangle_count()));
  face_normals_.resize(areas.size());
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const Eigen::Vector3f* corner = &corners_m_[3 * i];
    areas[i] = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    face_normals_[i] = areas[i].stableNormalized();
  }
  normals_.resize(corners_m_.size());
  for (std::size_t i = 0; i < corners_m_.size(); ++i) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const int other : corners_at_[index(places_[i])])
      if (face_normals_[index(other / 3)].dot(face_normals_[i / 3]) > kCrease) sum += areas[index(other / 3)];
    normals_[i] = sum.stableNormalized();
  }
}

void SeenSkin::find_edges() {
  std::map<std::pair<int, int>, std::size_t> known;
  edges_.clear();
  for (int corner = 0; corner < static_cast<int>(corners_m_.size()); ++corner) {
    const int triangle = corner / 3, next = 3 * triangle + (corner + 1) % 3;
    const auto ends = std::minmax(places_[index(corner)], places_[index(next)]);
    const auto [found, is_new] = known.try_emplace({ends.first, ends.second}, edges_.size());
    if (is_new) {
      edges_.push_back({corner, next, {triangle, triangle}, false});
    } else {
      edges_[found->second].triangles[1] = triangle;
    }
  }
}

bool SeenSkin::faces(int triangle, const Eigen::Vector3f& eye_m) const {
  return face_normals_[index(triangle)].dot(eye_m - corners_m_[index(3 * triangle)]) > 0.0f;
}

std::vector<int> SeenSkin::sorted_from(const Eigen::Vector3f& eye_m) const {
  std::vector<std::pair<float, int>> seen;
  for (int i = 0; i < triangle_count(); ++i) {
    if (!faces(i, eye_m)) continue;
    const Eigen::Vector3f* corner = &corners_m_[index(3 * i)];
    seen.emplace_back((corner[0] + corner[1] + corner[2] - 3.0f * eye_m).squaredNorm(), i);
  }
  std::sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a > b; });
  std::vector<int> order;
  for (const auto& [distance, triangle] : seen) order.push_back(triangle);
  return order;
}

float SeenSkin::facing(int corner, const Eigen::Vector3f& eye_m) const {
  return std::max(0.0f, normals_[index(corner)].dot((eye_m - corners_m_[index(corner)]).stableNormalized()));
}

// Beside a triangle the nearest place of it is taken at an edge nearly, not exactly.
SeenSkin::Place SeenSkin::nearest(const Eigen::Vector3f& point_m) const {
  Place best = {0, Eigen::Vector3f::UnitX()};
  float least_m = INFINITY;
  for (int i = 0; i < triangle_count(); ++i) {
    const Eigen::Vector3f* corner = &corners_m_[index(3 * i)];
    Eigen::Matrix<float, 3, 2> sides;
    sides << corner[1] - corner[0], corner[2] - corner[0];
    const Eigen::Matrix2f squares = sides.transpose() * sides;
    Eigen::Vector3f weights = Eigen::Vector3f::UnitX();
    if (squares.determinant() > 0.0f) {
      weights.tail<2>() = squares.inverse() * (sides.transpose() * (point_m - corner[0]));
      weights[0] = 1.0f - weights[1] - weights[2];
      weights = weights.cwiseMax(0.0f);
      weights /= weights.sum();
    }
    const float distance_m = (at({i, weights}) - point_m).norm();
    if (distance_m >= least_m) continue;
    least_m = distance_m;
    best = {i, weights};
  }
  return best;
}

Eigen::Vector3f SeenSkin::at(const Place& place) const {
  const Eigen::Vector3f* corner = &corners_m_[index(3 * place.triangle)];
  return place.weights[0] * corner[0] + place.weights[1] * corner[1] + place.weights[2] * corner[2];
}

bool SeenSkin::is_drawn(const Edge& edge, const Eigen::Vector3f& eye_m) const {
  const bool first = faces(edge.triangles[0], eye_m), second = faces(edge.triangles[1], eye_m);
  return (first || second) && (edge.crease || first != second);
}

}  // namespace soft_robot_lab
