// SPDX-License-Identifier: BSD-3-Clause
// Levenberg-Marquardt with bounds on exact derivatives, for nonlinear least squares of a few variables. Beside targets
// out of reach, where residuals stay large, J^T J alone zigzags through curved valleys; so the second-order part
// sum r grad^2 r is learnt by secants, as in NL2SOL (Dennis, Gay, Welsch 1981, ACM TOMS 7, eqs. 2.9 to 3.1).
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Dense>

#include "search.h"

namespace soft_robot_lab {
namespace {

// A step, or two in a row, that gain less than this share of the tolerance end the search: beside a target out of
// reach steps shrink by a constant factor each, so that stopping at the tolerance itself would leave as much to gain.
constexpr double kSettled = 0.1;

// Of each column's own weight. Two cables that pull against each other have almost opposite columns: an undamped
// first step throws both to their limits, where the way back leads along the slack cable's kink.
constexpr double kFirstDamping = 2.0;
// Of a descent that starts where a slack cable just pulls: more would lead back to where it is slack.
constexpr double kTautDamping = 0.01;
constexpr double kLeastDamping = 1.0e-8;

// Of a command's range, the largest step; a step that failed is followed by one of at most half its size.
constexpr double kLargestStep = 0.25;
constexpr double kSmallestStep = 1.0e-5;
constexpr double kMostDamping = 1.0e8;

struct LocalModel {  // of the objective about the present commands
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;  // J^T J and what the secants add
  Eigen::VectorXd scale;      // of the damping

  double change(const Eigen::VectorXd& step) const { return gradient.dot(step) + 0.5 * step.dot(curvature * step); }
};

LocalModel model_at(const Evaluation& here, const Eigen::MatrixXd& second_order) {
  const Eigen::MatrixXd normal = here.jacobian.transpose() * here.jacobian;
  const Eigen::VectorXd weights = normal.diagonal();
  constexpr double least = 1.0e-6;  // of the largest weight, so that idle commands have one too
  return {here.jacobian.transpose() * here.residuals, normal + second_order,
          weights.cwiseMax(least * weights.maxCoeff())};
}

// The damped step within the bounds: commands that it would push beyond a bound go to that bound, and the others are
// chosen again. Empty where the curvature needs more damping.
Eigen::VectorXd damped_step(const LocalModel& model, double damping, const Eigen::VectorXd& least,
                            const Eigen::VectorXd& most) {
  const Eigen::Index count = model.gradient.size();
  Eigen::MatrixXd curvature = model.curvature;
  curvature.diagonal() += damping * model.scale;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(count);
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < count; ++i) {
    const bool blocked = (model.gradient[i] >= 0.0 && least[i] >= 0.0) || (model.gradient[i] <= 0.0 && most[i] <= 0.0);
    if (!blocked) free.push_back(i);
  }
  while (!free.empty()) {
    const Eigen::VectorXd slope = model.gradient + curvature * step;
    const Eigen::LLT<Eigen::MatrixXd> factor(Eigen::MatrixXd(curvature(free, free)));
    if (factor.info() != Eigen::Success) return {};
    const Eigen::VectorXd move = factor.solve(-slope(free));
    std::vector<Eigen::Index> inside;
    for (size_t k = 0; k < free.size(); ++k) {
      const Eigen::Index i = free[k];
      const double there = move[static_cast<Eigen::Index>(k)];
      if (there < least[i] || there > most[i]) {
        step[i] = std::clamp(there, least[i], most[i]);
      } else {
        inside.push_back(i);
      }
    }
    if (inside.size() == free.size()) {
      for (size_t k = 0; k < free.size(); ++k) step[free[k]] = move[static_cast<Eigen::Index>(k)];
      break;
    }
    free = inside;
  }
  return step;
}

// The damped step in which no command moves by more than `largest` of its range: each kept to it by itself, or where
// that would not lead down, as the columns are alike, all shortened together. Empty where the curvature needs more
// damping.
Eigen::VectorXd short_step(const LocalModel& model, double damping, double largest, const ReachProblem& problem,
                           const Eigen::VectorXd& commands) {
  const Eigen::VectorXd least = problem.min - commands, most = problem.max - commands;
  const Eigen::VectorXd reach = largest * (problem.max - problem.min);
  Eigen::VectorXd step = damped_step(model, damping, least.cwiseMax(-reach), most.cwiseMin(reach));
  if (step.size() == 0 || step.isZero(0.0) || model.change(step) < 0.0) return step;
  step = damped_step(model, damping, least, most);
  return step / std::max(1.0, step.cwiseQuotient(reach).cwiseAbs().maxCoeff());
}

// Dennis, Gay and Welsch's update of the second-order part after a step, sized so that it never remembers more
// curvature than the step has seen.
void learn(const Evaluation& before, const Evaluation& after, Eigen::MatrixXd& second_order) {
  const Eigen::VectorXd step = after.commands - before.commands;
  const Eigen::VectorXd change = (after.jacobian - before.jacobian).transpose() * after.residuals;
  const Eigen::VectorXd slope_change =
      after.jacobian.transpose() * after.residuals - before.jacobian.transpose() * before.residuals;
  const double along = slope_change.dot(step);
  if (!(std::abs(along) > 1.0e-12 * slope_change.norm() * step.norm())) return;
  const double known = step.dot(second_order * step);
  if (known != 0.0) second_order *= std::min(1.0, std::abs(step.dot(change) / known));
  const Eigen::VectorXd missing = change - second_order * step;
  second_order += (missing * slope_change.transpose() + slope_change * missing.transpose()) / along -
                  missing.dot(step) / (along * along) * slope_change * slope_change.transpose();
}

// A descent from some commands.
class Descent {
 public:
  Descent(Search& search, double tolerance_m, double damping, const Eigen::VectorXd& commands)
      : search_(search),
        problem_(search.problem()),
        tolerance_m_(tolerance_m),
        damping_(damping),
        second_order_(Eigen::MatrixXd::Zero(commands.size(), commands.size())) {
    if (const Evaluation* found = search.evaluate(commands, true)) here_ = *found;
  }

  // Why it stopped; converged only where no trial's rough answer says so.
  std::string run(int max_iterations) {
    if (here_.commands.size() == 0) return search_.failure();
    for (;;) {
      const std::string reason = go_down(max_iterations);
      if (reason != kConverged || !make_exact()) return reason;
    }
  }

 private:
  // False where it was exact, or cannot become so.
  bool make_exact() {
    const Evaluation* again = here_.rough ? search_.evaluate(here_.commands, true) : nullptr;
    if (!again) return false;
    here_ = *again;
    small_steps_ = 0;
    return true;
  }

  std::string go_down(int max_iterations) {
    while (here_.residuals.norm() >= tolerance_m_) {
      if (search_.iterations() >= max_iterations) return kIterationLimit;
      const LocalModel model = model_at(here_, second_order_);
      const Eigen::VectorXd step = short_step(model, damping_, largest_, problem_, here_.commands);
      const bool some_way = step.size() > 0;
      if (some_way && step.isZero(0.0)) return kConverged;
      const double promised = some_way ? -model.change(step) : 0.0;
      if (promised <= 0.0) {  // the curvature, or a bound that a command was put to, asks for more damping
        damping_ = std::max(4.0 * damping_, 1.0e-3);
        if (damping_ > kMostDamping) return kConverged;
        continue;
      }
      const double worth_m2 = kSettled * tolerance_m_ * here_.residuals.norm();  // what a step should gain at least
      if (promised < 0.01 * worth_m2) return kConverged;
      try_step(step, promised, worth_m2);
      if (!search_.finish_iteration(here_.commands, here_.distance_m)) return kCancelled;
      if (small_steps_ >= 2 || damping_ > kMostDamping || largest_ < kSmallestStep) return kConverged;
    }
    return kConverged;
  }

  void try_step(const Eigen::VectorXd& step, double promised, double worth_m2) {
    const Eigen::VectorXd next = (here_.commands + step).cwiseMax(problem_.min).cwiseMin(problem_.max);
    const Evaluation* found = search_.try_out(next, false);
    double gained = -promised;
    if (found && found->allowed) {
      const double there_m2 = found->objective_m2();
      if (there_m2 >= here_.objective_m2()) make_exact();  // a short step's is, and may only seem worse
      gained = here_.objective_m2() - there_m2;
    }
    found = gained > 0.0 ? search_.try_out(next, true) : nullptr;
    if (!found) {
      damping_ *= growth_;
      growth_ *= 2.0;
      largest_ = 0.5 * step.cwiseQuotient(problem_.max - problem_.min).cwiseAbs().maxCoeff();
      cut_ = true;
      return;
    }
    learn(here_, *found, second_order_);
    small_steps_ = gained < worth_m2 ? small_steps_ + 1 : 0;
    here_ = *found;
    damping_ =
        std::max(kLeastDamping, damping_ * std::max(1.0 / 5.0, 1.0 - std::pow(2.0 * gained / promised - 1.0, 3)));
    growth_ = 2.0;
    if (gained > 0.5 * promised && !cut_) largest_ = std::min(kLargestStep, 2.0 * largest_);
    cut_ = false;
  }

  Search& search_;
  const ReachProblem& problem_;
  double tolerance_m_, damping_;
  double growth_ = 2.0;            // of the damping, where a step fails
  double largest_ = kLargestStep;  // step
  int small_steps_ = 0;            // in a row, that gained less
  bool cut_ = false;               // the last step failed
  Evaluation here_;                // empty where there is none
  Eigen::MatrixXd second_order_;
};

// Whether the way to the target leads over pulling command i more.
bool asks_for_pull(const Evaluation& here, Eigen::Index i, const ReachProblem& problem) {
  if (here.jacobian.col(i).dot(here.residuals) > 0.0) return true;
  const LocalModel model = model_at(here, Eigen::MatrixXd::Zero(here.commands.size(), here.commands.size()));
  const Eigen::VectorXd step =
      damped_step(model, kTautDamping, problem.min - here.commands, problem.max - here.commands);
  return step.size() > 0 && step[i] < 0.0;
}

// Moves the commands of slack cables to where they just pull, where that leads nearer by the derivatives there; else to
// where the search started, where that is nearer: a body that buckles may be in another shape. False where neither is.
bool tighten(Search& search, const Evaluation& rest, Eigen::VectorXd& commands) {
  constexpr double pull = 2.0e-3;  // of the range, so that rounding does not leave it slack
  const ReachProblem& problem = search.problem();
  const Eigen::VectorXd range = problem.max - problem.min;
  bool tightened = false;
  for (Eigen::Index i = 0; i < rest.prediction.slack.size(); ++i) {
    const double taut = rest.commands[i] - rest.prediction.slack[i] - pull * range[i];
    const bool idle = rest.prediction.marker_jacobian.col(i).isZero(0.0);  // slack, or at its rest length
    if (!idle || taut < problem.min[i]) continue;
    Eigen::VectorXd there = commands;
    there[i] = taut;
    const Evaluation* found = search.evaluate(there, true);
    bool nearer = found && found->allowed && asks_for_pull(*found, i, problem);
    if (!nearer && problem.start[i] < taut) {
      there[i] = problem.start[i];
      found = search.evaluate(there, false);
      nearer = found && found->allowed && found->objective_m2() < rest.objective_m2();
    }
    if (nearer) commands = there;
    tightened = tightened || nearer;
  }
  return tightened;
}

}  // namespace

// The command of a slack cable has no derivative, nor has one at its rest length, though the way to the target may lead
// over pulling it. So a descent is followed by another with such cables taut, as long as that promises to come nearer,
// and does.
std::string search_gauss_newton(Search& search, int max_iterations, double tolerance_m) {
  Eigen::VectorXd commands = search.problem().start;
  double last_m = std::numeric_limits<double>::infinity();
  for (double damping = kFirstDamping;; damping = kTautDamping) {
    const std::string reason = Descent(search, tolerance_m, damping, commands).run(max_iterations);
    const Evaluation* found = search.evaluate(search.best()->commands, true);
    if (!found) return search.failure();
    const Evaluation best = *found;
    const double left_m = best.residuals.norm();
    if (reason != kConverged || left_m < tolerance_m || last_m - left_m < tolerance_m) return reason;
    last_m = left_m;
    commands = best.commands;
    if (!tighten(search, best, commands)) return reason;
  }
}

}  // namespace soft_robot_lab
