// SPDX-License-Identifier: BSD-3-Clause
#include "air_spans.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <Eigen/LU>

#include "mechanics/mesh/element_crossings.h"
#include "mechanics/mesh/skin.h"
#include "settings/point_text.h"

namespace soft_robot_lab {
namespace {

constexpr double kInAir = 0.01;        // of a span: less air than this is none
constexpr double kOfSpan = 0.1;        // of a span: more silicone than at rest
constexpr double kOfEdge = 0.25;       // of an element's edge: the same
constexpr double kDepthOfEdge = 0.05;  // of an element's edge
constexpr int kSamples = 8;            // of a way through an element

struct Inside {
  double length_m = 0.0;
  std::vector<ElementCrossing> crossings;
};

// How much of a straight line lies in elements; where these overlap it counts once.
Inside inside(const TetMesh& mesh, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m) {
  Inside found{0.0, element_crossings(mesh, from_m, to_m)};
  double share = 0.0, reached = 0.0;
  for (const ElementCrossing& crossing : found.crossings) {
    share += std::max(0.0, crossing.to - std::max(reached, crossing.from));
    reached = std::max(reached, crossing.to);
  }
  found.length_m = share * (to_m - from_m).norm();
  return found;
}

struct Deepest {
  double depth_m = 0.0, edge_m = 0.0;
  Eigen::Vector3d rest_m = Eigen::Vector3d::Zero();
};

Eigen::Vector3d at_rest(const TetMesh& mesh, const TetMesh& present, int tet, const Eigen::Vector3d& at_m) {
  Eigen::Matrix4d now;
  now << corners_of(present, tet), Eigen::RowVector4d::Ones();
  return corners_of(mesh, tet) * now.partialPivLu().solve(at_m.homogeneous());
}

Deepest deepest_place(const TetMesh& mesh, const TetMesh& present, const std::vector<ElementCrossing>& crossings,
                      const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m) {
  Deepest deepest;
  for (const ElementCrossing& crossing : crossings) {
    for (int i = 0; i < kSamples; ++i) {
      const double share = crossing.from + (i + 0.5) / kSamples * (crossing.to - crossing.from);
      const Eigen::Vector3d at_m = from_m + share * (to_m - from_m);
      const double depth_m = nearest_on_skin(present, at_m).distance_m;
      if (depth_m <= deepest.depth_m) continue;
      deepest = {depth_m, edge_m(mesh, crossing.tet), at_rest(mesh, present, crossing.tet, at_m)};
    }
  }
  return deepest;
}

SolveWarning warning_of(const std::string& name, std::size_t after, double more_m, const Deepest& deepest) {
  SolveWarning warning;
  warning.kind = "cable_in_silicone";
  warning.actuator = name;
  warning.size = deepest.depth_m;
  warning.unit = "m";
  warning.rest_position_m = deepest.rest_m;
  std::ostringstream text;
  text << "actuator " << name << ": after its point " << after << " it is in the air at rest, and here " << more_m
       << " m of it are in silicone, " << deepest.depth_m << " m below the skin at rest position "
       << point_text(deepest.rest_m) << ": it is straight from point to point and feels no skin, so set more points";
  warning.text = text.str();
  return warning;
}

}  // namespace

AirSpans::AirSpans(const Body& body, const std::vector<std::unique_ptr<const Actuator>>& actuators) {
  for (const auto& actuator : actuators) {
    const std::vector<double> none(actuator->constraints().size(), 0.0);
    const std::vector<Eigen::Vector3d> path_m =
        actuator->observe(body.mesh().nodes_m, none, actuator->rest_state()).path_m;
    Route route{actuator->name(), path_m.size(), {}};
    for (std::size_t i = 0; i + 1 < path_m.size(); ++i) {
      const double length_m = (path_m[i + 1] - path_m[i]).norm();
      const double inside_m = inside(body.mesh(), path_m[i], path_m[i + 1]).length_m;
      if (inside_m < (1.0 - kInAir) * length_m) route.spans.push_back({i, length_m, inside_m});
    }
    routes_.push_back(std::move(route));
  }
}

std::vector<SolveWarning> AirSpans::in_silicone(const TetMesh& mesh, const TetMesh& present,
                                                const std::vector<std::vector<Eigen::Vector3d>>& paths_m) const {
  std::vector<SolveWarning> warnings;
  for (std::size_t a = 0; a < routes_.size(); ++a) {
    const Route& route = routes_[a];
    if (route.spans.empty() || paths_m[a].size() != route.point_count) continue;
    for (const Span& span : route.spans) {
      const Eigen::Vector3d &from_m = paths_m[a][span.first], &to_m = paths_m[a][span.first + 1];
      const double length_m = (to_m - from_m).norm();
      const Inside found = inside(present, from_m, to_m);
      const double more_m = found.length_m - span.inside_m * std::max(1.0, length_m / span.length_m);
      if (more_m <= kOfSpan * length_m) continue;
      const Deepest deepest = deepest_place(mesh, present, found.crossings, from_m, to_m);
      if (more_m <= kOfEdge * deepest.edge_m || deepest.depth_m <= kDepthOfEdge * deepest.edge_m) continue;
      add_warning(warning_of(route.name, span.first, more_m, deepest), warnings);
    }
  }
  return warnings;
}

}  // namespace soft_robot_lab
