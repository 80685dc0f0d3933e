// SPDX-License-Identifier: BSD-3-Clause
#include "descent.h"
#include "mechanics/contact/swept_obstacles.h"
#include "free_motion.h"
#include "mechanics/solver_constants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

namespace soft_robot_lab {
namespace {

constexpr double kSlidAway = 0.05;       // of the body's size: a way after which sliding is no settling
constexpr double kBesideSaddle = 0.01;   // of the body's size: a way off a rest state that is not stable
constexpr int kDoublings = 6;            // of that way
constexpr double kAsSoft = 0.02;         // of the stiffness of the stiffest soft mode: as soft as the softest
constexpr double kNearlyLost = 0.3;      // of the stiffness of the rest shape: a shape that is about to give way
constexpr double kNoSide = 1e-3;         // of a way: what it has along the softest motions, so that it leads to no side
constexpr double kShortestConvex = 0.1;  // of the time that a wave takes through the body: a step of the continuation
constexpr double kSlow = 1e-3;           // of the body's size: a step's way after which Newton's method may do the rest
constexpr double kVeryLong = 1e3;        // of a wave's time: inertia has no say any more
constexpr double kLong = 30.0;           // of a wave's time: no shorter step says that the body is slow
constexpr double kFallTolerance = 1e-4;  // of the residual of a step of the continuation;
constexpr double kConvexTolerance = 1e-5;  // of one whose energy is convex: what is soft moves by little
constexpr double kAlike = 0.5;             // of a change of energy: both sides are as easy
const Eigen::Vector3d kFixedSide(1.0, 0.3, 0.1);

NewtonTask rest_task(const SimulationParts& parts) {
  NewtonTask task;
  task.tolerance = parts.options.tolerance;
  task.max_iterations = std::min(parts.options.max_iterations, constants::kStageIterations);
  task.reuse_below = constants::kNearRest;
  return task;
}

// A step of the continuation. In small enough ones its energy is convex, so Newton's method needs no rescue: where it
// would, the step is to be cut first.
NewtonReport fall_for(double h, bool convex, SimulationParts& parts, NewtonState& unknown, SolveReport& report) {
  NewtonTask task = rest_task(parts);
  task.tolerance = std::max(task.tolerance, convex ? kConvexTolerance : kFallTolerance);
  task.min_iterations = 1;
  task.only_through_stable = convex;
  task.inertia_per_s2 = 1.0 / (h * h);
  const Eigen::Matrix3Xd start = parts.state.positions_m;
  task.predicted_m = &start;
  const NewtonReport newton = parts.solve(task, unknown, report);
  return newton.converged || convex ? newton : parts.solve_from_below(task, unknown, report);
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

// What friction alone may hold, and skin that turns its push as it gives way, have no energy that could be judged by.
bool judged_by_energy(const SimulationParts& parts, const NewtonState& found) {
  const ContactTerm& contact = parts.workspace.newton.contact();
  if (contact.free().count() > 0) return false;
  if (!parts.body.touches_itself()) return true;
  const ContactSums sums = contact.sums(found.positions_m, found.contact);
  return std::none_of(sums.touches.begin(), sums.touches.end(),
                      [](const ContactTouch& touch) { return touch.on_skin() && touch.pressure_pa > 0.0; });
}

// Whether a rest state that was found is a minimum of the energy; so is one that cannot be judged by it.
bool is_minimum(SimulationParts& parts, const NewtonState& found) {
  return !judged_by_energy(parts, found) || parts.workspace.newton.minimum_at_rest(found);
}

// On to where what is soft rests too, with a warning where there is none nearby.
void come_closer(SimulationParts& parts, const NewtonTask& task, NewtonState& found, SolveReport& report) {
  const auto of_it = [](const SolveWarning& warning) { return warning.kind == "soft_rest"; };
  report.warnings.erase(std::remove_if(report.warnings.begin(), report.warnings.end(), of_it), report.warnings.end());
  const bool rough = task.tolerance > parts.options.tolerance;
  if (rough || parts.workspace.newton.contact().free().count() > 0) return;
  const double most_m = constants::kAtRest * parts.body.size_m();
  const double left_m = parts.workspace.newton.come_closer(task, most_m, found);
  if (left_m <= most_m) return;
  SolveWarning warning;
  warning.kind = "soft_rest";
  warning.size = left_m;
  warning.unit = "m";
  std::ostringstream text;
  text << "little holds the body at this rest state: at a residual of " << task.tolerance << " a node may still be "
       << left_m << " m off";
  warning.text = text.str();
  add_warning(warning, report.warnings);
}

// Whether Newton's method ended at a stable rest state, which then becomes the state.
RestFound judge(SimulationParts& parts, const NewtonTask& task, const NewtonReport& newton, NewtonState&& found,
                SolveReport& report) {
  if (!newton.converged) return RestFound::none;
  if (!is_minimum(parts, found)) return RestFound::saddle;
  come_closer(parts, task, found, report);
  parts.accept(std::move(found));
  return RestFound::stable;
}

// The part of a motion that leads neither into obstacles nor into other skin.
double free_part(const SimulationParts& parts, const Eigen::Matrix3Xd& motion_m) {
  return part_before_contact(parts.body, parts.workspace.newton.contact(), parts.state.positions_m, motion_m,
                             parts.state.contact);
}

// Without load, contact and commands.
double softest_at_rest_per_s2(SimulationParts& parts) {
  NewtonState rest = parts.unknowns();
  rest.positions_m = parts.body.mesh().nodes_m;
  rest.element_multipliers_pa.setZero();
  rest.constraint_multipliers.setZero();
  rest.contact = parts.workspace.newton.contact().untouched(rest.positions_m, 0.0);
  const SoftModes modes = parts.workspace.newton.soft_modes(rest);
  return modes.stiffness_per_s2.size() > 0 ? modes.stiffness_per_s2[0] : 0.0;
}

// Whether the energy changes alike to both sides of a motion, as where a straight body buckles; where a shape snaps
// through it does not.
bool alike_on_both_sides(SimulationParts& parts, const Eigen::Matrix3Xd& motion_m) {
  const NewtonState here = parts.unknowns();
  const auto rise_j = [&](double side) {
    NewtonState there = here;
    there.positions_m += side * motion_m;
    return parts.workspace.newton.potential_rise_j(NewtonTask{}, here, there);
  };
  const double one_j = rise_j(1.0), other_j = rise_j(-1.0);
  return std::abs(one_j - other_j) < kAlike * std::max(std::abs(one_j), std::abs(other_j));
}

// As far along a motion, bent as the body turns with it, as the energy falls, in doubled ways.
Eigen::Matrix3Xd downhill_along(SimulationParts& parts, const Eigen::Matrix3Xd& motion_m) {
  const NewtonState here = parts.unknowns();
  Eigen::Matrix3Xd best_m = free_part(parts, motion_m) * motion_m;
  double lowest_j = std::numeric_limits<double>::infinity();
  for (int doubling = 0; doubling < kDoublings; ++doubling) {
    NewtonState there = here;
    there.positions_m =
        parts.model->tables().newton->co_rotation().follow(here.positions_m, std::ldexp(1.0, doubling) * motion_m);
    const Eigen::Matrix3Xd way_m = there.positions_m - here.positions_m;
    if (free_part(parts, way_m) < 1.0) break;
    const double rise_j = parts.workspace.newton.potential_rise_j(NewtonTask{}, here, there);
    if (!(rise_j < lowest_j)) break;
    lowest_j = rise_j;
    best_m = way_m;
  }
  return best_m;
}

}  // namespace

bool held_by_friction_alone(const SimulationParts& parts) {
  if (parts.state.contact.anchors_m.cols() == 0) return false;
  return !free_motion(parts.body, parts.state.positions_m, ContactSums()).empty();
}

RestFound relax(SimulationParts& parts, SolveReport& report, const EquilibriumOptions& options, int most_iterations) {
  NewtonState unknown = parts.unknowns();
  NewtonTask task = rest_task(parts);
  task.max_iterations = std::min(parts.options.max_iterations, most_iterations);
  task.tolerance = std::max(task.tolerance, options.tolerance);
  task.only_through_stable = options.only_through_stable;
  const NewtonReport newton = parts.solve(task, unknown, report);
  return judge(parts, task, newton, std::move(unknown), report);
}

RestFound relax_from_below(SimulationParts& parts, SolveReport& report) {
  NewtonState unknown = parts.unknowns();
  const NewtonTask task = rest_task(parts);
  const NewtonReport newton = parts.solve_from_below(task, unknown, report);
  return judge(parts, task, newton, std::move(unknown), report);
}

Nudge nudge_off(SimulationParts& parts, const Eigen::Matrix3Xd& way_m) {
  NewtonSolver& newton = parts.workspace.newton;
  const SoftModes modes = newton.soft_modes(parts.unknowns_at_step());
  if (modes.motions.cols() == 0) return {};
  const Eigen::VectorXd masses_kg = parts.body.node_masses_kg().transpose().replicate<3, 1>().reshaped();
  // A round or square body gives way to all sides alike: all that is as soft counts.
  // Off a saddle only what is unstable leads.
  const double as_soft = modes.stiffness_per_s2[0] + kAsSoft * modes.stiffness_per_s2.cwiseAbs().maxCoeff();
  const double soft = modes.stiffness_per_s2[0] < 0.0 ? std::min(as_soft, 0.0) : as_soft;
  const Eigen::Index count = (modes.stiffness_per_s2.array() <= soft).count();
  const Eigen::VectorXd along = modes.motions.leftCols(count).transpose() * masses_kg.cwiseProduct(as_vector(way_m));
  const double way = std::sqrt(masses_kg.dot(as_vector(way_m).cwiseAbs2()));
  Nudge nudge;
  const bool no_side = along.norm() <= kNoSide * way;
  nudge.unstable = modes.stiffness_per_s2[0] < kNearlyLost * softest_at_rest_per_s2(parts);
  Eigen::VectorXd motion =
      no_side ? Eigen::VectorXd(modes.motions.col(0)) : Eigen::VectorXd(modes.motions.leftCols(count) * along);
  if (no_side) {
    const Eigen::VectorXd moment = masses_kg.cwiseProduct(motion);
    if (moment.reshaped(3, way_m.cols()).rowwise().sum().dot(kFixedSide) < 0.0) motion = -motion;
  }
  motion *= kBesideSaddle * parts.body.size_m() / motion.reshaped(3, way_m.cols()).colwise().norm().maxCoeff();
  nudge.other_side = alike_on_both_sides(parts, motion.reshaped(3, way_m.cols()));
  nudge.motion_m = downhill_along(parts, motion.reshaped(3, way_m.cols()));
  return nudge;
}

bool descend(SimulationParts& parts, SolveReport& report, const Ballooning& ballooning) {
  const Material& material = parts.body.material();
  const double wave_s = parts.body.size_m() * std::sqrt(material.density_kg_m3 / material.youngs_modulus_pa);
  const int limit = report.iterations + constants::kTransientBudget * parts.options.max_iterations;
  double h = 3.0 * wave_s;
  // What pressing skin or friction alone holds is never convex for long.
  bool convex = parts.workspace.newton.contact().free().count() == 0 && !parts.body.touches_itself();
  const double long_s = (convex ? kLong : kVeryLong) * wave_s;
  const Eigen::Vector3d start_m = parts.state.positions_m.rowwise().mean();
  while (report.iterations < limit && h > 1e-3 * wave_s) {
    enter(SolveStage::pseudo_transient, 1, report.path);
    NewtonState unknown = parts.unknowns();
    const NewtonReport newton = fall_for(h, convex, parts, unknown, report);
    if (!newton.converged) {
      h *= convex ? 0.5 : 0.25;
      if (convex && h < kShortestConvex * wave_s) {
        convex = false;
        h = 3.0 * wave_s;
      }
      continue;
    }
    const double moved_m = (unknown.positions_m - parts.state.positions_m).colwise().norm().maxCoeff();
    parts.accept(std::move(unknown));
    const Eigen::Vector3d way_m = parts.state.positions_m.rowwise().mean() - start_m;
    if (way_m.norm() > kSlidAway * parts.body.size_m()) {
      report.message = sliding(parts, way_m);
      if (!report.message.empty()) return false;
    }
    if (std::string text = ballooning.found(parts); !text.empty()) {
      report.message = std::move(text);
      return false;
    }
    const bool slow = !convex || moved_m < kSlow * parts.body.size_m();
    if (slow && h > long_s) {
      if (relax(parts, report, {0.0, h < kVeryLong * wave_s}) == RestFound::stable) return true;
      // Where nothing moves, it is tried once more without any inertia.
      if (moved_m == 0.0 && std::isinf(h)) return false;
      if (moved_m == 0.0) h = std::numeric_limits<double>::infinity();
    }
    h *= newton.iterations <= 5 ? 3.0 : 1.5;
  }
  return false;
}

}  // namespace soft_robot_lab
