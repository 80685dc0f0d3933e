// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "settings/limits.h"
#include "settings/point_text.h"

namespace soft_robot_lab {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSteps = 64.0;  // of the grid along the largest size
constexpr double kNear = 0.25;   // steps from the surface within which the gap is its distance to the last digit
constexpr double kBlendFrom = 0.5, kBlendTo = 1.5;  // steps, from the first estimate of the distance to the spline
constexpr double kLeastSlope = 0.5;
constexpr int kSamples = 4000;         // of the surface, at least
constexpr double kMeanOff = 0.05;      // steps, by which the surface may be off its triangles,
constexpr double kFarOff = 0.25;       // and by that on
constexpr double kGone = 0.75;         // steps: farther than at the corner of a cube
constexpr double kShareFarOff = 0.05;  // of it
constexpr double kThinShare = 0.05;    // of the surface behind which it may be thinner, as near sharp edges
constexpr double kLeastHalf = 1.0;     // steps: half of the thinnest wall that the grid sees
constexpr double kLost = 4.0;          // steps from what is left: no edge ends so far inside
constexpr double kExactFace = 2.0;     // steps from its sides, where a flat face is exact
constexpr double kFlatFace = 0.125;  // of the largest size: the side of a square as large as a face that counts as flat

struct Sample {
  Vector3d at_m, inward;
  double area_m2;
};

// Spread evenly over all triangles.
std::vector<Sample> samples_of(const ClosedSurface& surface) {
  double area_m2 = 0.0;
  for (Eigen::Index t = 0; t < surface.count(); ++t) area_m2 += surface.area_m2(t);
  std::vector<Sample> samples;
  for (Eigen::Index t = 0; t < surface.count(); ++t) {
    if (surface.area_m2(t) == 0.0) continue;
    const int parts = std::max(1, static_cast<int>(std::ceil(std::sqrt(kSamples * surface.area_m2(t) / area_m2))));
    const Matrix3d corners_m = surface.corners_m(t);
    const double share = 1.0 / (3.0 * parts);
    const auto add = [&](double u, double v) {
      const Vector3d at_m = corners_m * Vector3d(1.0 - u - v, u, v);
      samples.push_back({at_m, -surface.normal(t), surface.area_m2(t) / (parts * parts)});
    };
    for (int i = 0; i < parts; ++i)
      for (int j = 0; i + j < parts; ++j) {
        add(share * (3 * i + 1), share * (3 * j + 1));
        if (i + j + 1 < parts) add(share * (3 * i + 2), share * (3 * j + 2));
      }
  }
  return samples;
}

// How far the surface is off its triangles, in steps.
struct Departure {
  double mean = 0.0, far_share = 0.0, gone_share = 0.0;  // the latter two of all

  // Edges that are rounded because a file asks for it may be any share of it.
  bool allowed(bool asked_for) const {
    return gone_share <= kShareFarOff && (asked_for || (mean <= kMeanOff && far_share <= kShareFarOff));
  }
};

Departure departure(const DistanceGrid& grid, const std::vector<Sample>& samples) {
  Departure off;
  double all_m2 = 0.0;
  for (const Sample& sample : samples) {
    const double steps = std::abs(grid.spline(grid.within(grid.to_steps(sample.at_m))).value);
    all_m2 += sample.area_m2;
    off.mean += sample.area_m2 * steps;
    if (steps > kFarOff) off.far_share += sample.area_m2;
    if (steps > kGone) off.gone_share += sample.area_m2;
  }
  off.mean /= all_m2;
  off.far_share /= all_m2;
  off.gone_share /= all_m2;
  return off;
}

double largest_m(const ClosedSurface& surface) {
  const Eigen::Matrix3Xd at_m = surface.frame().transpose() * surface.vertices_m();
  return (at_m.rowwise().maxCoeff() - at_m.rowwise().minCoeff()).maxCoeff();
}

[[noreturn]] void refuse_large(double step_m, double nodes) {
  std::ostringstream text;
  text << "with edges rounded by " << step_m << " m its grid of distances has " << nodes << " nodes, at most "
       << limits::kDistanceNodes << " are made; choose a larger rounding_m";
  throw std::invalid_argument(text.str());
}

// From a place on the triangles straight in, to where that comes out again, in steps. The rounded surface may begin
// farther in; 0: it is not met.
double way_through(const DistanceGrid& grid, const Sample& sample) {
  constexpr double kStride = 0.5, kFarthestIn = 2.0;
  const Vector3d start = grid.to_steps(sample.at_m), way = grid.frame().transpose() * sample.inward;
  bool inside = false;
  for (double along = kStride; inside || along <= kFarthestIn;) {
    const double depth = -grid.spline(grid.within(start + along * way)).value;
    if (inside && depth <= 0.0) return along;
    inside = inside || depth > 0.0;
    along += std::max(depth, kStride);
  }
  return 0.0;
}

struct ThinWall {
  double half_m = 0.0;
  Vector3d at_m = Vector3d::Zero();
  bool lost = false;  // a pin or a fin that the rounded surface does not have at all
};

// Of the places that the surface is not met behind, the one that is farthest from all others; it is lost if that is
// far.
void find_lost(const std::vector<Sample>& samples, const std::vector<double>& ways, double step_m, ThinWall& thin) {
  double farthest_m = kLost * step_m;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (ways[i] > 0.0) continue;
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < samples.size() && nearest_m > farthest_m; ++k)
      if (ways[k] > 0.0) nearest_m = std::min(nearest_m, (samples[k].at_m - samples[i].at_m).norm());
    if (!(nearest_m > farthest_m)) continue;
    farthest_m = nearest_m;
    thin.at_m = samples[i].at_m;
    thin.lost = true;
  }
}

// By lines through it.
ThinWall thin_wall(const DistanceGrid& grid, const std::vector<Sample>& samples) {
  std::vector<double> ways;
  std::vector<std::size_t> order(samples.size());
  std::iota(order.begin(), order.end(), 0);
  double all_m2 = 0.0, sum_m2 = 0.0;
  for (const Sample& sample : samples) {
    ways.push_back(way_through(grid, sample));
    all_m2 += sample.area_m2;
  }
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return std::pair(ways[a], a) < std::pair(ways[b], b); });
  std::size_t at = 0;
  while (at + 1 < order.size() && (sum_m2 += samples[order[at]].area_m2) < kThinShare * all_m2) ++at;
  ThinWall thin{0.5 * ways[order[at]] * grid.step_m(), samples[order[at]].at_m};
  find_lost(samples, ways, grid.step_m(), thin);
  return thin;
}

[[noreturn]] void refuse_thin(double step_m, const Departure& off, const Vector3d& at_m) {
  std::ostringstream text;
  text << "has walls too thin or details too fine, as at " << point_text(at_m) << ": where edges are rounded by "
       << step_m << " m, " << 100.0 * off.far_share << " % of its surface are off by a quarter of that, and all by "
       << off.mean * step_m << " m in the mean; make walls at least " << 2.0 * step_m
       << " m thick, leave details out, or choose a smaller rounding_m";
  throw std::invalid_argument(text.str());
}

// As coarse as the surface allows. Says half of the thickness that it found.
DistanceGrid grid_for(const ClosedSurface& surface, double rounding_m, double& half_m) {
  const std::vector<Sample> samples = samples_of(surface);
  double step_m = rounding_m > 0.0 ? rounding_m : largest_m(surface) / kSteps;
  for (;;) {
    const double nodes = DistanceGrid::node_count(surface, step_m);
    if (nodes > static_cast<double>(limits::kDistanceNodes)) refuse_large(step_m, nodes);
    DistanceGrid grid(surface, step_m);
    const Departure off = departure(grid, samples);
    const ThinWall thin = thin_wall(grid, samples);
    half_m = thin.half_m;
    if (off.allowed(rounding_m > 0.0) && half_m >= kLeastHalf * step_m && !thin.lost) return grid;
    const double finer = DistanceGrid::node_count(surface, 0.5 * step_m);
    if (rounding_m > 0.0 || finer > static_cast<double>(limits::kDistanceNodes)) refuse_thin(step_m, off, thin.at_m);
    step_m *= 0.5;
  }
}

bool mostly_flat(const ClosedSurface& surface) {
  const double least_m2 = std::pow(kFlatFace * largest_m(surface), 2);
  double flat_m2 = 0.0, all_m2 = 0.0;
  for (const Vector3d& face_m2 : surface.faces_m2()) {
    const double area_m2 = face_m2.norm();
    all_m2 += area_m2;
    if (area_m2 > least_m2) flat_m2 += area_m2;
  }
  return flat_m2 >= 0.5 * all_m2;
}

double smooth_step(double from, double to, double at) {
  const double share = std::clamp((at - from) / (to - from), 0.0, 1.0);
  return share * share * (3.0 - 2.0 * share);
}

// Its distance to where the spline is zero, by Newton's method for the nearest place and a multiplier; none where that
// does not end, or another place is as near. In steps.
std::optional<Gap> distance_near(const DistanceGrid& grid, const Vector3d& at, const SplineValue& here) {
  constexpr int kMostSteps = 12;
  constexpr double kEnd = 1e-13, kTooClose = 0.1;
  double multiplier = here.value / here.slope.squaredNorm();
  Vector3d place = at - multiplier * here.slope;
  for (int step = 0; step < kMostSteps; ++step) {
    const SplineValue there = grid.spline(grid.within(place));
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
    matrix.topLeftCorner<3, 3>() = Matrix3d::Identity() + multiplier * there.bend;
    matrix.topRightCorner<3, 1>() = there.slope;
    matrix.bottomLeftCorner<1, 3>() = there.slope.transpose();
    Eigen::Vector4d rest;
    rest << place + multiplier * there.slope - at, there.value;
    const Eigen::Vector4d change = matrix.partialPivLu().solve(-rest);
    if (!change.allFinite() || change.head<3>().norm() > 1.0) return std::nullopt;
    place += change.head<3>();
    multiplier += change[3];
    if (change.head<3>().norm() > kEnd && rest.norm() > kEnd) continue;
    const SplineValue last = grid.spline(grid.within(place));
    const double length = last.slope.norm();
    const Vector3d normal = last.slope / length;
    const Matrix3d along = Matrix3d::Identity() - normal * normal.transpose();
    const Matrix3d curvature = along * last.bend * along / length;
    const double gap = multiplier * length;
    const Matrix3d spread = Matrix3d::Identity() + gap * curvature;
    if (!(spread.determinant() > kTooClose)) return std::nullopt;
    return Gap{gap, normal, spread.inverse() * curvature};
  }
  return std::nullopt;
}

// In steps.
Gap gap_by_spline(const DistanceGrid& grid, const Vector3d& at) {
  const SplineValue here = grid.spline(at);
  const double length = here.slope.norm();
  if (length == 0.0) return {here.value, Vector3d::UnitZ(), Matrix3d::Zero()};
  if (std::abs(here.value) < kNear * length)
    if (const std::optional<Gap> near = distance_near(grid, at, here)) return *near;
  const Vector3d normal = here.slope / length;
  const Matrix3d along = Matrix3d::Identity() - normal * normal.transpose();
  const double share = smooth_step(kBlendFrom, kBlendTo, std::abs(here.value));
  const double gap = here.value * ((1.0 - share) / std::max(length, kLeastSlope) + share);
  return {gap, normal, along * here.bend * along / length};
}

std::vector<MeshEdge> long_edges(const ClosedSurface& surface, double step_m, bool& all) {
  std::vector<MeshEdge> edges;
  for (const ClosedSurface::Edge& edge : surface.lines_standing_out()) {
    const Vector3d from_m = surface.vertices_m().col(edge.from), to_m = surface.vertices_m().col(edge.to);
    if ((to_m - from_m).norm() * std::min(1.0, edge.angle_rad()) > step_m)
      edges.push_back({from_m, to_m, edge.normals});
    else
      all = false;
  }
  return edges;
}

// On the way from each corner that stands out to the middle of the circle that touches all sides.
Eigen::Matrix3Xd places_beside_corners_m(const ClosedSurface& surface, double step_m) {
  std::vector<char> stands(static_cast<std::size_t>(surface.vertices_m().cols()), 0);
  for (const int vertex : surface.standing_out()) stands[static_cast<std::size_t>(vertex)] = 1;
  std::vector<Vector3d> places;
  for (Eigen::Index t = 0; t < surface.count(); ++t) {
    const Matrix3d corners_m = surface.corners_m(t);
    const Vector3d opposite_m((corners_m.col(1) - corners_m.col(2)).norm(),
                              (corners_m.col(2) - corners_m.col(0)).norm(),
                              (corners_m.col(0) - corners_m.col(1)).norm());
    const double share = kExactFace * step_m * opposite_m.sum() / (2.0 * surface.area_m2(t));
    if (!(share < 1.0)) continue;
    const Vector3d middle_m = corners_m * opposite_m / opposite_m.sum();
    for (int k = 0; k < 3; ++k)
      if (stands[static_cast<std::size_t>(surface.triangles()(k, t))] != 0)
        places.emplace_back(corners_m.col(k) + share * (middle_m - corners_m.col(k)));
  }
  Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) all.col(static_cast<Eigen::Index>(i)) = places[i];
  return all;
}

void require_few(const Eigen::Matrix3Xi& triangles) {
  if (static_cast<std::size_t>(triangles.cols()) <= limits::kObstacleTriangles) return;
  throw std::invalid_argument("holds " + std::to_string(triangles.cols()) + " triangles, at most " +
                              std::to_string(limits::kObstacleTriangles) +
                              " may bound an obstacle; make its mesh coarser");
}

}  // namespace

MeshSolid::MeshSolid(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles, double rounding_m)
    : surface_((require_few(triangles), vertices_m), triangles),
      grid_(grid_for(surface_, rounding_m, half_thickness_m_)),
      tree_(surface_),
      flat_(mostly_flat(surface_)),
      bounding_radius_m_((vertices_m.colwise() - surface_.centroid_m()).colwise().norm().maxCoeff()),
      deepest_m_(grid_.to_metres(grid_.deepest())),
      corners_m_(vertices_m(Eigen::all, surface_.standing_out())),
      beside_corners_m_(places_beside_corners_m(surface_, grid_.step_m())),
      edges_(long_edges(surface_, grid_.step_m(), edges_are_all_)) {}

// Beyond the grid by how far that is, and by what is left from there on: no more than the distance.
Gap MeshSolid::gap(const Vector3d& point_m) const {
  if (!point_m.allFinite()) return {point_m.sum(), Vector3d::UnitZ(), Matrix3d::Zero()};
  const Vector3d at = grid_.to_steps(point_m), inside = grid_.within(at), beyond = at - inside;
  const std::optional<Gap> far = grid_.far(inside);
  Gap gap = far ? *far : gap_by_spline(grid_, inside);
  const double way = beyond.norm();
  if (way > 0.0) {
    const Vector3d towards = beyond + gap.gap_m * gap.normal;
    gap = {std::hypot(way, gap.gap_m), towards.normalized(), Matrix3d::Zero()};
  }
  const Matrix3d& frame = grid_.frame();
  return {grid_.step_m() * gap.gap_m, frame * gap.normal, frame * gap.hessian * frame.transpose() / grid_.step_m()};
}

double MeshSolid::sharp_gap_m(const Vector3d& point_m) const {
  const NearestTriangle nearest = tree_.nearest(surface_, point_m);
  const Vector3d way_m = point_m - nearest.place.at_m;
  return surface_.outward(nearest.triangle, nearest.place).dot(way_m) < 0.0 ? -nearest.distance_m : nearest.distance_m;
}

Gap MeshSolid::gap_of_ball(const Vector3d& point_m, double radius_m) const {
  const Gap smooth = gap(point_m);
  if (radius_m < grid_.step_m() || smooth.gap_m < kNear * grid_.step_m()) return smooth;
  const NearestTriangle nearest = tree_.nearest(surface_, point_m);
  const Vector3d normal = (point_m - nearest.place.at_m) / nearest.distance_m;
  Matrix3d bend = Matrix3d::Zero();
  if (nearest.place.side >= 0 || nearest.place.corner >= 0)
    bend = (Matrix3d::Identity() - normal * normal.transpose()) / nearest.distance_m;
  if (nearest.place.side >= 0) {
    const Matrix3d corners_m = surface_.corners_m(nearest.triangle);
    const Vector3d along =
        (corners_m.col((nearest.place.side + 1) % 3) - corners_m.col(nearest.place.side)).normalized();
    bend -= along * along.transpose() / nearest.distance_m;
  }
  return {nearest.distance_m, normal, bend};
}

}  // namespace soft_robot_lab
