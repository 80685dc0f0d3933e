// SPDX-License-Identifier: BSD-3-Clause
// Two PID controllers on the model, which count time in iterations.
//
// `pid` as published (7.12 to 7.16), in position form, the commands after iteration t, on O = 1/2 |y - x|^2 in m^2:
//   alpha_k = start_k + u_k,
//   u_k = Kp O(t) + Ki t/6 (O(0) + 4 O(t/2) + O(t)) + Kd (y - x) . (x(alpha) - x(alpha - Delta_k)) / |Delta_k|.
// Half way of an odd t, O(t/2) is the mean of the two iterations beside it. Commands are clipped to their bounds; of
// several goals, and with effort, (y - x) are all of the search's residuals. Nothing but the iteration limit stops it.
// Proportional and integral part are about 1e-4 of a command and never negative: they push the same way on either side
// of the target. What steers is the derivative part, and by it the commands are not changed but set: to
// start + Kd J^T (y - x). Near a target that is a fixed point only where Kd |J|^2, J^T J's largest eigenvalue, is below
// 1; above it the commands swing from bound to bound, and below it they come to rest short of the target.
//
// `pid_projected`, the one that is meant to be used, adds its output to the commands, once an iteration:
//   commands += kp e + ki (integral of e over the iterations, by Simpson's rule) + kd (e - last e)
// with an error in commands, e = J^+ (y - x), of the model's Jacobian at every iterate and the damped pseudo-inverse
// J^+. Its gains are chosen so: with J right, e shrinks by 1 - kp an iteration; ki and kd are small beside kp, the
// integral for what the Jacobian gets wrong, the derivative against overshoot in curved valleys. The integral rests
// while a command is at its limit, and a step is at most kLargestPidStep of the command's range.
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Dense>

#include "search.h"

namespace soft_robot_lab {
namespace {

struct Gains {
  double proportional, integral, derivative;
};
constexpr Gains kPublished{0.05, 0.00075, 150.0};  // [command per m^2], the integral's also per iteration
constexpr Gains kProjected{0.4, 0.01, 0.1};        // [1], over iterations

constexpr double kDamping = 0.01;          // of the pseudo-inverse, relative to the largest diagonal entry of J^T J
constexpr double kLargestPidStep = 0.025;  // of the command's range
constexpr double kSettledStep = 1.0e-6;    // of the command's range

// Simpson's rule over equally spaced values, one iteration apart; an interval left over at the end by the trapezoid.
class SimpsonIntegral {
 public:
  explicit SimpsonIntegral(Eigen::Index size) : whole_(Eigen::VectorXd::Zero(size)) {}

  void add(const Eigen::VectorXd& value) {
    values_.push_back(value);
    if (values_.size() < 3) return;
    whole_ += (values_[0] + 4.0 * values_[1] + values_[2]) / 3.0;
    values_.erase(values_.begin(), values_.begin() + 2);
  }
  Eigen::VectorXd value() const {
    return values_.size() == 2 ? Eigen::VectorXd(whole_ + 0.5 * (values_[0] + values_[1])) : whole_;
  }

 private:
  Eigen::VectorXd whole_;
  std::vector<Eigen::VectorXd> values_;  // since the last pair of intervals
};

class Pid {
 public:
  Pid(const Gains& gains, Eigen::Index size) : gains_(gains), integral_(size) {}

  Eigen::VectorXd output(const Eigen::VectorXd& error, const Eigen::VectorXd& error_to_integrate) {
    integral_.add(error_to_integrate);
    const Eigen::VectorXd change = last_.size() > 0 ? Eigen::VectorXd(error - last_) : Eigen::VectorXd(0.0 * error);
    last_ = error;
    return gains_.proportional * error + gains_.integral * integral_.value() + gains_.derivative * change;
  }

 private:
  Gains gains_;
  SimpsonIntegral integral_;
  Eigen::VectorXd last_;
};

// (y - x) . dx/dalpha of each command, by a backward difference; a forward one where that would leave the bounds.
std::optional<Eigen::VectorXd> published_derivative(Search& search, const Evaluation& at) {
  const ReachProblem& problem = search.problem();
  const Eigen::VectorXd commands = at.commands, residuals = at.residuals;  // `at` may be forgotten meanwhile
  Eigen::VectorXd derivative(commands.size());
  for (Eigen::Index k = 0; k < commands.size(); ++k) {
    const Eigen::VectorXd probe = difference_probe(problem, commands, k);
    const Evaluation* there = search.evaluate(probe, false);
    if (!there) return std::nullopt;
    derivative[k] = -residuals.dot(there->residuals - residuals) / (probe[k] - commands[k]);
  }
  return derivative;
}

// Simpson's rule over all iterations at once, as published.
double published_integral(const std::vector<double>& objective_m2) {
  const std::size_t t = objective_m2.size() - 1;
  const double half_way_m2 = 0.5 * (objective_m2[t / 2] + objective_m2[(t + 1) / 2]);
  return static_cast<double>(t) / 6.0 * (objective_m2.front() + 4.0 * half_way_m2 + objective_m2.back());
}

Eigen::VectorXd projected_error(const Evaluation& here) {
  Eigen::MatrixXd normal = here.jacobian.transpose() * here.jacobian;
  const double largest = normal.diagonal().maxCoeff();
  if (!(largest > 0.0)) return Eigen::VectorXd::Zero(here.commands.size());
  normal.diagonal().array() += kDamping * largest;
  return -normal.ldlt().solve(here.jacobian.transpose() * here.residuals);
}

Eigen::VectorXd within(const ReachProblem& problem, const Eigen::VectorXd& commands) {
  return commands.cwiseMax(problem.min).cwiseMin(problem.max);
}

}  // namespace

std::string search_pid(Search& search, int max_iterations) {
  const ReachProblem& problem = search.problem();
  Eigen::VectorXd commands = problem.start;
  std::vector<double> objective_m2;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Evaluation* here = search.evaluate(commands, false);  // known already: the last point of the iteration before
    if (!here) return search.failure();
    objective_m2.push_back(here->objective_m2());
    const std::optional<Eigen::VectorXd> derivative = published_derivative(search, *here);
    if (!derivative) return search.failure();
    const double common =
        kPublished.proportional * objective_m2.back() + kPublished.integral * published_integral(objective_m2);
    const Eigen::VectorXd next = (problem.start + kPublished.derivative * *derivative).array() + common;
    const Evaluation* there = search.approach(commands, within(problem, next), false);
    if (!there) return search.failure();
    commands = there->commands;
    if (!search.finish_iteration(commands, there->distance_m)) return kCancelled;
  }
  return kIterationLimit;
}

std::string search_pid_projected(Search& search, int max_iterations, double tolerance_m) {
  const ReachProblem& problem = search.problem();
  const Eigen::VectorXd range = problem.max - problem.min;
  Eigen::VectorXd commands = problem.start;
  Pid pid(kProjected, commands.size());
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Evaluation* here = search.evaluate(commands, true);
    if (!here) return search.failure();
    if (here->distance_m < tolerance_m) return kConverged;
    const Eigen::VectorXd error = projected_error(*here);
    Eigen::VectorXd to_integrate = error;
    for (Eigen::Index i = 0; i < error.size(); ++i)
      if (commands[i] <= problem.min[i] || commands[i] >= problem.max[i]) to_integrate[i] = 0.0;
    const Eigen::VectorXd step =
        pid.output(error, to_integrate).cwiseMin(kLargestPidStep * range).cwiseMax(-kLargestPidStep * range);
    const Eigen::VectorXd next = within(problem, commands + step);
    here = search.approach(commands, next, true);
    if (!here) return search.failure();
    const bool settled = ((here->commands - commands).array().abs() <= kSettledStep * range.array()).all();
    commands = here->commands;
    if (!search.finish_iteration(commands, here->distance_m)) return kCancelled;
    if (settled) return kConverged;
  }
  return kIterationLimit;
}

}  // namespace soft_robot_lab
