// SPDX-License-Identifier: BSD-3-Clause
// RMSprop on 1/2 |y - x(alpha)|^2 with the published constants, kept for comparison. It stops where every derivative is
// below a tolerance, if one is given: the source gives one, and another for another robot.
// The thesis's eq. 7.5 drops the minus sign of this objective's gradient, which would climb: here the step descends.
// The thesis names no finite-difference step; ours is kDifference. Lengths are in metres, so epsilon damps the steps
// once the gradient falls below about 1e-3 m^2 per unit of command.
#include "search.h"

#include <cmath>
#include <optional>

namespace soft_robot_lab {
namespace {

constexpr double kGamma = 0.9;       // memory of the mean square
constexpr double kEpsilon = 1.0e-6;  // [m^4 per command^2]
constexpr double kEta = 0.001;       // step [command]

// One backward difference per command; forward where a backward one would leave the bounds.
std::optional<Eigen::VectorXd> gradient(Search& search, const Eigen::VectorXd& commands, double objective_m2) {
  const ReachProblem& problem = search.problem();
  Eigen::VectorXd slope(commands.size());
  for (Eigen::Index i = 0; i < commands.size(); ++i) {
    const Eigen::VectorXd probe = difference_probe(problem, commands, i);
    const Evaluation* there = search.evaluate(probe, false);
    if (!there) return std::nullopt;
    slope[i] = (there->objective_m2() - objective_m2) / (probe[i] - commands[i]);
  }
  return slope;
}

}  // namespace

std::string search_rmsprop(Search& search, int max_iterations, double gradient_tolerance_m2) {
  const ReachProblem& problem = search.problem();
  Eigen::VectorXd commands = problem.start;
  Eigen::ArrayXd mean_square = Eigen::ArrayXd::Zero(commands.size());
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Evaluation* here = search.evaluate(commands, false);  // known already: the last point of the iteration before
    if (!here) return search.failure();
    const std::optional<Eigen::VectorXd> slope = gradient(search, commands, here->objective_m2());
    if (!slope) return search.failure();
    if (slope->cwiseAbs().maxCoeff() < gradient_tolerance_m2) return kConverged;
    mean_square = kGamma * mean_square + (1.0 - kGamma) * slope->array().square();
    Eigen::VectorXd next = commands;
    next.array() -= kEta * slope->array() / (mean_square + kEpsilon).sqrt();
    next = next.cwiseMax(problem.min).cwiseMin(problem.max);
    const Evaluation* there = search.approach(commands, next, false);
    if (!there) return search.failure();
    commands = there->commands;
    if (!search.finish_iteration(commands, there->distance_m)) return kCancelled;
  }
  return kIterationLimit;
}

}  // namespace soft_robot_lab
