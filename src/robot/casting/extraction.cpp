// SPDX-License-Identifier: BSD-3-Clause
#include "extraction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <Eigen/Geometry>

#include "sample_triangle.h"

namespace soft_robot_lab {
namespace {

const double kTolerance = std::sin(0.1 * M_PI / 180);  // of a normal that is meant to be at right angles
const double kSteepest = std::sin(15 * M_PI / 180);    // of a facet that may follow an upright round wall
constexpr double kSags = 1.5;                          // facets of one wall differ
constexpr double kSampleEdge = 1.0 / 60;               // of the robot's size: rays from larger facets are several

bool counts(const Surface& surface, int triangle) {
  return surface.areas_m2[triangle] > 0 &&
         surface.shell_volumes_m3[static_cast<size_t>(surface.shell[static_cast<size_t>(triangle)])] > 0;
}

std::vector<char> members(const HullPlane* top, const Surface& surface) {
  std::vector<char> inside(static_cast<size_t>(surface.triangle_count()), 0);
  if (top != nullptr)
    for (const int t : top->triangles) inside[static_cast<size_t>(t)] = 1;
  return inside;
}

double projected_area_m2(const Surface& surface, const Eigen::Vector3d& direction) {
  double area = 0;
  for (int t = 0; t < surface.triangle_count(); ++t)
    area += surface.areas_m2[t] * std::max(0.0, surface.true_normals.col(t).dot(direction));
  return area;
}

// The top for which most of the area that faces along the direction is in it.
const HullPlane* choose_top(const std::vector<HullPlane>& tops, const Eigen::Vector3d& direction) {
  const HullPlane* best = nullptr;
  double most = 0;
  for (const HullPlane& top : tops) {
    const double freed = top.area_m2 * top.normal.dot(direction);
    if (top.normal.dot(direction) <= kTolerance || freed <= most) continue;
    most = freed;
    best = &top;
  }
  return best;
}

void measure_trap(const RayTree& tree, const HullPlane* top, int triangle, double highest_m, Extraction& result) {
  const Surface& surface = tree.surface();
  const Eigen::Vector3d d = result.direction;
  const double cosine = surface.true_normals.col(triangle).dot(d);
  sample_triangle(surface, triangle, kSampleEdge * tree.size_m(), [&](const Eigen::Vector3d& p, double area) {
    const auto hit = tree.first_hit(p, d, tree.skip_m());
    const double to_top = top ? (top->offset_m - top->normal.dot(p)) / top->normal.dot(d) : highest_m - d.dot(p);
    const double depth = std::max(0.0, hit ? std::min(hit->distance_m, to_top) : to_top);
    result.undercut_volume_m3 += depth * area * cosine;
    if (depth <= result.trap_depth_m) return;
    result.trap_depth_m = depth;
    result.at_m = p;
  });
}

Eigen::Vector3d across(const Eigen::Vector3d& normal, const Eigen::Vector3d& direction) {
  return (normal - normal.dot(direction) * direction).normalized();
}

// Facets of a round wall may lean, as those of a twisted grid do. They hold nothing where the silicone goes on to the
// top within what they may stand off the wall.
bool leans_only(const RayTree& tree, const std::vector<char>& in_top, int triangle, const Eigen::Vector3d& direction) {
  const Surface& surface = tree.surface();
  const Eigen::Vector3d n = surface.true_normals.col(triangle);
  if (surface.sags_m.size() == 0 || surface.sags_m[triangle] == 0 || n.dot(direction) > kSteepest) return false;
  const Eigen::Vector3d inward_m = -kSags * surface.sags_m[triangle] * across(n, direction);
  bool goes_on = true;
  sample_triangle(surface, triangle, kSampleEdge * tree.size_m(), [&](const Eigen::Vector3d& p, double) {
    if (!goes_on) return;
    const auto hit = tree.first_hit(p + inward_m, direction, 0);
    goes_on = hit && in_top[static_cast<size_t>(hit->triangle)];
  });
  return goes_on;
}

// --- the best direction: max t with d . n <= -t, as a problem that three normals decide ---

struct Cap {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  double margin = -2;
};

void offer(const Eigen::Vector3d& direction, const std::vector<Eigen::Vector3d>& normals, const HullPlane& top,
           Cap& best) {
  const double length = direction.norm();
  if (length < 1e-9) return;
  const Eigen::Vector3d d = direction / length;
  if (d.dot(top.normal) <= kTolerance) return;
  double margin = 2;
  for (const auto& n : normals) margin = std::min(margin, -d.dot(n));
  if (margin > best.margin) best = {d, margin};
}

void offer_pair(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const std::vector<Eigen::Vector3d>& normals,
                const HullPlane& top, Cap& best) {
  offer(-(a + b), normals, top, best);
  offer(a.cross(b), normals, top, best);
  offer(b.cross(a), normals, top, best);
}

// Of few normals, by trying what one, two or three of them decide.
Cap solve_small(const std::vector<Eigen::Vector3d>& normals, const HullPlane& top) {
  Cap best;
  offer(top.normal, normals, top, best);
  for (size_t i = 0; i < normals.size(); ++i) {
    offer(-normals[i], normals, top, best);
    offer(top.normal - top.normal.dot(normals[i]) * normals[i], normals, top, best);
    for (size_t j = 0; j < i; ++j) {
      offer_pair(normals[i], normals[j], normals, top, best);
      for (size_t k = 0; k < j; ++k) {
        const Eigen::Vector3d d = -((normals[i] - normals[j]).cross(normals[i] - normals[k]));
        offer(d, normals, top, best);
        offer(-d, normals, top, best);
      }
    }
  }
  return best;
}

// Adds the normal that is most in the way until none is.
Cap solve(const std::vector<Eigen::Vector3d>& normals, const HullPlane& top) {
  constexpr size_t kMost = 40;  // a few are needed; more is rounding
  constexpr double kExact = 1e-9;
  std::vector<Eigen::Vector3d> few;
  Cap cap{top.normal, 2};
  while (few.size() < kMost) {
    double worst = 2;
    const Eigen::Vector3d* found = nullptr;
    for (const auto& n : normals) {
      const double margin = -cap.direction.dot(n);
      if (margin < worst) worst = margin, found = &n;
    }
    if (found == nullptr || worst >= cap.margin - kExact) return {cap.direction, worst};
    few.push_back(*found);
    cap = solve_small(few, top);
    if (cap.margin < -kTolerance) return cap;
  }
  return cap;
}

// Alike ones once: to 1e-6, far less than the tolerance.
std::vector<Eigen::Vector3d> different_normals(const Surface& surface, const HullPlane& top) {
  const std::vector<char> in_top = members(&top, surface);
  std::map<std::array<long, 3>, Eigen::Vector3d> found;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    if (in_top[static_cast<size_t>(t)] || !counts(surface, t)) continue;
    const Eigen::Vector3d n = surface.true_normals.col(t);
    found.emplace(std::array<long, 3>{std::lround(n.x() * 1e6), std::lround(n.y() * 1e6), std::lround(n.z() * 1e6)}, n);
  }
  std::vector<Eigen::Vector3d> normals;
  for (const auto& entry : found) normals.push_back(entry.second);
  return normals;
}

double area_in_the_way_m2(const Surface& surface, const std::vector<HullPlane>& tops,
                          const Eigen::Vector3d& direction) {
  const HullPlane* top = choose_top(tops, direction);
  return projected_area_m2(surface, direction) - (top ? top->area_m2 * top->normal.dot(direction) : 0);
}

}  // namespace

std::vector<HullPlane> find_tops(const Surface& surface) {
  const double size = surface.size_m(), tolerance_m = 1e-7 * size, least_m2 = 0.5 * surface.volume_m3() / size;
  std::map<std::array<long, 4>, HullPlane> planes;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    if (!counts(surface, t)) continue;
    const Eigen::Vector3d n = surface.normals.col(t);
    const double offset = surface.corner(t, 0).dot(n);
    HullPlane& plane = planes[{std::lround(n.x() * 1e5), std::lround(n.y() * 1e5), std::lround(n.z() * 1e5),
                               std::lround(offset / (1e-5 * size))}];
    if (plane.triangles.empty()) plane.normal = n, plane.offset_m = offset;
    plane.area_m2 += surface.areas_m2[t];
    plane.triangles.push_back(t);
  }
  std::vector<HullPlane> tops;
  for (auto& entry : planes) {
    HullPlane& plane = entry.second;
    if (plane.area_m2 < least_m2) continue;
    const double highest = (plane.normal.transpose() * surface.vertices_m).maxCoeff();
    if (highest <= plane.offset_m + 100 * tolerance_m) tops.push_back(std::move(plane));
  }
  std::sort(tops.begin(), tops.end(), [](const auto& a, const auto& b) { return a.area_m2 > b.area_m2; });
  return tops;
}

Extraction verify_extraction(const CastShape& shape, const Eigen::Vector3d& direction) {
  const RayTree& tree = shape.tree;
  const Surface& surface = tree.surface();
  Extraction result;
  result.direction = direction;
  const HullPlane* top = choose_top(shape.tops, direction);
  if (top != nullptr) result.top_area_m2 = top->area_m2, result.top_normal = top->normal;
  const std::vector<char> in_top = members(top, surface);
  const double highest_m = (direction.transpose() * surface.vertices_m).maxCoeff();
  double steepest = -1;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    if (in_top[static_cast<size_t>(t)] || !counts(surface, t)) continue;
    double cosine = surface.true_normals.col(t).dot(direction);
    if (cosine > kTolerance && leans_only(tree, in_top, t, direction)) cosine = 0;
    steepest = std::max(steepest, cosine);
    if (cosine <= kTolerance) continue;
    result.blocked.push_back(t);
    result.blocked_area_m2 += surface.areas_m2[t];
    measure_trap(tree, top, t, highest_m, result);
  }
  result.draft_deg = std::asin(std::clamp(-steepest, -1.0, 1.0)) * 180 / M_PI;
  result.passed = top != nullptr && result.blocked.empty();
  return result;
}

std::optional<Eigen::Vector3d> best_direction(const Surface& surface, const std::vector<HullPlane>& tops) {
  Cap best;
  for (const HullPlane& top : tops) {
    const Cap cap = solve(different_normals(surface, top), top);
    if (cap.margin > best.margin) best = cap;
  }
  if (best.margin < -kTolerance) return std::nullopt;
  return best.direction;
}

Eigen::Vector3d least_blocked_direction(const Surface& surface, const std::vector<HullPlane>& tops) {
  std::vector<Eigen::Vector3d> candidates;
  for (size_t i = 0; i < std::min<size_t>(tops.size(), 100); ++i) candidates.push_back(tops[i].normal);
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) candidates.push_back(sign * Eigen::Vector3d::Unit(axis));
  constexpr int kPoints = 300;  // of a sphere, on a spiral
  for (int i = 0; i < kPoints; ++i) {
    const double z = 1 - (2 * i + 1.0) / kPoints, angle = i * M_PI * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
    candidates.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  Eigen::Vector3d best = candidates.front();
  double least = area_in_the_way_m2(surface, tops, best);
  for (const Eigen::Vector3d& direction : candidates) {
    const double area = area_in_the_way_m2(surface, tops, direction);
    if (area < least * (1 - 1e-9)) least = area, best = direction;
  }
  return best;
}

TwoPart verify_two_parts(const RayTree& tree, const Eigen::Vector3d& direction) {
  const Surface& surface = tree.surface();
  TwoPart result;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const double cosine = surface.true_normals.col(t).dot(direction);
    if (!counts(surface, t) || std::abs(cosine) <= kTolerance) continue;
    const Eigen::Vector3d away = cosine > 0 ? direction : Eigen::Vector3d(-direction);
    const bool leans = surface.sags_m.size() > 0 && std::abs(cosine) < kSteepest;
    const Eigen::Vector3d outward_m =
        (leans ? kSags * surface.sags_m[t] : 0.0) * across(surface.true_normals.col(t), direction);
    sample_triangle(surface, t, kSampleEdge * tree.size_m(), [&](const Eigen::Vector3d& p, double area) {
      const auto hit = tree.first_hit(p + outward_m, away, tree.skip_m());
      if (!hit) return;
      result.blocked_area_m2 += area;
      result.undercut_volume_m3 += 0.5 * hit->distance_m * area * std::abs(cosine);  // seen from both of its sides
    });
  }
  result.passed = result.blocked_area_m2 <= 1e-6 * surface.areas_m2.sum();
  return result;
}

}  // namespace soft_robot_lab
