// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "actuator_warnings.h"
#include "descent.h"
#include "free_motion.h"
#include "grip.h"
#include "mechanics/body/gap.h"
#include "mechanics/contact/passed_obstacles.h"
#include "rest_path.h"
#include "solve_ending.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

constexpr double kFallAhead = 0.25;  // of the way: just where stability is lost next to nothing drives the shape away
constexpr double kFollows = 1.1;     // times the way of what moves: a node that follows it
constexpr double kObstacleStages = 20;  // past obstacles: where a way ends depends on how it went
constexpr double kFrictionStages = 80;  // past those that rub
constexpr double kSameLever = 1.25;     // times as far in half the way: not a jump, but a lever
constexpr double kLeap = 2.0;           // times as far as the small stage before: past an edge, or to a side
constexpr double kSmallWay = 1e-3;      // of the body's size: no jump
// Commands that pull a body past obstacles: in as many stages, and in ever more until the end stays.
constexpr int kFewStages = 4, kTimesMore = 4, kMostStages = 256;
constexpr double kSameEnd = 2e-4;    // of the body's size
constexpr double kBentWay = 1.5;     // times the straight way of a node past an obstacle: a way that is bent
constexpr int kSlipIterations = 60;  // where points stick and slip by turns
constexpr double kFirstSlip = 2.0;   // of a short way: of a thing that is first touched in a stage, nobody knows when
constexpr double kSafeSlip = 0.9;    // of the longest slip in a stage, for which the next one is planned

void report_unfinished(double done, SolveReport& report) {
  report.converged = false;
  std::ostringstream reached;
  reached << "no equilibrium found beyond " << 100.0 * done << " % of the way, in " << report.iterations
          << " iterations: " << (report.message.empty() ? "work limit" : report.message);
  report.message = reached.str();
}

// What happened on the way.
struct Noted {
  std::vector<Snap> snaps;
  std::vector<SolveWarning> passed;  // obstacles
};

// Walks along a path from one stable rest state to the next, in stages that are cut where one is too far.
class Walk {
 public:
  Walk(SimulationParts& parts, const EquilibriumOptions& options, SolveReport& report)
      : parts_(parts),
        options_(options),
        report_(report),
        path_(parts),
        iterations_before_(report.iterations),
        before_m_(parts.state.positions_m) {}

  // In so many stages at least, all loads in step.
  void go_in_stages(int count);
  // The share of the way that was reached.
  double go();
  const Noted& noted() const { return noted_; }
  int stages() const { return stages_; }

 private:
  // Whether a shorter stage would change less.
  bool cuttable(double share) const {
    return !options_.only_through_stable && path_.changes_in_stages() &&
           0.5 * (share - done_) * constants::kSmallestStage >= 1.0;
  }
  // By what moves, where all else stays.
  bool pressed(double share) const { return cuttable(share) && !path_.changes_loads(); }
  // Of the node that went furthest.
  double way_from_m(const Eigen::Matrix3Xd& from_m) const {
    return (parts_.state.positions_m - from_m).colwise().norm().maxCoeff();
  }
  bool slow_down();
  void begin_slowly(const SimulationState& start);
  bool way_counts(const SimulationState& from) const;
  bool jumped(double share, const Eigen::Matrix3Xd& from_m);
  RestFound relax_at(double share, const Grip& grip);
  bool sticks_at_start(const Grip& grip) const;
  bool slipped_too_fast(double share, const Grip& grip);
  RestFound try_stage(double share);
  Nudge softest_way();
  bool leapt(double share, const Eigen::Matrix3Xd& from_m);
  void note_snap_from(const SimulationState& stable, const Nudge& nudge, double share);
  bool fall_to(double share);
  bool lose_stability(double share);
  bool balloons_before(double share);
  bool go_on_from(double share, RestFound found, double& stage);
  bool go_on_gripping(double end);
  bool go_on_under_loads(double share);  // that come slowly
  std::vector<SolveWarning> passed_since(SimulationState& from, PassedSizes sizes) const;
  bool passes_skin_since(const SimulationState& from) const;
  void note_passed_since(SimulationState& from);
  bool passed_too_fast(double share, const SimulationState& from);
  void advance_to(double share, SimulationState&& from);

  // How far the shape went in the two stages before, as for all of the way [m].
  struct StagesBefore {
    double last_m = 0.0, last_but_one_m = 0.0;
    bool slipped = false;           // in the last one what was gripped stayed behind
    int held_after = -1;            // so many poses it did not
    double longest_for_slip = 1.0;  // stage, in which what is gripped slips by little
  };

  SimulationParts& parts_;
  const EquilibriumOptions& options_;
  SolveReport& report_;
  RestPath path_;
  double done_ = 0.0;
  double longest_ = 1.0;  // stage
  StagesBefore ways_;
  double follows_ = kFollows, lever_before_ = 0.0;
  int iterations_before_;  // the stage that goes on
  int stages_ = 0;         // so far, with those that were begun anew
  bool balloons_ = false;  // a chamber: there is no way on
  bool looked_for_balloons_ = false;
  Eigen::Matrix3Xd before_m_;  // where the stage before began
  Noted noted_;
};

// Obstacles, on the stage from there, which ends here.
std::vector<SolveWarning> Walk::passed_since(SimulationState& from, PassedSizes sizes) const {
  from.contact.time_s = path_.time_s(done_);
  return passed_obstacles(parts_.body, parts_.workspace.newton.contact(), {from.positions_m, from.contact},
                          {parts_.state.positions_m, parts_.state.contact}, sizes);
}

// The same of skin that went through skin.
bool Walk::passes_skin_since(const SimulationState& from) const {
  return parts_.body.touches_itself() &&
         parts_.workspace.newton.contact().skin().passes(from.positions_m, parts_.state.positions_m);
}

// Whether a stage that went through an obstacle, or skin, may be shorter; the state is then that before it.
bool Walk::passed_too_fast(double share, const SimulationState& from) {
  if (options_.only_through_stable || !noted_.snaps.empty()) return false;
  SimulationState here = std::exchange(parts_.state, from);
  if (cuttable(share) || (done_ == 0.0 && path_.bring_loads_slowly())) return true;
  parts_.state = std::move(here);
  return false;
}

void Walk::note_passed_since(SimulationState& from) {
  for (const SolveWarning& warning : passed_since(from, PassedSizes::small)) add_warning(warning, noted_.passed);
}

void Walk::advance_to(double share, SimulationState&& from) {
  const double way_m = way_from_m(from.positions_m);
  ways_.last_but_one_m = std::exchange(ways_.last_m, share > done_ ? way_m / (share - done_) : 0.0);
  done_ = share;
  ++stages_;
  before_m_ = std::move(from.positions_m);
  iterations_before_ = report_.iterations;
}

// Loads come slowly from here on, and past obstacles all but commands goes in small stages. False where that is so
// already.
bool Walk::slow_down() {
  const bool past_obstacles = !parts_.body.obstacles().empty() && !path_.changes_commands() &&
                              parts_.workspace.newton.contact().free().count() == 0;
  const bool shorter = past_obstacles && longest_ == 1.0;
  if (past_obstacles) longest_ = 1.0 / (parts_.state.contact.anchors_m.cols() > 0 ? kFrictionStages : kObstacleStages);
  return path_.bring_loads_slowly() || shorter;
}

// Whether a rest state may be another one at the end of a slower way: past an obstacle, or where it rubs on one.
bool Walk::way_counts(const SimulationState& from) const {
  const ContactState& contact = parts_.state.contact;
  const bool touches = contact.pressures_pa.size() > 0 && contact.pressures_pa.maxCoeff() > 0.0;
  return touches && way_from_m(from.positions_m) > kSmallWay * parts_.body.size_m();
}

// Whether a node went further than what moves takes it along. A jump is as far in half the stage, a lever half as far.
bool Walk::jumped(double share, const Eigen::Matrix3Xd& from_m) {
  const double way_m = way_from_m(from_m);
  const double lever = way_m / (path_.largest_way_m(done_, share) + kSmallWay * parts_.body.size_m());
  if (lever <= follows_) return false;
  if (lever < kSameLever * lever_before_) follows_ = kSameLever * lever;
  lever_before_ = lever;
  return lever > follows_;
}

// Whether a small stage past obstacles led further than those before let expect, and than what moves. Where a body is
// first touched it moves faster too.
bool Walk::leapt(double share, const Eigen::Matrix3Xd& from_m) {
  const bool steady = ways_.last_but_one_m > 0.0 && ways_.last_m < kLeap * ways_.last_but_one_m;
  if (longest_ == 1.0 || !steady) return false;
  const double way_m = way_from_m(from_m);
  const double expected_m = std::max(ways_.last_m * (share - done_), path_.largest_way_m(done_, share));
  return way_m > kLeap * expected_m && way_m > kLeastSnap * parts_.body.size_m();
}

// By Newton, through stable shapes alone where the stage can still be cut. Where that leads through an unstable
// shape, as where a body buckles, it hardly ever converges: the stage is cut before it costs anything. What is gripped
// goes along, or the way is a short one.
RestFound Walk::relax_at(double share, const Grip& grip) {
  const bool carries = grip.carries();
  const bool too_far = carries && !grip.goes_a_short_way() && !options_.only_through_stable;
  if (too_far && (ways_.slipped || !sticks_at_start(grip))) return RestFound::beyond;
  const bool strict = options_.only_through_stable || (cuttable(share) && !pressed(share));
  if (carries && !ways_.slipped) {
    SimulationState from = parts_.state;
    grip.carry(parts_.state);
    path_.go_to(share);
    const RestFound found = relax(parts_, report_, {options_.tolerance, strict}, kSlipIterations);
    if (found == RestFound::stable) return found;
    parts_.state = std::move(from);
    if (too_far) return RestFound::beyond;
  }
  path_.go_to(share);
  const int most = carries ? kSlipIterations : constants::kStageIterations;
  RestFound found = relax(parts_, report_, {options_.tolerance, strict}, most);
  if (pressed(share) && found == RestFound::none && !held_by_friction_alone(parts_))
    found = relax_from_below(parts_, report_);
  if (found == RestFound::stable) ways_.slipped = !grip.took_along(parts_.state);
  return found;
}

// Whether a short stage before showed that friction holds where this one begins. Where all presses as hard on the way
// as at its end, the end shows it.
bool Walk::sticks_at_start(const Grip& grip) const {
  return (grip.moves_alike() && !path_.changes_commands()) || ways_.held_after == path_.poses_before(done_);
}

// Whether a loose thing may have been left behind, as the stage was long.
bool Walk::slipped_too_fast(double share, const Grip& grip) {
  ways_.longest_for_slip = 1.0;
  if (options_.only_through_stable || !grip.has_loose_things()) return false;
  const bool met =
      path_.something_moves() && Grip(parts_, path_.time_s(done_), path_.time_s(share)).rubs_more_than(grip);
  const double slip = met ? kFirstSlip * Grip::kShort : grip.slip(parts_.state);
  ways_.held_after = slip <= Grip::kShort ? path_.poses_before(done_) : -1;
  if (slip > 0.0) ways_.longest_for_slip = kSafeSlip * Grip::kShort / slip * (share - done_);
  if (slip <= Grip::kShort) return false;
  return path_.largest_way_m(done_, share) > Grip::kShort * grip.least_size_m() ||
         (!met && path_.changes_commands() && cuttable(share));
}

// Skin that is pressed by what moves may be unstable on the way to a stable shape; there no node may jump.
RestFound Walk::try_stage(double share) {
  SimulationState from = parts_.state;
  const Grip grip(parts_, path_.time_s(done_), path_.time_s(share));
  const RestFound found = relax_at(share, grip);
  if (found != RestFound::stable) return found;
  if (slipped_too_fast(share, grip)) {
    parts_.state = std::move(from);
    return RestFound::beyond;
  }
  if ((pressed(share) && jumped(share, from.positions_m)) || leapt(share, from.positions_m)) {
    parts_.state = std::move(from);
    return RestFound::saddle;  // it went over one
  }
  if (passes_skin_since(from)) {
    if (passed_too_fast(share, from)) return RestFound::beyond;
    parts_.state = std::move(from);
    return RestFound::saddle;  // it went over one there
  }
  if (!passed_since(from, PassedSizes::any).empty()) {
    if (passed_too_fast(share, from)) return RestFound::beyond;
    note_passed_since(from);
  }
  advance_to(share, std::move(from));
  return found;
}

// Which way the last stable shape gives way. What friction alone holds has no energy that could say.
Nudge Walk::softest_way() {
  path_.go_to(done_);
  if (held_by_friction_alone(parts_) || parts_.workspace.newton.contact().free().count() > 0) return {};
  return nudge_off(parts_, parts_.state.positions_m - before_m_);
}

void Walk::note_snap_from(const SimulationState& stable, const Nudge& nudge, double share) {
  const Snap snap = snap_between(stable.positions_m, parts_.state.positions_m, done_, nudge.other_side, parts_.body);
  if ((nudge.unstable || leapt(share, stable.positions_m)) && snap.moved_m > kLeastSnap * parts_.body.size_m())
    noted_.snaps.push_back(snap);
}

// Down to a stable shape; the state stays where there is none.
bool Walk::fall_to(double share) {
  if (balloons_) return false;
  SimulationState stable = parts_.state;
  const Ballooning ballooning(parts_);
  const Nudge nudge = softest_way();
  path_.go_to(share);
  bool fell = !held_by_friction_alone(parts_) && relax_from_below(parts_, report_) == RestFound::stable;
  if (fell && passes_skin_since(stable)) {
    parts_.state = stable;
    path_.go_to(share);
    fell = false;
  }
  if (!fell && !descend(parts_, report_, ballooning)) {
    balloons_ = !ballooning.found(parts_).empty();
    parts_.state = stable;
    return false;
  }
  note_snap_from(stable, nudge, share);
  note_passed_since(stable);
  advance_to(share, std::move(stable));
  return true;
}

// Where the smallest stage leads to no stable shape nearby: what follows is a motion in time that inertia does not
// drive, from the last stable shape and a small way off it.
bool Walk::lose_stability(double share) {
  if (balloons_) return false;
  SimulationState stable = parts_.state;
  const Ballooning ballooning(parts_);
  const Nudge nudge = softest_way();
  path_.go_to(share);
  if (nudge.motion_m.cols() > 0) parts_.state.positions_m += nudge.motion_m;
  if (!descend(parts_, report_, ballooning)) {
    balloons_ = !ballooning.found(parts_).empty();
    parts_.state = stable;
    return false;
  }
  note_snap_from(stable, nudge, share);
  note_passed_since(stable);
  advance_to(share, std::move(stable));
  return true;
}

// Whether a chamber balloons on the way there; looked at once, where a stage first fails.
bool Walk::balloons_before(double share) {
  if (looked_for_balloons_) return balloons_;
  looked_for_balloons_ = true;
  const Ballooning ballooning(parts_);
  path_.go_to(share);
  const std::string text = ballooning.under_more_gas(parts_, report_);
  balloons_ = !text.empty();
  if (balloons_) report_.message = text;
  return balloons_;
}

// After a stage that found no stable rest state; false where there is no way on.
bool Walk::go_on_from(double share, RestFound found, double& stage) {
  // What comes at once leads to no stable shape: it is to come slowly, so that it chooses the side.
  if (done_ == 0.0 && (found == RestFound::saddle || !path_.changes_loads()) && slow_down()) {
    stage = 1.0;
    return true;
  }
  if (balloons_before(share)) return false;
  if (cuttable(share) && noted_.snaps.empty()) {
    stage = 0.5 * (share - done_);
    enter(SolveStage::halving, 1, report_.path);
    return true;
  }
  stage = 1.0;
  if (path_.loads_come_slowly()) return go_on_under_loads(share);
  if (found == RestFound::saddle && !held_by_friction_alone(parts_)) return lose_stability(share) || fall_to(share);
  // With all that is left a body that is pressed might fold, or slip off what presses it.
  const double end = path_.stage_end(done_, 1.0);
  const bool pushed = parts_.body.touches_itself() || path_.something_moves();
  if (pushed && path_.changes_in_stages() && fall_to(share)) return true;
  if (Grip(parts_, path_.time_s(done_), path_.time_s(end)).carries()) return go_on_gripping(end);
  return fall_to(end) || (!held_by_friction_alone(parts_) && lose_stability(end));
}

// A short stage in which some places slip may fail where a long one does not; that friction holds there is known.
bool Walk::go_on_gripping(double end) {
  if (ways_.held_after == path_.poses_before(done_) && try_stage(end) == RestFound::stable) return true;
  report_.message = "what the body grips slips there; steps in time say where it goes";
  return false;
}

bool Walk::go_on_under_loads(double share) {
  // Pressed skin, or one that rubs: no stability is lost.
  const bool stiff = (path_.something_moves() || longest_ < 1.0) && !softest_way().unstable;
  if (stiff && fall_to(share)) return true;
  const double ahead = path_.stage_end(done_, std::min(1.0, done_ + kFallAhead));
  return lose_stability(ahead) || fall_to(ahead);
}

// From the start once more, where that can be slower.
void Walk::begin_slowly(const SimulationState& start) {
  SimulationState here = std::exchange(parts_.state, start);
  if (!slow_down()) {
    parts_.state = std::move(here);
    return;
  }
  done_ = ways_.last_m = ways_.last_but_one_m = 0.0;
  before_m_ = start.positions_m;
  iterations_before_ = report_.iterations;
  noted_ = {};
}

void Walk::go_in_stages(int count) {
  path_.bring_loads_slowly();
  longest_ = 1.0 / count;
}

double Walk::go() {
  double stage = 1.0;
  bool fast = longest_ == 1.0 && !options_.only_through_stable && !parts_.body.obstacles().empty();
  const SimulationState start = fast ? parts_.state : SimulationState();
  const int patience = constants::kEquilibriumBudget * parts_.options.max_iterations;
  while (done_ < 1.0 && report_.iterations - iterations_before_ < patience) {
    const double from = done_, wanted = std::min(1.0, done_ + std::min(stage, longest_));
    const double share = path_.stage_end(done_, wanted);
    const RestFound found = try_stage(share);
    if (found == RestFound::stable && fast && way_counts(start)) {
      fast = false;
      begin_slowly(start);
    } else if (found == RestFound::stable) {
      if (share == wanted) stage = std::max(stage, 2.0 * (share - from));
      stage = std::min(stage, ways_.longest_for_slip);
    } else if (found == RestFound::beyond) {
      stage = 0.5 * (share - from);
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

// Whether skin that went from one place to another may have met an obstacle that moved meanwhile.
bool may_have_met(const Obstacle& obstacle, const Eigen::Matrix3Xd& from_m, double from_s, const Eigen::Matrix3Xd& to_m,
                  double to_s) {
  const Eigen::Isometry3d start = pose_at(obstacle, from_s), end = pose_at(obstacle, to_s);
  for (Eigen::Index node = 0; node < from_m.cols(); ++node) {
    const double way_m = (end.inverse() * to_m.col(node) - start.inverse() * from_m.col(node)).norm();
    const double gaps_m =
        gap_to(obstacle.shape, start, from_m.col(node)).gap_m + gap_to(obstacle.shape, end, to_m.col(node)).gap_m;
    if (gaps_m < kBentWay * way_m) return true;
  }
  return false;
}

bool may_have_met_obstacles(const SimulationParts& parts, const SimulationState& from) {
  const auto& obstacles = parts.body.obstacles();
  return std::any_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& obstacle) {
    return may_have_met(obstacle, from.positions_m, from.contact.time_s, parts.state.positions_m,
                        parts.state.contact.time_s);
  });
}

// Whether commands moved the body past obstacles, so that its end may depend on the way.
bool went_past_obstacles(const SimulationParts& parts, const SimulationState& from) {
  const auto& obstacles = parts.body.obstacles();
  if (obstacles.empty() || parts.workspace.newton.contact().free().count() > 0) return false;
  const Eigen::Matrix3Xd& to_m = parts.state.positions_m;
  const double way_m = (to_m - from.positions_m).colwise().norm().maxCoeff();
  if (from.actuated_commands() == from.commands() || way_m <= kSmallWay * parts.body.size_m()) return false;
  return may_have_met_obstacles(parts, from);
}

struct Reached {
  double share;  // of the way
  int stages;
  Noted noted;
};

// From the state as it is; in so many stages at least.
Reached walk_along(SimulationParts& parts, const EquilibriumOptions& options, int stages, SolveReport& report) {
  Walk walk(parts, options, report);
  if (stages > 1) walk.go_in_stages(stages);
  const double share = walk.go();
  return {share, walk.stages(), walk.noted()};
}

// Until the end stays where it is. What friction holds, and on which side of an obstacle a body ends, hangs on the way.
Reached walk_in_shorter_stages(SimulationParts& parts, const SimulationState& start, const EquilibriumOptions& options,
                               Reached reached, SolveReport& report) {
  for (int stages = kFewStages; stages <= kMostStages; stages *= kTimesMore) {
    const Eigen::Matrix3Xd end_m = parts.state.positions_m;
    parts.state = start;
    Reached finer = walk_along(parts, options, stages, report);
    const double apart_m = (parts.state.positions_m - end_m).colwise().norm().maxCoeff();
    const bool same = reached.share == 1.0 && finer.share == 1.0 &&
                      finer.stages > reached.stages + reached.stages / 2 && apart_m <= kSameEnd * parts.body.size_m();
    reached = std::move(finer);
    if (same) break;
  }
  return reached;
}

void seek_equilibrium(SimulationParts& parts, const EquilibriumOptions& options, SolveReport& report) {
  if (parts.workspace.newton.energies().sums_at(parts.state.positions_m).inverted > 0) start_from_rest_shape(parts);
  SimulationState start;
  if (!parts.body.obstacles().empty()) start = parts.state;
  Reached reached = walk_along(parts, options, 1, report);
  if (!options.only_through_stable && reached.share == 1.0 && went_past_obstacles(parts, start))
    reached = walk_in_shorter_stages(parts, start, options, std::move(reached), report);
  if (reached.share < 1.0) report_unfinished(reached.share, report);
  for (const Snap& snap : reached.noted.snaps) note_snap(snap, report);
  for (const SolveWarning& passed : reached.noted.passed) add_warning(passed, report.warnings);
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

// Skin may come so deep into skin that contact knows nothing of it any more.
void refuse_skin_in_skin(const SimulationParts& parts, SolveReport& report) {
  if (!parts.body.touches_itself()) return;
  TetMesh present = parts.body.mesh();
  present.nodes_m = parts.state.positions_m;
  const auto inside = parts.model->tables().skin_overlap.deepest_in_spite_of_contact(parts.body, present);
  if (!inside) return;
  report.converged = false;
  report.message = inside->text + "; let steps in time bring it there";
  add_warning(*inside, report.warnings);
}

void refuse_impossible_actuators(const SimulationParts& parts, SolveReport& report) {
  for (std::size_t i = 0; i < parts.actuators.size(); ++i) {
    const std::vector<SolveWarning> warnings = actuator_warnings(parts.reading_of(i), parts.body);
    if (!refuse_impossible(warnings, report)) continue;
    for (const SolveWarning& warning : warnings) add_warning(warning, report.warnings);
  }
}

}  // namespace

bool may_have_met(const SimulationParts& parts, const SimulationState& from) {
  if (may_have_met_obstacles(parts, from)) return true;
  if (!parts.body.touches_itself()) return false;
  const SkinContact& skin = parts.workspace.newton.contact().skin();
  return skin.first_length(from.positions_m, parts.state.positions_m - from.positions_m) < 1.0;
}

void find_equilibrium(SimulationParts& parts, const EquilibriumOptions& options, SolveReport& report) {
  const SimulationState start = parts.state;
  seek_equilibrium(parts, options, report);
  note_free_motions(parts, report);
  if (report.converged) refuse_impossible_actuators(parts, report);
  if (report.converged)
    report_overlap(overlap_at(parts.body, parts.workspace.newton.contact(), parts.state.contact), parts.body,
                   "; let steps in time bring it there", report);
  if (report.converged) refuse_skin_in_skin(parts, report);
  if (!report.converged) parts.state = start;
}

}  // namespace soft_robot_lab
