// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium.h"

#include <algorithm>
#include <sstream>

#include "actuator_warnings.h"
#include "descent.h"
#include "free_motion.h"
#include "rest_path.h"
#include "solve_ending.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

constexpr double kFallAhead = 0.25;  // of the way: just where stability is lost next to nothing drives the shape away

void report_unfinished(double done, SolveReport& report) {
  report.converged = false;
  std::ostringstream reached;
  reached << "no equilibrium found beyond " << 100.0 * done << " % of the way, in " << report.iterations
          << " iterations: " << (report.message.empty() ? "work limit" : report.message);
  report.message = reached.str();
}

// Walks along a path from one stable rest state to the next, in stages that are cut where one is too far.
class Walk {
 public:
  Walk(SimulationParts& parts, const EquilibriumOptions& options, SolveReport& report)
      : parts_(parts), options_(options), report_(report), path_(parts), before_m_(parts.state.positions_m) {}

  // The share of the way that was reached.
  double go();
  const std::vector<Snap>& snaps() const { return snaps_; }

 private:
  // Whether a shorter stage would change less.
  bool cuttable(double share) const {
    return !options_.only_through_stable && path_.changes_in_stages() &&
           0.5 * (share - done_) * constants::kSmallestStage >= 1.0;
  }
  RestFound try_stage(double share);
  bool fall_to(double share);
  bool lose_stability(double share);
  bool go_on_from(double share, RestFound found, double& stage);
  void advance_to(double share, Eigen::Matrix3Xd&& from_m);

  SimulationParts& parts_;
  const EquilibriumOptions& options_;
  SolveReport& report_;
  RestPath path_;
  double done_ = 0.0;
  int iterations_before_ = 0;  // the stage that goes on
  Eigen::Matrix3Xd before_m_;  // where the stage before began
  std::vector<Snap> snaps_;
};

void Walk::advance_to(double share, Eigen::Matrix3Xd&& from_m) {
  done_ = share;
  before_m_ = std::move(from_m);
  iterations_before_ = report_.iterations;
}

// By Newton, through stable shapes alone where the stage can still be cut. Where that leads through an unstable
// shape, as where a body buckles, it hardly ever converges: the stage is cut before it costs anything.
RestFound Walk::try_stage(double share) {
  Eigen::Matrix3Xd from_m = parts_.state.positions_m;
  path_.go_to(share);
  const bool strict = options_.only_through_stable || cuttable(share);
  const RestFound found = relax(parts_, report_, {options_.tolerance, strict});
  if (found == RestFound::stable) advance_to(share, std::move(from_m));
  return found;
}

// Down to a stable shape; the state stays where there is none.
bool Walk::fall_to(double share) {
  const SimulationState start = parts_.state;
  path_.go_to(share);
  const bool rubs = held_by_friction_alone(parts_);
  if ((!rubs && relax_from_below(parts_, report_) == RestFound::stable) || descend(parts_, report_)) {
    advance_to(share, Eigen::Matrix3Xd(start.positions_m));
    return true;
  }
  parts_.state = start;
  return false;
}

// Where the smallest stage leads to no stable shape nearby: what follows is a motion in time that inertia does not
// drive, from the last stable shape and a small way off it.
bool Walk::lose_stability(double share) {
  const SimulationState stable = parts_.state;
  path_.go_to(done_);
  const bool pushed = !held_by_friction_alone(parts_) && parts_.workspace.newton.contact().free().count() == 0;
  Nudge nudge;
  if (pushed) nudge = nudge_off(parts_, stable.positions_m - before_m_);
  path_.go_to(share);
  if (nudge.motion_m.cols() > 0) parts_.state.positions_m += nudge.motion_m;
  if (!descend(parts_, report_)) {
    parts_.state = stable;
    return false;
  }
  const Snap snap = snap_between(stable.positions_m, parts_.state.positions_m, done_, nudge.other_side, parts_.body);
  if (nudge.unstable && snap.moved_m > kLeastSnap * parts_.body.size_m()) snaps_.push_back(snap);
  advance_to(share, Eigen::Matrix3Xd(stable.positions_m));
  return true;
}

// After a stage that found no stable rest state; false where there is no way on.
bool Walk::go_on_from(double share, RestFound found, double& stage) {
  // A saddle was reached by what came at once: it is to come slowly, so that it chooses the side.
  if (found == RestFound::saddle && done_ == 0.0 && path_.bring_loads_slowly()) {
    stage = 1.0;
    return true;
  }
  if (cuttable(share) && snaps_.empty()) {
    stage = 0.5 * (share - done_);
    enter(SolveStage::halving, 1, report_.path);
    return true;
  }
  stage = 1.0;
  if (path_.loads_come_slowly()) return lose_stability(path_.stage_end(done_, std::min(1.0, done_ + kFallAhead)));
  if (found == RestFound::saddle && !held_by_friction_alone(parts_)) return lose_stability(share) || fall_to(share);
  // With all that is left a body that touches itself might fold.
  const double end = path_.stage_end(done_, 1.0);
  if (parts_.body.touches_itself() && path_.changes_in_stages() && fall_to(share)) return true;
  return fall_to(end) || (!held_by_friction_alone(parts_) && lose_stability(end));
}

double Walk::go() {
  double stage = 1.0;
  const int patience = constants::kEquilibriumBudget * parts_.options.max_iterations;
  while (done_ < 1.0 && report_.iterations - iterations_before_ < patience) {
    const double from = done_, wanted = std::min(1.0, done_ + stage), share = path_.stage_end(done_, wanted);
    const RestFound found = try_stage(share);
    if (found == RestFound::stable) {
      if (share == wanted) stage = std::max(stage, 2.0 * (share - from));
    } else if (options_.only_through_stable || !go_on_from(share, found, stage)) {
      break;
    }
  }
  return done_;
}

// A shape with inverted elements is no start to follow commands from: it may be a knot that holds itself.
void start_from_rest_shape(SimulationParts& parts) {
  parts.state.positions_m = parts.body.mesh().nodes_m;
  parts.state.element_multipliers_pa.setZero();
  parts.state.constraint_multipliers.setZero();
  parts.state.contact = parts.workspace.newton.contact().untouched(parts.state.positions_m, 0.0);
  for (std::size_t i = 0; i < parts.actuators.size(); ++i) {
    const double command = parts.state.drives[i].command;
    parts.state.drives[i] = parts.actuators[i]->rest_state();  // its memory is of that shape too
    parts.state.drives[i].command = command;
  }
  parts.begin_step();
}

void seek_equilibrium(SimulationParts& parts, const EquilibriumOptions& options, SolveReport& report) {
  if (parts.workspace.newton.inverted_elements(parts.state.positions_m) > 0) start_from_rest_shape(parts);
  Walk walk(parts, options, report);
  const double done = walk.go();
  if (done < 1.0) report_unfinished(done, report);
  for (const Snap& snap : walk.snaps()) note_snap(snap, report);
}

void note_free_motion(const std::string& of, const std::string& free, SolveReport& report) {
  if (free.empty()) return;
  SolveWarning warning;
  warning.kind = "free_motion";
  warning.text = "nothing keeps " + of + " from " + free;
  if (!report.converged) report.message += (report.message.empty() ? "" : "; ") + warning.text;
  add_warning(warning, report.warnings);
}

// A body that may move as a whole has many equilibria, or none; so has a free obstacle.
void note_free_motions(SimulationParts& parts, SolveReport& report) {
  const ContactTerm& contact = parts.workspace.newton.contact();
  const ContactSums touching = contact.sums(parts.state.positions_m, parts.state.contact);
  note_free_motion("the body", free_motion(parts.body, parts.state.positions_m, touching), report);
  for (int i = 0; i < contact.free().count(); ++i)
    note_free_motion(
        "obstacle '" + parts.body.obstacles()[static_cast<std::size_t>(contact.free().obstacle(i))].name + "'",
        free_motion(contact, i, touching), report);
}

void refuse_impossible_actuators(const SimulationParts& parts, SolveReport& report) {
  for (std::size_t i = 0; i < parts.actuators.size(); ++i) {
    const std::vector<SolveWarning> warnings = actuator_warnings(parts.reading_of(i), parts.body);
    if (!refuse_impossible(warnings, report)) continue;
    for (const SolveWarning& warning : warnings) add_warning(warning, report.warnings);
  }
}

}  // namespace

void find_equilibrium(SimulationParts& parts, const EquilibriumOptions& options, SolveReport& report) {
  const SimulationState start = parts.state;
  seek_equilibrium(parts, options, report);
  note_free_motions(parts, report);
  if (report.converged) refuse_impossible_actuators(parts, report);
  if (!report.converged) parts.state = start;
}

}  // namespace soft_robot_lab
