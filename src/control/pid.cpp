// Two PID controllers on the model. Each adds its output to the commands, once an iteration:
//   commands += kp e + ki (integral of e over the iterations, by Simpson's rule) + kd (e - last e).
//
// `pid` has the published gains and Simpson's rule. What its source measures as the error, and which cable gets it, is
// not known to us; its gains fit an error in m^2, the objective's unit: each command's share of the objective along
// the direction in which it moved the marker at the start,
//   e_i = 1/2 |r| (d_i . r),   r = target - marker,   d_i = unit(d marker / d command_i).
// Its derivative part then has the loop gain kd |J| |r|: below 1 near the target, above it far away, where it swings.
//
// `pid_projected` has an error in commands, e = J^+ r, with the model's Jacobian at every iterate and the damped
// pseudo-inverse J^+. Its gains are chosen so: with J right, e shrinks by 1 - kp an iteration; ki and kd are small
// beside kp, the integral for what the Jacobian gets wrong, the derivative against overshoot in curved valleys. The
// integral rests while a command is at its limit, and a step is at most kLargestStep of the command's range.
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Dense>

#include "control/search.h"

namespace soft_robot_lab {
namespace {

struct Gains {
  double proportional, integral, derivative;
};
constexpr Gains kPublished{0.05, 0.00075, 150.0};  // [command per m^2], over iterations
constexpr Gains kProjected{0.4, 0.01, 0.1};        // [1], over iterations

constexpr double kDamping = 0.01;        // of the pseudo-inverse, relative to the largest diagonal entry of J^T J
constexpr double kLargestStep = 0.025;   // of the command's range
constexpr double kSettledStep = 1.0e-6;  // of the command's range

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

// Columns: the unit direction in which a command moves the residuals at the start; zero for a command without effect.
std::optional<Eigen::MatrixXd> start_directions(Search& search, const Evaluation& start) {
  const ReachProblem& problem = search.problem();
  const Eigen::VectorXd commands = start.commands, residuals = start.residuals;  // `start` may be forgotten meanwhile
  Eigen::MatrixXd directions(residuals.size(), commands.size());
  for (Eigen::Index i = 0; i < commands.size(); ++i) {
    const Eigen::VectorXd probe = difference_probe(problem, commands, i);
    const Evaluation* there = search.evaluate(probe, false);
    if (!there) return std::nullopt;
    directions.col(i) = ((there->residuals - residuals) / (probe[i] - commands[i])).stableNormalized();
  }
  return directions;
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

std::string search_pid(Search& search, int max_iterations, double tolerance_m) {
  const ReachProblem& problem = search.problem();
  Eigen::VectorXd commands = problem.start;
  const std::optional<Eigen::MatrixXd> directions = start_directions(search, *search.evaluate(commands, false));
  if (!directions) return search.failure();
  Pid pid(kPublished, commands.size());
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Evaluation* here = search.evaluate(commands, false);
    if (!here) return search.failure();
    if (here->distance_m < tolerance_m) return kConverged;
    const Eigen::VectorXd error = -0.5 * here->residuals.norm() * (directions->transpose() * here->residuals);
    here = search.approach(commands, within(problem, commands + pid.output(error, error)), false);
    if (!here) return search.failure();
    commands = here->commands;
    if (!search.finish_iteration(commands, here->distance_m)) return kCancelled;
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
        pid.output(error, to_integrate).cwiseMin(kLargestStep * range).cwiseMax(-kLargestStep * range);
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
