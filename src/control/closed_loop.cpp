// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/closed_loop.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "pose_problem.h"
#include "reduced_search.h"

namespace soft_robot_lab {
namespace {

void require(bool good, const char* field, double value, const char* range) {
  if (good) return;
  std::ostringstream text;
  text << field << ": " << value << " is out of range " << range;
  throw std::invalid_argument(text.str());
}

bool positive(double value) { return std::isfinite(value) && value > 0.0; }

}  // namespace

class ClosedLoop::Reduced {
 public:
  // Throws ForwardModelError where it does not serve at the simulation's commands.
  Reduced(const Simulation& simulation, const ReducedChoice& choice, const Pose& pose,
          const std::vector<std::string>& actuators)
      : choice_(choice), places_(*choice.model), model_(choice.model, markers_of(pose), actuators) {
    model_.set_interrupt(simulation.interrupt());
    const std::vector<double> commands = simulation.state().commands();
    if (!model_.knows(commands)) throw ForwardModelError("the reduced model was not trained for these commands");
    model_.start_at(commands);
    double apart_m = 0.0;
    for (int i = 0; i < static_cast<int>(simulation.markers().size()); ++i)
      apart_m = std::max(apart_m, (markers_m().col(i) - simulation.marker_position(i)).norm());
    if (apart_m > choice_.trusted_m()) throw ForwardModelError("the reduced model rests in another shape");
  }

  ReducedForwardModel& model() { return model_; }
  Eigen::Matrix3Xd markers_m() { return places_.places_m(model_.state().at.q); }
  SimulationState full(const SimulationState& base) const { return full_state(*choice_.model, model_.state(), base); }

 private:
  const ReducedChoice& choice_;
  ReducedMarkers places_;  // of all markers
  ReducedForwardModel model_;
};

ClosedLoop::~ClosedLoop() = default;
ClosedLoop::ClosedLoop(ClosedLoop&&) noexcept = default;

void ClosedLoopOptions::validate() const {
  require(gain > 0.0 && gain <= 1.0, "gain", gain, "(0, 1]");
  require(largest_change > 0.0 && largest_change <= 1.0, "largest_change", largest_change, "(0, 1]");
  require(positive(settled_m), "settled_m", settled_m, "(0, inf)");
  require(positive(lost_after_s), "lost_after_s", lost_after_s, "(0, inf)");
  require(positive(error_growth_m), "error_growth_m", error_growth_m, "(0, inf)");
  require(max_corrections >= 1 && max_corrections <= 10000, "max_corrections", max_corrections, "[1, 10000]");
}

ClosedLoop::ClosedLoop(Simulation& model, PolicyTask task, const ClosedLoopOptions& options,
                       const ReducedChoice* reduced)
    : model_(model), task_(std::move(task)), options_(options) {
  options_.validate();
  require_task(model_, task_);
  require(task_.poses.size() == 1, "poses", static_cast<double>(task_.poses.size()), "[1, 1] in closed loop");
  const ReachProblem problem = pose_problem(model_, task_, task_.poses.front());
  actuators_ = problem.names;
  commands_ = problem.start;
  if (!reduced) return;
  try {
    reduced_ = std::make_unique<Reduced>(model_, *reduced, task_.poses.front(), actuators_);
  } catch (const ForwardModelError&) {  // the full one predicts
  }
}

LoopStep ClosedLoop::stop(LoopEnd end, const std::string& reason, std::optional<double> distance_m) const {
  return {end, reason, commands_, distance_m};
}

LoopStep ClosedLoop::correct(double time_s, const MeasuredMarkers& measured, const std::string& fault) {
  const std::optional<double> distance_m = measured_distance_m(measured);
  if (!fault.empty()) return stop(LoopEnd::fault, "fault: " + fault, distance_m);
  if (!measured.empty() || !last_seen_s_) last_seen_s_ = time_s;
  if (time_s - *last_seen_s_ >= options_.lost_after_s) return stop(LoopEnd::tracking_lost, "tracking lost", distance_m);
  if (measured.empty()) return {LoopEnd::none, "", commands_, distance_m};

  if (distance_m) {
    if (nearest_m_ && *distance_m > *nearest_m_ + options_.error_growth_m) {
      std::ostringstream text;
      text << "the error grows: " << 1e3 * *distance_m << " mm after " << 1e3 * *nearest_m_ << " mm";
      return stop(LoopEnd::error_grows, text.str(), distance_m);
    }
    const bool nearer = !nearest_m_ || *distance_m < *nearest_m_ - options_.settled_m;
    idle_corrections_ = nearer ? 0 : idle_corrections_ + 1;
    nearest_m_ = std::min(nearest_m_.value_or(*distance_m), *distance_m);
    if (idle_corrections_ >= 2) return stop(LoopEnd::settled, "settled", distance_m);
  }
  if (corrections_++ == options_.max_corrections)
    return stop(LoopEnd::correction_limit, "correction limit", distance_m);

  std::string why_not;
  const std::optional<Eigen::VectorXd> next = answer(measured, why_not);
  if (!next) return stop(LoopEnd::no_equilibrium, "the model has no answer: " + why_not, distance_m);
  commands_ = *next;
  return {LoopEnd::none, "", commands_, distance_m};
}

std::optional<Eigen::VectorXd> ClosedLoop::answer(const MeasuredMarkers& measured, std::string& why_not) {
  if (reduced_) {
    if (std::optional<Eigen::VectorXd> next = answer_by_one(measured, why_not)) return next;
    leave_reduced();
  }
  return answer_by_one(measured, why_not);
}

std::optional<Eigen::VectorXd> ClosedLoop::answer_by_one(const MeasuredMarkers& measured, std::string& why_not) {
  try {
    update_offsets(measured);
    return next_commands(why_not);
  } catch (const ForwardModelError& error) {
    why_not = error.what();
    return std::nullopt;
  }
}

// The full model goes on where the reduced one is; what that had wrong is in its offsets.
void ClosedLoop::leave_reduced() {
  model_.set_state(reduced_->full(model_.state()));
  reduced_.reset();
  offsets_m_.clear();
}

Eigen::Matrix3Xd ClosedLoop::predicted_m() {
  if (reduced_) {
    reduced_->model().predict(commands_, false);
    return reduced_->markers_m();
  }
  ForwardModel(model_, {}, actuators_).predict(commands_, false);
  Eigen::Matrix3Xd markers_m(3, static_cast<Eigen::Index>(model_.markers().size()));
  for (int i = 0; i < static_cast<int>(markers_m.cols()); ++i) markers_m.col(i) = model_.marker_position(i);
  return markers_m;
}

// The model goes to the robot's commands, where what it expects is compared with what is seen.
void ClosedLoop::update_offsets(const MeasuredMarkers& measured) {
  const Eigen::Matrix3Xd expected_m = predicted_m();
  for (const auto& [name, position_m] : measured) {
    const Eigen::Vector3d seen_m = position_m - expected_m.col(model_.marker_index(name));
    const auto known = offsets_m_.find(name);
    if (known == offsets_m_.end()) {
      offsets_m_[name] = seen_m;
    } else {
      known->second += options_.gain * (seen_m - known->second);
    }
  }
}

// Of a marker that was never seen, the mean of those that were.
Eigen::Vector3d ClosedLoop::offset_of(const std::string& marker) const {
  const auto known = offsets_m_.find(marker);
  if (known != offsets_m_.end()) return known->second;
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  for (const auto& [unused, offset_m] : offsets_m_) sum_m += offset_m;
  return offsets_m_.empty() ? sum_m : Eigen::Vector3d(sum_m / static_cast<double>(offsets_m_.size()));
}

std::optional<double> ClosedLoop::measured_distance_m(const MeasuredMarkers& measured) const {
  double sum_m2 = 0.0, weights = 0.0;
  for (const MarkerGoal& goal : task_.poses.front().goals) {
    const auto seen = measured.find(goal.marker);
    if (seen == measured.end()) return std::nullopt;
    sum_m2 += goal.weight * (seen->second - goal.target_m).squaredNorm();
    weights += goal.weight;
  }
  return std::sqrt(sum_m2 / weights);
}

// Absent where the model has no equilibrium at its present commands.
std::optional<Eigen::VectorXd> ClosedLoop::next_commands(std::string& why_not) {
  const Pose& pose = task_.poses.front();
  if (reduced_)  // bounds of rates go by the present commands
    for (Eigen::Index i = 0; i < commands_.size(); ++i)
      model_.set_command(actuators_[static_cast<size_t>(i)], commands_[i]);
  ReachProblem problem = pose_problem(model_, task_, pose);
  for (size_t k = 0; k < problem.goals.size(); ++k) problem.goals[k].target_m -= offset_of(pose.goals[k].marker);
  for (Eigen::Index i = 0; i < commands_.size(); ++i) {
    const CommandLimits& own =
        model_.actuators()[static_cast<size_t>(model_.actuator_index(actuators_[static_cast<size_t>(i)]))]->limits();
    const double reach = options_.largest_change * (own.max - own.min);
    problem.min[i] = std::max(problem.min[i], commands_[i] - reach);
    problem.max[i] = std::min(problem.max[i], commands_[i] + reach);
  }
  ForwardModel full(model_, markers_of(pose), actuators_);
  const ReachProblem asked = problem;
  reduced_ ? reduced_->model().answer_for(problem) : full.answer_for(problem);
  OptimiserOptions options;
  options.tolerance_m = 0.1 * options_.settled_m;
  const OptimisationSummary summary = optimise(problem, options);
  why_not = summary.stop_reason;
  if (!summary.usable) return std::nullopt;
  if (reduced_) {
    const Prediction found = reduced_->model().predict(summary.commands, false);
    why_not = held_back(asked, problem, summary.commands, found.slack);
    if (!why_not.empty()) return std::nullopt;
  }
  return summary.commands;
}

}  // namespace soft_robot_lab
