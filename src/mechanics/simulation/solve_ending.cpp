// SPDX-License-Identifier: BSD-3-Clause
#include "solve_ending.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "settings/point_text.h"

namespace soft_robot_lab {
namespace {

Eigen::Vector3d center_m(int element, const Body& body) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (int corner = 0; corner < 4; ++corner)
    centre += 0.25 * body.mesh().nodes_m.col(body.mesh().tets(corner, element));
  return centre;
}

SolveWarning inverted(const NewtonReport& newton, const Body& body) {
  SolveWarning warning;
  warning.kind = "inverted_elements";
  warning.size = newton.smallest_determinant;
  std::ostringstream text;
  text << newton.inverted_elements << " inverted elements, the worst element " << newton.worst_element << " ";
  if (newton.worst_element >= 0) {
    warning.rest_position_m = center_m(newton.worst_element, body);
    text << "at rest position " << point_text(*warning.rest_position_m);
  }
  text << ", det F = " << newton.smallest_determinant;
  warning.text = text.str();
  return warning;
}

SolveWarning residual_not_met(const NewtonReport& newton, const Body& body) {
  SolveWarning warning;
  warning.kind = "residual_not_met";
  warning.size = newton.residual;
  std::ostringstream text;
  text << "residual " << newton.residual << ", asked for " << newton.tolerance;
  if (newton.worst_node >= 0) {
    warning.rest_position_m = body.mesh().nodes_m.col(newton.worst_node);
    text << "; the largest force is left at rest position " << point_text(*warning.rest_position_m);
  }
  warning.text = text.str();
  return warning;
}

}  // namespace

void report_end(const NewtonReport& newton, const Body& body, SolveReport& report) {
  report.converged = newton.converged;
  report.residual = newton.residual;
  report.inverted_elements = newton.inverted_elements;
  report.message = newton.reason;
  report.warnings.clear();
  if (!newton.converged) add_warning(residual_not_met(newton, body), report.warnings);
  if (newton.inverted_elements > 0) {
    add_warning(inverted(newton, body), report.warnings);
    report.message += (report.message.empty() ? "" : "; ") + report.warnings.back().text;
  }
}

void report_untangled(int elements, SolveReport& report) {
  SolveWarning warning;
  warning.kind = "untangled";
  warning.size = elements;
  warning.text = std::to_string(elements) + " elements, those inverted before and around them, were laid out anew";
  add_warning(warning, report.warnings);
}

Snap snap_between(const Eigen::Matrix3Xd& before_m, const Eigen::Matrix3Xd& after_m, double share, bool other_side,
                  const Body& body) {
  Snap snap{share, 0.0, Eigen::Vector3d::Zero(), other_side};
  Eigen::Index node = 0;
  snap.moved_m = (after_m - before_m).colwise().norm().maxCoeff(&node);
  snap.rest_position_m = body.mesh().nodes_m.col(node);
  return snap;
}

void note_snap(const Snap& snap, SolveReport& report) {
  SolveWarning warning;
  warning.kind = "snapped";
  warning.size = snap.moved_m;
  warning.unit = "m";
  warning.rest_position_m = snap.rest_position_m;
  std::ostringstream text;
  text << "beyond " << 100.0 * snap.share << " % of the way the shape was unstable; it moved by " << snap.moved_m
       << " m at rest position " << point_text(snap.rest_position_m);
  if (snap.other_side) text << "; the other side is as easy, so there is a rest state too";
  warning.text = text.str();
  add_warning(warning, report.warnings);
}

void report_overlap(const RigidOverlap& overlap, const Body& body, const std::string& help, SolveReport& report) {
  if (!overlap.found()) return;
  SolveWarning warning;
  warning.kind = "rigid_overlap";
  warning.actuator = body.obstacles()[static_cast<std::size_t>(overlap.one)].name;
  warning.size = overlap.depth_m;
  warning.unit = "m";
  warning.text = text_of(overlap, body) + help;
  report.converged = false;
  if (report.message.find(text_of(overlap, body)) == std::string::npos)
    report.message += (report.message.empty() ? "" : "; ") + warning.text;
  add_warning(warning, report.warnings);
}

void report_fast_obstacle(const ObstacleCuts& cuts, double most, const Body& body, double h, SolveReport& report) {
  if (cuts.parts <= most) return;
  SolveWarning warning;
  warning.kind = "fast_obstacle";
  warning.size = cuts.way_m;
  warning.unit = "m";
  std::ostringstream text;
  text << "obstacle '" << body.obstacles()[static_cast<std::size_t>(cuts.obstacle)].name << "' and what it meets move "
       << cuts.way_m << " m against one another in a time step of " << h << " s, which would have to be cut into "
       << cuts.parts << " parts, out of range [1, " << most
       << "]: it may pass through; choose a solver.time_step_s below " << h * most / cuts.parts;
  warning.text = text.str();
  add_warning(warning, report.warnings);
}

}  // namespace soft_robot_lab
