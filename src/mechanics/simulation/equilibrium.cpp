// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium.h"

#include <algorithm>
#include <sstream>

#include "descent.h"
#include "free_motion.h"
#include "solve_ending.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

void tell_unfinished(double done, SolveReport& report) {
  report.converged = false;
  std::ostringstream reached;
  reached << "no equilibrium found beyond " << 100.0 * done << " % of the command change, in " << report.iterations
          << " iterations: " << (report.message.empty() ? "work limit" : report.message);
  report.message = reached.str();
}

// Where a search for an equilibrium starts; it goes on to the commands, and the last pose of the obstacles.
struct Start {
  std::vector<double> commands;
  double obstacles_s;

  explicit Start(const SimulationParts& parts)
      : commands(parts.state.actuated_commands()), obstacles_s(parts.state.contact.time_s) {}
  void move(SimulationParts& parts, double fraction) const {
    parts.place_actuators(commands, parts.state.commands(), fraction);
    const double end_s = this->end_s(parts);
    parts.state.contact.time_s = fraction == 1.0 ? end_s : obstacles_s + fraction * (end_s - obstacles_s);
  }
  // Whether there is a way to go in stages; to loads alone there is none.
  bool moves_anything(const SimulationParts& parts) const {
    return commands != parts.state.commands() || obstacles_s != end_s(parts);
  }

 private:
  static double end_s(const SimulationParts& parts) {
    return std::max(parts.workspace.newton.contact().end_of_motion_s(), parts.body.end_of_hold_motion_s());
  }
};

// Down to a stable shape at these commands.
bool fall(SimulationParts& parts, SolveReport& report) {
  return relax_from_below(parts, report) || descend(parts, report);
}

// By Newton, in stages of the command change where one is too far; the share of it that was reached. A stage whose way
// leads through an unstable shape, as where a body buckles, hardly ever converges: it is cut before it costs anything.
// Skin that may touch goes through such shapes in the smallest stages too: a fall with the whole change lets joints
// fold, or press so hard into one another that no way leads on.
double follow_commands(SimulationParts& parts, const Start& from, const EquilibriumOptions& options,
                       SolveReport& report) {
  const bool may_fall = parts.body.touches_itself() && !options.only_through_stable && !held_by_friction_alone(parts);
  double done = 0.0, stage = 1.0;
  while (done < 1.0 && stage * constants::kSmallestStage >= 1.0 && within_budget(parts, report)) {
    const double fraction = std::min(1.0, done + stage);
    from.move(parts, fraction);
    const bool cuttable =
        parts.state.actuated_commands() != from.commands && 0.5 * stage * constants::kSmallestStage >= 1.0;
    bool found = relax(parts, report, {options.tolerance, options.only_through_stable || cuttable});
    if (!found && !cuttable && may_fall) found = fall(parts, report);
    if (found) done = fraction;
    if (options.only_through_stable || (!found && !from.moves_anything(parts))) break;
    stage *= found ? 2.0 : 0.5;
    if (!found && stage * constants::kSmallestStage >= 1.0) enter(SolveStage::halving, 1, report.path);
  }
  return done;
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
  const Start from(parts);
  const double done = follow_commands(parts, from, options, report);
  if (done == 1.0) return;
  from.move(parts, 1.0);
  if (!options.only_through_stable && held_by_friction_alone(parts)) {
    if (descend(parts, report)) return;
    tell_unfinished(done, report);
    return;
  }
  if (!options.only_through_stable && fall(parts, report)) return;
  tell_unfinished(done, report);
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

// Where a body buckled it could have gone another way.
void note_buckling(SolveReport& report) {
  const auto unstable = [](const SolvePathStage& stage) {
    return stage.stage == SolveStage::convexify || stage.stage == SolveStage::energy_descent ||
           stage.stage == SolveStage::pseudo_transient;
  };
  if (!report.converged || std::none_of(report.path.begin(), report.path.end(), unstable)) return;
  SolveWarning warning;
  warning.kind = "unstable_on_the_way";
  for (const SolvePathStage& stage : report.path)
    if (unstable(stage)) warning.size += stage.count;
  std::ostringstream text;
  text << "the way to this rest state led through unstable shapes in " << warning.size << " of " << report.iterations
       << " iterations: the body buckled or snapped, and may have another rest state";
  warning.text = text.str();
  add_warning(warning, report.warnings);
}

}  // namespace

void find_equilibrium(SimulationParts& parts, const EquilibriumOptions& options, SolveReport& report) {
  seek_equilibrium(parts, options, report);
  note_free_motions(parts, report);
  note_buckling(report);
}

}  // namespace soft_robot_lab
