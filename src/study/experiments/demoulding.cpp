// SPDX-License-Identifier: BSD-3-Clause
#include "demoulding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "mechanics/mesh/shape_functions.h"
#include "robot/scene/reaction.h"

namespace soft_robot_lab {
namespace {

// Weights of the corners at the points of second order.
constexpr double kFar = 0.1381966011250105, kNear = 0.5854101966249685;

Eigen::Matrix3Xd corners_of(const TetMesh& mesh, const Eigen::Matrix3Xd& positions_m, int tet) {
  Eigen::Matrix3Xd nodes(3, mesh.tets.rows());
  for (Eigen::Index a = 0; a < nodes.cols(); ++a) nodes.col(a) = positions_m.col(mesh.tets(a, tet));
  return nodes;
}

}  // namespace

LargestStretch largest_stretch(const TetMesh& rest, const Eigen::Matrix3Xd& positions_m) {
  const std::array<Eigen::Vector3d, 4> points{
      {{kFar, kFar, kFar}, {kNear, kFar, kFar}, {kFar, kNear, kFar}, {kFar, kFar, kNear}}};
  std::vector<ShapeFunctions> shapes;
  for (const Eigen::Vector3d& point : points)
    shapes.push_back(shape_functions(static_cast<int>(rest.tets.rows()), point));
  LargestStretch largest;
  for (int tet = 0; tet < rest.tet_count(); ++tet) {
    const Eigen::Matrix3Xd before = corners_of(rest, rest.nodes_m, tet), now = corners_of(rest, positions_m, tet);
    for (const ShapeFunctions& shape : shapes) {
      const Eigen::Matrix3d rest_slope = before * shape.gradients.transpose();
      const Eigen::Matrix3d f = now * shape.gradients.transpose() * rest_slope.inverse();
      const double ratio = Eigen::JacobiSVD<Eigen::Matrix3d>(f).singularValues()[0];
      if (ratio > largest.ratio) largest = {ratio, before * shape.values};
    }
  }
  return largest;
}

DemouldingCurve pull_out(Simulation& simulation, const Eigen::Vector3d& direction, double duration_s) {
  const Body& body = simulation.body();
  if (body.holds().size() != 1)
    throw std::invalid_argument("body.fixed: has " + std::to_string(body.holds().size()) +
                                " held regions, must have one: what is pulled");
  const int gripped = body.holds()[0].nodes.front();
  const auto steps = static_cast<long>(std::ceil(duration_s / simulation.options().time_step_s - 1e-6));
  DemouldingCurve curve;
  for (long i = 0; i < steps && curve.converged; ++i) {
    const SolveReport report = simulation.step();
    curve.converged = report.converged && report.inverted_elements == 0;
    const Eigen::Matrix3Xd& positions_m = simulation.state().positions_m;
    const Eigen::Vector3d moved_m = positions_m.col(gripped) - body.mesh().nodes_m.col(gripped);
    const LargestStretch now = largest_stretch(body.mesh(), positions_m);
    curve.travel_m.push_back(direction.dot(moved_m));
    curve.force_n.push_back(direction.dot(total_reaction(simulation, simulation.reaction_forces_n()).force_n));
    curve.stretch.push_back(now.ratio);
    curve.peak_force_n = std::max(curve.peak_force_n, curve.force_n.back());
    if (!curve.converged)
      curve.message = "step " + std::to_string(i + 1) + " of " + std::to_string(steps) + ": " +
                      (report.message.empty() ? "elements are inverted" : report.message);
    if (now.ratio <= curve.largest.ratio) continue;
    curve.largest = now;
    curve.largest_at_m = curve.travel_m.back();
  }
  return curve;
}

}  // namespace soft_robot_lab
