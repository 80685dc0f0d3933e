// SPDX-License-Identifier: BSD-3-Clause
#include "descent.h"
#include "free_motion.h"
#include "mechanics/solver_constants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <sstream>

namespace soft_robot_lab {
namespace {

constexpr double kSlidAway = 0.05;      // of the body's size: a way after which sliding is no settling
constexpr double kBesideSaddle = 0.01;  // of the body's size

NewtonTask rest_task(const SimulationParts& parts) {
  NewtonTask task;
  task.tolerance = parts.options.tolerance;
  task.max_iterations = std::min(parts.options.max_iterations, constants::kStageIterations);
  task.reuse_below = constants::kNearRest;
  return task;
}

NewtonReport fall_for(double h, SimulationParts& parts, NewtonState& unknown, SolveReport& report) {
  NewtonTask task = rest_task(parts);
  task.tolerance = std::max(task.tolerance, 1e-4);
  task.min_iterations = 1;
  task.inertia_per_s2 = 1.0 / (h * h);
  const Eigen::Matrix3Xd start = parts.state.positions_m;
  task.predicted_m = &start;
  const NewtonReport newton = parts.solve(task, unknown, report);
  return newton.converged ? newton : parts.solve_from_below(task, unknown, report);
}

ContactSums touching(const SimulationParts& parts) {
  return parts.workspace.newton.contact().sums(parts.state.positions_m, parts.state.contact);
}

// On what the body slides, and where to, if friction has given way wherever it held the body; else empty.
std::string sliding(const SimulationParts& parts, const Eigen::Vector3d& way_m) {
  ContactSums at = touching(parts);
  std::set<std::string> on;
  for (ContactTouch& touch : at.touches) {
    if (!touch.rubs() || touch.pressure_pa == 0.0 || touch.on_skin()) continue;
    if (!touch.friction.at_limit(touch.away_m)) continue;
    touch.friction.limit_pa = 0.0;
    const int obstacle = touch.pair / parts.workspace.newton.contact().points().count();
    on.insert(parts.body.obstacles()[static_cast<std::size_t>(obstacle)].name);
  }
  if (on.empty() || free_motion(parts.body, parts.state.positions_m, at).empty()) return "";
  std::ostringstream text;
  text << "the body slides on";
  for (const std::string& name : on) text << (name == *on.begin() ? " '" : ", '") << name << "'";
  text << ": friction does not hold it; it goes along (";
  for (int axis = 0; axis < 3; ++axis)
    text << (axis > 0 ? ", " : "") << 0.01 * std::lround(100.0 * way_m[axis] / way_m.norm());
  text << ")";
  return text.str();
}

// A smooth way off a saddle: a random quadratic polynomial of the place, the same in every run.
Eigen::Matrix3Xd nudge(const Eigen::Matrix3Xd& positions_m, double size_m) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> factor(-1.0, 1.0);
  Eigen::Matrix<double, 3, 9> factors;
  for (Eigen::Index i = 0; i < factors.size(); ++i) factors.data()[i] = factor(random);
  const Eigen::Vector3d center_m = positions_m.rowwise().mean();
  Eigen::Matrix3Xd nudged_m(3, positions_m.cols());
  for (Eigen::Index node = 0; node < positions_m.cols(); ++node) {
    const Eigen::Vector3d at = (positions_m.col(node) - center_m) / size_m;
    Eigen::Matrix<double, 9, 1> terms;
    terms << at, at.cwiseAbs2(), at.x() * at.y(), at.y() * at.z(), at.z() * at.x();
    nudged_m.col(node) = kBesideSaddle * size_m * (factors * terms);
  }
  return nudged_m;
}

// On a saddle no force is left, and Newton's method stays there: it starts beside it.
bool leave_saddle(SimulationParts& parts, NewtonTask task, SolveReport& report) {
  Eigen::Matrix3Xd& positions_m = parts.state.positions_m;
  const Eigen::Matrix3Xd way_m = nudge(positions_m, parts.body.size_m());
  positions_m += parts.body.fixed().select(0.0, way_m).matrix();
  NewtonState unknown = parts.unknowns();
  task.min_iterations = 1;
  if (!parts.solve(task, unknown, report).converged) return false;
  parts.accept(std::move(unknown));
  return true;
}

}  // namespace

bool held_by_friction_alone(const SimulationParts& parts) {
  if (parts.state.contact.anchors_m.cols() == 0) return false;
  return !free_motion(parts.body, parts.state.positions_m, ContactSums()).empty();
}

bool within_budget(const SimulationParts& parts, const SolveReport& report) {
  return report.iterations < constants::kEquilibriumBudget * parts.options.max_iterations;
}

bool relax(SimulationParts& parts, SolveReport& report, const EquilibriumOptions& options) {
  NewtonState unknown = parts.unknowns();
  NewtonTask task = rest_task(parts);
  task.tolerance = std::max(task.tolerance, options.tolerance);
  task.only_through_stable = options.only_through_stable;
  const NewtonReport newton = parts.solve(task, unknown, report);
  if (!newton.converged) return false;
  if (newton.iterations == 0 && !parts.workspace.newton.stable_at_rest(unknown)) {
    if (options.only_through_stable) return false;
    return leave_saddle(parts, task, report);
  }
  parts.accept(std::move(unknown));
  return true;
}

bool relax_from_below(SimulationParts& parts, SolveReport& report) {
  NewtonState unknown = parts.unknowns();
  if (!parts.solve_from_below(rest_task(parts), unknown, report).converged) return false;
  parts.accept(std::move(unknown));
  return true;
}

bool descend(SimulationParts& parts, SolveReport& report) {
  const Material& material = parts.body.material();
  const double wave_s = parts.body.size_m() * std::sqrt(material.density_kg_m3 / material.youngs_modulus_pa);
  const int limit = report.iterations + constants::kTransientBudget * parts.options.max_iterations;
  double h = 3.0 * wave_s;
  const Eigen::Vector3d start_m = parts.state.positions_m.rowwise().mean();
  while (report.iterations < limit && h > 1e-3 * wave_s) {
    enter(SolveStage::pseudo_transient, 1, report.path);
    NewtonState unknown = parts.unknowns();
    const NewtonReport newton = fall_for(h, parts, unknown, report);
    if (!newton.converged) {
      h *= 0.25;
      continue;
    }
    const bool moved = unknown.positions_m != parts.state.positions_m;
    parts.accept(std::move(unknown));
    const Eigen::Vector3d way_m = parts.state.positions_m.rowwise().mean() - start_m;
    if (way_m.norm() > kSlidAway * parts.body.size_m()) {
      report.message = sliding(parts, way_m);
      if (!report.message.empty()) return false;
    }
    if (h > 1e3 * wave_s) {
      if (relax(parts, report)) return true;
      // Where nothing moves, it is tried once more without any inertia.
      if (!moved && std::isinf(h)) return false;
      if (!moved) h = std::numeric_limits<double>::infinity();
    }
    h *= newton.iterations <= 5 ? 3.0 : 1.5;
  }
  return false;
}

}  // namespace soft_robot_lab
